"""While a model thinks, the map goes on being updated by what the robot's camera sees, and the robot may go on, too."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import TypeVar

from spacevln.core import (
    Executor,
    ExecutorContext,
    ExecutorReply,
    Observation,
    Planner,
    PlannerContext,
    PlannerReply,
    Pose,
    SpatialMap,
    Task,
)
from spacevln.mapping import MetricMap

R = TypeVar("R")
Proceed = Callable[[float, Callable[[], bool]], None]
_PERIOD_S = 0.2
AHEAD_DEG = 22.5
"""A waypoint so far aside is not ahead: half a robot's turn."""


class Attention:
    """Maps live images on the loop's own thread while a reply is being waited for on another.

    Only for planners and executors that do not read the map, as model-written ones do not.

    Args:
        live: the newest image, if there is one.
    """

    def __init__(self, live: Callable[[], Observation | None]) -> None:
        self._live = live
        self.integrated = 0

    def during(self, think: Callable[[], R], space: SpatialMap, move: Callable[[Callable[[], bool]], None] | None = None) -> R:
        """The result of ``think``; what it or ``move``, which is told when to end, raises is raised."""
        with ThreadPoolExecutor(2) as pool:
            reply: Future[R] = pool.submit(think)
            moved = None if move is None else pool.submit(move, reply.done)
            while not wait([reply], timeout=_PERIOD_S).done:
                observation = self._live()
                if observation is not None and isinstance(space, MetricMap):
                    space.integrate(observation)
                    self.integrated += 1
            if moved is not None:
                moved.result()
            return reply.result()


class AttentivePlanner:
    """Implements :class:`~spacevln.core.interfaces.Planner` around another one."""

    def __init__(self, planner: Planner, attention: Attention) -> None:
        self._planner, self._attention = planner, attention

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        """Of the planner."""
        return self._planner.lookaround_queries(task)

    def reset(self) -> None:
        """A new episode begins."""
        self._planner.reset()

    def plan(self, context: PlannerContext) -> PlannerReply:
        """Of the planner, with open eyes."""
        return self._attention.during(lambda: self._planner.plan(context), context.space)


class AttentiveExecutor:
    """Implements :class:`~spacevln.core.interfaces.Executor` around another one.

    Args:
        executor: the one that thinks.
        attention: maps meanwhile.
        proceed: moves the robot ahead meanwhile, where the way to the stage's next waypoint is free; None lets it stand.
    """

    def __init__(self, executor: Executor, attention: Attention, proceed: Proceed | None = None) -> None:
        self._executor, self._attention, self._proceed = executor, attention, proceed

    def reset(self) -> None:
        """A new episode begins."""
        self._executor.reset()

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """Of the executor, with open eyes."""
        proceed, ahead_m = self._proceed, way_ahead_m(context)
        move = None if proceed is None or not ahead_m else lambda until: proceed(ahead_m, until)
        return self._attention.during(lambda: self._executor.act(context), context.space, move)


def way_ahead_m(context: ExecutorContext) -> float:
    """Free way straight ahead towards the stage's next waypoint [m]; 0 where it leads elsewhere, or control masks a forward.

    The waypoint is the first bend of the known way to the stage's target: the planner's point, or else the nearest landmark of
    the pool that was not yet reached.
    """
    target, pose = _target_xy(context), context.observation.pose
    if target is None or not context.admissible.forward_m:
        return 0.0
    way = context.space.path(pose.xy_m, target)
    if len(way) < 2 or abs(pose.bearing_rad(*map(float, way[1]))) > math.radians(AHEAD_DEG):
        return 0.0
    ahead_m = min(context.admissible.forward_m[-1], pose.distance_m(*map(float, way[1])))
    there = pose.compose(Pose(ahead_m, 0.0)).xy_m
    return ahead_m if context.space.line_of_sight(pose.xy_m, there) else 0.0


def _target_xy(context: ExecutorContext) -> tuple[float, float] | None:
    if context.subtask.target_m is not None:
        return context.subtask.target_m[:2]
    open_ones = [candidate for candidate in context.pool if not candidate.arrived]
    nearest = min(open_ones, key=lambda candidate: candidate.distance_m, default=None)
    return None if nearest is None else nearest.position_m[:2]
