"""From a reply's text to the core's stage variables and actions; what does not fit is a typed :class:`ReplyRejected`.

Whether a well-formed reply is possible *here* (direction among the views, next anchor after the current one, verified anchors in
place, action admissible) is judged by ``control`` and the loop.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from spacevln.control.anchors import same_anchor
from spacevln.core import (
    Anchor,
    ExecutorReply,
    ExecutorThought,
    Found,
    JsonReply,
    PlannerReply,
    PlannerThought,
    ReplyRejected,
    SpaceKind,
    Subtask,
    Verdict,
    read_object,
)
from spacevln.language import cue_kind, region_kind
from spacevln.reasoning.spatial_cot.actions import Choices
from spacevln.reasoning.spatial_cot.replies import (
    ChainAnchor,
    DirectExecutorReply,
    DirectPlannerReply,
    Place,
    SpatialCoTExecutorReply,
    SpatialCoTPlannerReply,
    StageVariables,
)

MAX_REASONS = 4  # one is enough to mend most replies; a hundred help nobody
_KINDS = {
    "missing": "missing_field",
    "extra_forbidden": "unknown_field",
    "literal_error": "wrong_value",
    "string_too_long": "too_long",
    "too_long": "too_long",
    "too_short": "chain",
}
_ORDER = {"done": 0, "here": 1, "ahead": 2}

M = TypeVar("M", bound=BaseModel)


def parse_planner(text: str, *, scot: bool, first: bool) -> PlannerReply:
    """A planner's reply.

    Args:
        text: as the model wrote it.
        scot: with the reasoning fields.
        first: no last subtask was told; then the verdict is ``first``, whatever the reply says.

    Raises:
        ReplyRejected: ``parse``, ``missing_field``, ``unknown_field``, ``wrong_type``, ``wrong_value``, ``too_long``,
            ``chain`` (empty), ``chain_order`` or ``verdict``.
    """
    found = read_object(text)
    with _counted(found) as fallbacks:
        answer = _validated(found, SpatialCoTPlannerReply if scot else DirectPlannerReply)
        thought, verdict = PlannerThought(), ""
        match answer:
            case SpatialCoTPlannerReply(progress=progress):
                verdict = progress.verdict
                thought = PlannerThought(answer.observation, answer.memory, progress.reasoning, answer.decision, answer.plan)
            case DirectPlannerReply():
                verdict = answer.verdict
        return PlannerReply(_subtask(answer, Verdict.FIRST if first else _verdict(verdict)), thought, fallbacks)


def parse_executor(text: str, choices: Choices, *, scot: bool) -> ExecutorReply:
    """An executor's reply.

    Args:
        text: as the model wrote it.
        choices: every action of the body, by its words.
        scot: with the reasoning fields.

    Raises:
        ReplyRejected: as of :func:`parse_planner`, or ``action``: the words are no action of this body.
    """
    found = read_object(text)
    with _counted(found) as fallbacks:
        answer = _validated(found, SpatialCoTExecutorReply if scot else DirectExecutorReply)
        thought = ExecutorThought()
        match answer:
            case SpatialCoTExecutorReply():
                words = answer.action.choice
                thought = ExecutorThought(answer.view, answer.detection, answer.progress, answer.action.reasoning)
            case DirectExecutorReply():
                words = answer.action
        chosen = choices.get(" ".join(words.casefold().split()))
        if chosen is None:
            raise ReplyRejected("action", f"Action {words!r} is unknown: choose one of {', '.join(choices)}.")
        return ExecutorReply(*chosen, thought, fallbacks)


@contextmanager
def _counted(found: JsonReply) -> Iterator[tuple[str, ...]]:
    """A fallback where the JSON object did not stand alone; a refusal of this reply tells it as well."""
    fallbacks = () if found.found is Found.WHOLE else (f"reply_{found.found}",)
    try:
        yield fallbacks
    except ReplyRejected as rejected:
        rejected.fallbacks = fallbacks
        raise


def _validated(found: JsonReply, model: type[M]) -> M:
    try:
        return model.model_validate(found.value)
    except ValidationError as error:
        raise _rejected(error) from error


def _rejected(error: ValidationError) -> ReplyRejected:
    problems = error.errors(include_url=False, include_context=False, include_input=True)
    reasons = []
    for problem in problems[:MAX_REASONS]:
        field = ".".join(map(str, problem["loc"]))
        if problem["type"] == "missing":
            reasons.append(f"field {field!r} is missing")
        elif problem["type"] == "extra_forbidden":
            reasons.append(f"field {field!r} is not asked for")
        else:
            reasons.append(f"field {field!r} is {_shown(problem['input'])}: {problem['msg'].lower()}")
    kind = _KINDS.get(problems[0]["type"], "wrong_type")
    return ReplyRejected(kind, f"{'; '.join(reasons).capitalize()}. Write exactly the fields of the answer format.")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _verdict(said: str) -> Verdict:
    verdict = Verdict(said)
    if verdict is Verdict.FIRST:
        raise ReplyRejected(
            "verdict", "The verdict is 'first', but there was a last stage: say completed, continue or transition about it."
        )
    return verdict


def _subtask(answer: StageVariables, verdict: Verdict) -> Subtask:
    ranks = [_ORDER[anchor.status] for anchor in answer.chain]
    if ranks != sorted(ranks) or ranks.count(_ORDER["here"]) > 1:
        told = ", ".join(anchor.status for anchor in answer.chain)
        raise ReplyRejected(
            "chain_order", f"The chain's statuses are {told}: write first 'done', then at most one 'here', then 'ahead'."
        )
    chain = tuple(map(_chain_anchor, answer.chain))
    current = sum(rank < _ORDER["ahead"] for rank in ranks) - 1
    return Subtask(
        chain=chain,
        current_index=current,
        current_anchor=_same_in_chain(_anchor(answer.current_anchor), chain, current),
        next_anchor=None if answer.next_anchor is None else _same_in_chain(_anchor(answer.next_anchor), chain, current + 1),
        direction=" ".join((answer.direction or "").casefold().split()),
        instruction=answer.instruction.strip(),
        landmark=answer.landmark.strip(),
        complete=answer.complete,
        verdict=verdict,
    )


def _chain_anchor(anchor: ChainAnchor) -> Anchor:
    space, cue = anchor.space.strip(), anchor.landmark.strip()
    return Anchor(space, SpaceKind(anchor.kind), cue, cue_kind(cue))


def _anchor(place: Place) -> Anchor:
    space, cue = place.space.strip(), place.landmark.strip()
    return Anchor(space, region_kind(space) if space else SpaceKind.UNKNOWN, cue, cue_kind(cue))


def _same_in_chain(anchor: Anchor, chain: tuple[Anchor, ...], index: int) -> Anchor:
    """The chain's own anchor, which knows its kind, where the reply repeats it; else as it was written."""
    return chain[index] if 0 <= index < len(chain) and same_anchor(anchor, chain[index]) else anchor
