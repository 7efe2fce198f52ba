"""Scripted planner, executor and detector, and a sink that keeps events: doubles for tests of the loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from spacevln.core import (
    Action,
    Anchor,
    CueKind,
    Detection,
    Event,
    ExecutorContext,
    ExecutorReply,
    Observation,
    PlannerContext,
    PlannerReply,
    Stop,
    Subtask,
    Task,
    Verdict,
)

PlannerLine = PlannerReply | Subtask | Exception | Callable[[PlannerContext], PlannerReply | Subtask]
ExecutorLine = ExecutorReply | Action | Exception | Callable[[ExecutorContext], ExecutorReply | Action]


def subtask_of(
    chain: Sequence[Anchor],
    current: int,
    direction: str = "front",
    landmark: str | None = None,
    target_m: tuple[float, float, float] | None = None,
    here: Anchor | None = None,
) -> Subtask:
    """A consistent subtask: next anchor, instruction, landmark and completion follow from chain and current index.

    Args:
        chain: C_k.
        current: j_k; the last index makes it complete.
        direction: delta_k.
        landmark: ell_k; by default the next anchor's cue.
        target_m: metric target.
        here: v^{j_k}_k; by default the anchor of the chain, or the first one before any is verified.
    """
    complete = current == len(chain) - 1
    following = None if complete else chain[current + 1]
    return Subtask(
        chain=tuple(chain),
        current_index=current,
        current_anchor=here or chain[max(current, 0)],
        next_anchor=following,
        direction=direction,
        instruction="" if following is None else f"Go to {following}.",
        landmark=landmark
        if landmark is not None
        else ""
        if following is None or following.cue_kind is CueKind.NONE
        else following.cue,
        complete=complete,
        verdict=Verdict.FIRST if current < 0 else Verdict.COMPLETED,
        target_m=target_m,
    )


@dataclass
class ScriptedPlanner:
    """Replies line by line; the last line is repeated. An exception is raised, a function is called with the context.

    Args:
        script: at least one line.
        queries: of the look-around.
        contexts: every context it was given, for the test to read.
    """

    script: Sequence[PlannerLine]
    queries: tuple[str, ...] = ()
    contexts: list[PlannerContext] = field(default_factory=list)

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        """The queries it was made with."""
        del task
        return self.queries

    def reset(self) -> None:
        """Start the script again."""
        self.contexts.clear()

    def plan(self, context: PlannerContext) -> PlannerReply:
        """The next line."""
        line = self.script[min(len(self.contexts), len(self.script) - 1)]
        self.contexts.append(context)
        if isinstance(line, Exception):
            raise line
        reply = line(context) if callable(line) else line
        return PlannerReply(reply) if isinstance(reply, Subtask) else reply


@dataclass
class ScriptedExecutor:
    """Replies line by line; the last line is repeated. See :class:`ScriptedPlanner`."""

    script: Sequence[ExecutorLine] = (Stop(),)
    contexts: list[ExecutorContext] = field(default_factory=list)

    def reset(self) -> None:
        """Start the script again."""
        self.contexts.clear()

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """The next line."""
        line = self.script[min(len(self.contexts), len(self.script) - 1)]
        self.contexts.append(context)
        if isinstance(line, Exception):
            raise line
        reply = line(context) if callable(line) else line
        return reply if isinstance(reply, ExecutorReply) else ExecutorReply(reply)


class BlindDetector:
    """Finds nothing."""

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        """One empty tuple per observation."""
        del queries
        return [()] * len(observations)


@dataclass
class EventList:
    """A sink that keeps every event."""

    events: list[Event] = field(default_factory=list)

    def emit(self, event: Event) -> None:
        """Keep it."""
        self.events.append(event)

    def names(self) -> list[str]:
        """Class names in order."""
        return [type(event).__name__ for event in self.events]
