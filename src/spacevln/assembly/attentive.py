"""While a model thinks, the map goes on being updated by what the robot's camera sees."""

from __future__ import annotations

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
    SpatialMap,
    Task,
)
from spacevln.mapping import MetricMap

R = TypeVar("R")
_PERIOD_S = 0.2


class Attention:
    """Maps live images on the loop's own thread while a reply is being waited for on another.

    Only for planners and executors that do not read the map, as model-written ones do not.

    Args:
        live: the newest image, if there is one.
    """

    def __init__(self, live: Callable[[], Observation | None]) -> None:
        self._live = live
        self.integrated = 0

    def during(self, think: Callable[[], R], space: SpatialMap) -> R:
        """The result of ``think``; what it raises is raised."""
        with ThreadPoolExecutor(1) as pool:
            reply: Future[R] = pool.submit(think)
            while not wait([reply], timeout=_PERIOD_S).done:
                observation = self._live()
                if observation is not None and isinstance(space, MetricMap):
                    space.integrate(observation)
                    self.integrated += 1
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
    """Implements :class:`~spacevln.core.interfaces.Executor` around another one."""

    def __init__(self, executor: Executor, attention: Attention) -> None:
        self._executor, self._attention = executor, attention

    def reset(self) -> None:
        """A new episode begins."""
        self._executor.reset()

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """Of the executor, with open eyes."""
        return self._attention.during(lambda: self._executor.act(context), context.space)
