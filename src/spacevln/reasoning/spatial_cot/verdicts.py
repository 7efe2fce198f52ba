"""Whether the verdict on the last subtask agrees with the chain of the same reply.

A verdict is the model's own word about its last stage (appendix "Planner Spatial-CoT": completed, continue, transition); the
statuses of the chain say the same in another way. Where the two disagree nobody knows which was meant, and the model is asked.
"""

from __future__ import annotations

from spacevln.control.anchors import same_anchor
from spacevln.core import Subtask, Verdict


def contradiction(subtask: Subtask, last: Subtask, *, object_goal: bool) -> str:
    """Why verdict and chain disagree, in words for the model; ``""`` where they agree.

    Anchors ahead may be renamed, split or replaced between two calls, so the last target need not be in the chain any more.

    Args:
        subtask: of the reply.
        last: sigma_{k-1}, which the verdict is about.
        object_goal: places to search may leave the chain after they were reached.
    """
    target = last.next_anchor
    if target is None:
        return ""
    done, ahead = subtask.chain[: subtask.current_index + 1], subtask.chain[subtask.current_index + 1 :]
    before = sum(same_anchor(target, anchor) for anchor in last.chain[: last.current_index + 1])
    verified = sum(same_anchor(target, anchor) for anchor in done) > before
    waiting = any(same_anchor(target, anchor) for anchor in ahead)
    advanced = subtask.current_index > last.current_index
    match subtask.verdict:
        case Verdict.COMPLETED if waiting and not verified:
            return f"The verdict is 'completed', but the chain has its target '{target}' ahead: make both agree."
        case Verdict.COMPLETED if not (verified or advanced or object_goal):
            return f"The verdict is 'completed', but the chain has nothing more verified than before '{target}': make both agree."
        case Verdict.CONTINUE if verified:
            return f"The verdict is 'continue', but the chain has its target '{target}' verified: make both agree."
        case Verdict.CONTINUE if subtask.complete:
            return "The verdict is 'continue', but complete is true: say 'completed', or give the stage that is left."
        case Verdict.TRANSITION if not verified and subtask.next_anchor is not None and same_anchor(subtask.next_anchor, target):
            return f"The verdict is 'transition', but the next anchor is still '{target}': say 'continue', or name another."
        case _:
            return ""
