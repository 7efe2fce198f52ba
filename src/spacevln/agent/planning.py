"""Validate(pi_P(.)): ask the planner until its reply is possible here, at most N_retry times again (Algorithm 1 line 4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from spacevln.agent.fallbacks import tell_fallbacks
from spacevln.control import ControlSettings, GateVerdict, Rejection, chain_revision, validate_subtask
from spacevln.core import (
    Event,
    GateAsked,
    ModelError,
    Planner,
    PlannerContext,
    ReplyRefused,
    ReplyRejected,
    Subtask,
    SubtaskIssued,
)


def ask_planner(
    planner: Planner,
    context: PlannerContext,
    judge: Callable[[Subtask], GateVerdict],
    settings: ControlSettings,
    emit: Callable[[Event], None],
    clock: Callable[[], float],
) -> Subtask:
    """A subtask that passes validation and, if it claims the task complete, the episode gate.

    Raises:
        ModelError: N_retry replies more were refused as well, or the planner failed for good.
    """
    stage, refused = context.stage, list[str]()
    for _ in range(1 + settings.retries):
        begin = clock()
        try:
            reply = planner.plan(replace(context, rejections=tuple(refused)))
        except ReplyRejected as rejected:
            tell_fallbacks(rejected, stage, "planner", emit)
            rejections = [Rejection(rejected.kind, rejected.reason)]
        else:
            tell_fallbacks(reply, stage, "planner", emit)
            rejections = validate_subtask(reply, context, settings)
            if not rejections and reply.subtask.complete:
                verdict = judge(reply.subtask)
                emit(GateAsked(stage, verdict.accepted, verdict.clauses))
                rejections = [] if verdict.accepted else [Rejection("gate", verdict.reason)]
            if not rejections:
                revision = chain_revision(reply.subtask, context.last_subtask)
                emit(SubtaskIssued(stage, reply.subtask, reply.thought, clock() - begin, revision))
                return reply.subtask
        for rejection in rejections:
            emit(ReplyRefused(stage, "planner", rejection.kind, rejection.reason))
            refused.append(rejection.reason)
    raise ModelError(
        f"The planner's {1 + settings.retries} replies at stage {stage} were all refused, the last because {refused[-1]}"
    )
