"""Is a planner's reply possible in this situation? Algorithm 1 line 4, Validate; appendix "Model-output validation".

Parsing a reply is reasoning's; what is judged here is the parsed subtask against views, chain and task.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from spacevln.control.anchors import same_anchor
from spacevln.control.placeholders import is_bare_space, is_placeholder, is_placeholder_name
from spacevln.control.settings import ControlSettings
from spacevln.core import Anchor, ObjectGoalTask, PlannerContext, PlannerReply, Subtask, View


@dataclass(frozen=True, slots=True)
class Rejection:
    """Why a reply cannot be used.

    Args:
        kind: class of the rejection, counted in the report.
        reason: one sentence that goes back to the model.
    """

    kind: str
    reason: str


def check_direction(subtask: Subtask, views: tuple[View, ...], traversable_m: float) -> Iterator[Rejection]:
    """The direction is one of the views and locally traversable, unless no view is. Of a finished task none is asked."""
    if subtask.complete:
        return
    view = next((view for view in views if view.label == subtask.direction), None)
    if view is None:
        labels = ", ".join(view.label for view in views)
        yield Rejection("direction", f"direction {subtask.direction!r} is none of the views: choose one of {labels}.")
        return
    open_labels = [other.label for other in views if other.obstacle_m >= traversable_m]
    if open_labels and view.obstacle_m < traversable_m:
        yield Rejection(
            "not_traversable",
            f"direction {view.label!r} has an obstacle at {view.obstacle_m:.2f} m: choose one of {', '.join(open_labels)}.",
        )


def check_chain(subtask: Subtask) -> Iterator[Rejection]:
    """The next anchor follows the current one in the reply's own chain, and is absent exactly when the task is complete."""
    chain, current = subtask.chain, subtask.current_index
    if not chain:
        yield Rejection("chain", "the anchor chain is empty: give at least the goal.")
        return
    if not -1 <= current < len(chain):
        yield Rejection("chain", f"current anchor {current} is not in the chain: allowed are -1 to {len(chain) - 1}.")
        return
    at_goal = current == len(chain) - 1
    if subtask.complete != at_goal:
        state = "the last" if at_goal else "not the last"
        yield Rejection(
            "completion", f"complete is {subtask.complete}, but anchor {current} is {state} of the chain: make both agree."
        )
    elif subtask.complete and subtask.next_anchor is not None:
        yield Rejection("completion", f"complete is True, but a next anchor '{subtask.next_anchor}' is given: leave one out.")
    elif not subtask.complete and subtask.next_anchor is None:
        yield Rejection("completion", f"no next anchor is given, but '{chain[current + 1]}' is not reached: give it.")
    elif subtask.next_anchor is not None and not same_anchor(subtask.next_anchor, chain[current + 1]):
        yield Rejection(
            "next_anchor",
            f"next anchor '{subtask.next_anchor}' does not follow anchor {current} of the chain: '{chain[current + 1]}' does.",
        )


def check_verified(subtask: Subtask, last: Subtask | None, object_goal: bool) -> Iterator[Rejection]:
    """Anchors already verified keep their place across calls; for object goals only the final anchor is fixed."""
    if last is None or not subtask.chain:
        return
    if object_goal:
        if not same_anchor(subtask.final_anchor, last.final_anchor):
            yield Rejection("goal_changed", f"the final anchor became '{subtask.final_anchor}': it stays '{last.final_anchor}'.")
        return
    for index, anchor in enumerate(last.chain[: last.current_index + 1]):
        if index >= len(subtask.chain) or not same_anchor(anchor, subtask.chain[index]):
            yield Rejection("verified_moved", f"anchor {index} was verified as '{anchor}': keep it at its place in the chain.")
            return
    if subtask.current_index < last.current_index:
        yield Rejection(
            "verified_lost",
            f"current anchor {subtask.current_index} is before anchor {last.current_index}, which was verified: never go back.",
        )


def check_placeholders(subtask: Subtask) -> Iterator[Rejection]:
    """No unresolved placeholders in the chain, the instruction or the landmark, and no anchor that says nothing."""
    for index, anchor in enumerate(subtask.chain):
        if not anchor.space.strip() and not anchor.cue.strip():
            yield Rejection("placeholder", f"anchor {index} of the chain is empty: name its space, its landmark or both.")
        elif _is_hollow(anchor):
            yield Rejection("placeholder", f"anchor {index} '{anchor}' is a placeholder: name a real space or landmark.")
    if _is_hollow(subtask.current_anchor):
        yield Rejection("placeholder", f"current anchor '{subtask.current_anchor}' is a placeholder: name what is here.")
    if is_placeholder_name(subtask.landmark):
        yield Rejection("placeholder", f"landmark {subtask.landmark!r} is a placeholder: name a real thing, or leave it empty.")
    if is_placeholder(subtask.instruction):
        yield Rejection("placeholder", f"instruction {subtask.instruction!r} holds a placeholder: write what to do.")


def _is_hollow(anchor: Anchor) -> bool:
    return is_placeholder_name(anchor.space) or is_placeholder_name(anchor.cue) or is_bare_space(anchor)


def check_stage_fields(subtask: Subtask) -> Iterator[Rejection]:
    """A stage has an instruction, and a landmark to track where its target has a cue."""
    if subtask.complete or subtask.next_anchor is None:
        return
    if not subtask.instruction.strip():
        yield Rejection("instruction", "the stage instruction is empty: tell the executor in one sentence what to do.")
    if subtask.next_anchor.cue.strip() and not subtask.landmark.strip():
        yield Rejection(
            "landmark", f"the subtask landmark is empty, but the next anchor is told by {subtask.next_anchor.cue!r}: track it."
        )


def check_first(subtask: Subtask, stage: int) -> Iterator[Rejection]:
    """A task is never finished at the first call.

    The gate could not agree there: no stage has tracked the final landmark yet. A goal beside the start costs one stage
    that arrives at once.
    """
    if stage == 0 and subtask.complete:
        yield Rejection("first_finish", "the task cannot be complete at the first call: give the first stage.")


def validate_subtask(reply: PlannerReply, context: PlannerContext, settings: ControlSettings) -> list[Rejection]:
    """Every reason why a planner's reply cannot be used now; empty when it is accepted."""
    subtask = reply.subtask
    return [
        *check_chain(subtask),
        *check_first(subtask, context.stage),
        *check_verified(subtask, context.last_subtask, isinstance(context.task, ObjectGoalTask)),
        *check_direction(subtask, context.views, settings.traversable_m),
        *check_placeholders(subtask),
        *check_stage_fields(subtask),
    ]


def chain_revision(subtask: Subtask, last: Subtask | None) -> str:
    """In words, how unverified anchors were refined or replaced since the last call; empty when they were not."""
    if last is None:
        return ""
    same = len(subtask.chain) == len(last.chain) and all(map(same_anchor, subtask.chain, last.chain))
    if same:
        return ""
    return f"{' > '.join(map(str, last.chain))} became {' > '.join(map(str, subtask.chain))}"
