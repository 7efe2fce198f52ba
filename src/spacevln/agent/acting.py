"""Parse_U(pi_E(.)): ask the executor until its action is admissible, at most N_retry times again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from spacevln.agent.fallbacks import tell_fallbacks
from spacevln.control import ControlSettings
from spacevln.core import (
    AdmissibleActions,
    Event,
    Executor,
    ExecutorContext,
    ExecutorReply,
    FallbackUsed,
    ModelError,
    ReplyRefused,
    ReplyRejected,
    describe,
)


def ask_executor(
    executor: Executor, context: ExecutorContext, stage: int, settings: ControlSettings, emit: Callable[[Event], None]
) -> ExecutorReply | None:
    """An action within U_t; None when there is none to be had, and the stage goes back to the planner."""
    refused: list[str] = []
    for _ in range(1 + settings.retries):
        try:
            reply = executor.act(replace(context, rejections=tuple(refused)))
        except ReplyRejected as rejected:
            tell_fallbacks(rejected, stage, "executor", emit)
            kind, reason = rejected.kind, rejected.reason
        except ModelError as error:
            emit(FallbackUsed(stage, "executor_failed", str(error)))
            return None
        else:
            tell_fallbacks(reply, stage, "executor", emit)
            if context.admissible.allows(reply.action):
                return reply
            kind, reason = "inadmissible", f"{describe(reply.action)!r} is not admissible: {allowed(context.admissible)}."
        emit(ReplyRefused(stage, "executor", kind, reason))
        refused.append(reason)
    emit(FallbackUsed(stage, "executor_refused", f"{1 + settings.retries} replies refused, the last because {refused[-1]}"))
    return None


def allowed(admissible: AdmissibleActions) -> str:
    """U_t in words."""
    choices = [f"forward {distance_m:.2f}" for distance_m in admissible.forward_m]
    choices += [side for side, free in (("left", admissible.left), ("right", admissible.right)) if free]
    return f"choose one of {', '.join([*choices, 'stop'])}"
