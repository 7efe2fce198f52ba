"""Shared pieces of the agent's tests: a run in Flatland with scripted minds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from spacevln.agent import AgentSettings, EpisodeResult, NavigationAgent
from spacevln.core import (
    Action,
    Anchor,
    CueKind,
    Environment,
    EpisodeSpec,
    EventSink,
    ExecutorContext,
    InstructionTask,
    Motion,
    MoveForward,
    PlannerContext,
    Pose,
    SpaceKind,
    StageEnd,
    Stop,
    Subtask,
    Task,
    TurnLeft,
)
from spacevln.perception import LabelDetector
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import EventList, ExecutorLine, PlannerLine, ScriptedExecutor, ScriptedPlanner, subtask_of

E = TypeVar("E")

SOFA = Anchor("living room", SpaceKind.ROOM, "sofa", CueKind.SOLID)
DOOR = Anchor("", SpaceKind.UNKNOWN, "doorway", CueKind.OPENING)
BED = Anchor("bedroom", SpaceKind.ROOM, "bed", CueKind.SOLID)
CHAIN = (SOFA, DOOR, BED)
HERE = Pose(0.0, 0.0)


def by_feedback(context: PlannerContext) -> Subtask:
    """The sound planner of :func:`two_rooms`: the next anchor after an arrival, else the same again."""
    if context.feedback is None or context.last_subtask is None:
        return subtask_of(CHAIN, 0)
    advance = context.feedback.end is StageEnd.ARRIVAL
    return subtask_of(CHAIN, context.last_subtask.current_index + advance)


def ahead(context: ExecutorContext) -> Action:
    """As far forward as is admissible, else to the left, else STOP."""
    if context.admissible.forward_m:
        return MoveForward(context.admissible.forward_m[-1])
    return TurnLeft() if context.admissible.left else Stop()


@dataclass
class Run:
    """What a run showed."""

    result: EpisodeResult
    sink: EventList
    planner: ScriptedPlanner
    executor: ScriptedExecutor
    environment: Environment

    def events(self, kind: type[E]) -> list[E]:
        """The events of one kind, in order."""
        return [event for event in self.sink.events if isinstance(event, kind)]


class Breaking(Flatland):
    """Flatland that raises at one of its primitives, counted from 1."""

    def __init__(self, error: BaseException, at: int) -> None:
        super().__init__()
        self._error, self._at, self._count = error, at, 0

    def execute(self, action: Action) -> Motion:
        self._count += 1
        if self._count == self._at:
            raise self._error
        return super().execute(action)


class Glass(Flatland):
    """Flatland with a pane across it that no depth image shows.

    Args:
        x_m: nothing gets beyond this.
    """

    def __init__(self, x_m: float) -> None:
        super().__init__()
        self._x_m = x_m

    def execute(self, action: Action) -> Motion:
        if isinstance(action, MoveForward) and self.scene_pose.x_m >= self._x_m - 1e-6:
            return Motion(0.0, 0.0, collided=True)
        return super().execute(action)


def run(
    planner: Sequence[PlannerLine] = (by_feedback,),
    executor: Sequence[ExecutorLine] = (ahead,),
    settings: AgentSettings | None = None,
    environment: Environment | None = None,
    start: Pose = HERE,
    task: Task | None = None,
    queries: tuple[str, ...] = (),
    sinks: Sequence[EventSink] = (),
    clock: Callable[[], float] = lambda: 0.0,
) -> Run:
    """One episode."""
    sink, world = EventList(), environment or Flatland()
    mind, hand = ScriptedPlanner(planner, queries), ScriptedExecutor(executor)
    agent = NavigationAgent(world, LabelDetector(), mind, hand, settings, [sink, *sinks], clock)
    result = agent.run(EpisodeSpec("e", "flatland", start, task or InstructionTask("Go to the bed.")))
    return Run(result, sink, mind, hand, world)
