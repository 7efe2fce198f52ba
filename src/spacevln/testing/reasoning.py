"""What every planner and every executor must do.

Run them on own ones in five lines::

    from spacevln.testing.reasoning import ExecutorConformance, PlannerConformance

    class TestMyPlanner(PlannerConformance):
        def make_planner(self): return MyPlanner()

    class TestMyExecutor(ExecutorConformance):
        def make_executor(self): return MyExecutor()

Both drive the real loop through two rooms of Flatland, beside scripted counterparts.
"""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from spacevln.agent import AgentSettings, EpisodeResult, NavigationAgent
from spacevln.control import ControlSettings
from spacevln.core import (
    Action,
    Anchor,
    CueKind,
    EpisodeSpec,
    EpisodeStatus,
    Executor,
    ExecutorContext,
    ExecutorReply,
    InstructionTask,
    MoveForward,
    Planner,
    PlannerContext,
    PlannerReply,
    Pose,
    ReplyRefused,
    SpaceKind,
    StageEnd,
    Stop,
    Subtask,
    Task,
    TurnLeft,
)
from spacevln.perception import LabelDetector
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import EventList, ScriptedExecutor, ScriptedPlanner, subtask_of

STEPS = 80
CHAIN = (
    Anchor("living room", SpaceKind.ROOM, "sofa", CueKind.SOLID),
    Anchor("", SpaceKind.UNKNOWN, "doorway", CueKind.OPENING),
    Anchor("bedroom", SpaceKind.ROOM, "bed", CueKind.SOLID),
)


class _Heard:
    """A planner and executor that pass everything on and keep what was asked and answered."""

    def __init__(self, planner: Planner, executor: Executor) -> None:
        self._planner, self._executor = planner, executor
        self.plans: list[tuple[PlannerContext, PlannerReply]] = []
        self.acts: list[tuple[ExecutorContext, ExecutorReply]] = []

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        return self._planner.lookaround_queries(task)

    def reset(self) -> None:
        self._planner.reset()
        self._executor.reset()

    def plan(self, context: PlannerContext) -> PlannerReply:
        self.plans.append((context, self._planner.plan(context)))
        return self.plans[-1][1]

    def act(self, context: ExecutorContext) -> ExecutorReply:
        self.acts.append((context, self._executor.act(context)))
        return self.acts[-1][1]


def _drive(planner: Planner, executor: Executor, task: Task) -> tuple[_Heard, EventList, EpisodeResult]:
    heard, sink = _Heard(planner, executor), EventList()
    agent = NavigationAgent(Flatland(), LabelDetector(), heard, heard, AgentSettings(step_limit=STEPS), [sink])
    result = agent.run(EpisodeSpec("conformance", "flatland", Pose(0.0, 0.0), task))
    return heard, sink, result


def _ahead(context: ExecutorContext) -> Action:
    allowed = context.admissible
    return MoveForward(allowed.forward_m[-1]) if allowed.forward_m else TurnLeft() if allowed.left else Stop()


def _through_the_door(context: PlannerContext) -> Subtask:
    """Straight on, or where the way is clearest once something stands in front."""
    front = context.views[0]
    clearest = max(context.views, key=lambda view: view.obstacle_m)
    direction = (front if front.obstacle_m >= ControlSettings().traversable_m else clearest).label
    if context.feedback is None or context.last_subtask is None:
        return subtask_of(CHAIN, 0, direction)
    reached = context.last_subtask.current_index + (context.feedback.end is StageEnd.ARRIVAL)
    return subtask_of(CHAIN, min(1, reached), direction)


class PlannerConformance:
    """Subclass it, give the maker, and let pytest collect it.

    Attributes:
        deterministic: the same contexts give the same subtasks; False for a sampled model.
        task: what the planner is asked to do; the world shows a sofa, a doorway and a bed.
    """

    deterministic: bool = True
    task: Task = InstructionTask("Walk through the doorway and stop beside the bed.")

    def make_planner(self) -> Planner:
        """A new planner."""
        raise NotImplementedError("Give make_planner() in your subclass: it returns the planner under test.")

    def test_lookaround_queries_are_terms(self) -> None:
        """A sequence of non-empty strings, possibly empty."""
        queries = self.make_planner().lookaround_queries(self.task)
        assert all(isinstance(query, str) and query.strip() for query in queries)

    def test_every_boundary_gets_a_possible_subtask(self) -> None:
        """The loop accepts a reply at every planning boundary within N_retry questions."""
        _, sink, result = _drive(self.make_planner(), ScriptedExecutor([_ahead]), self.task)
        refused = [event.reason for event in sink.events if isinstance(event, ReplyRefused)]
        assert result.status in (EpisodeStatus.STOPPED, EpisodeStatus.STEP_LIMIT), refused
        assert result.subtasks

    def test_the_same_contexts_give_the_same_subtasks(self) -> None:
        """After reset nothing of an earlier episode is left."""
        if not self.deterministic:
            pytest.skip("the planner is declared not deterministic")
        planner = self.make_planner()
        heard, _, _ = _drive(planner, ScriptedExecutor([_ahead]), self.task)
        planner.reset()
        assert [planner.plan(context).subtask for context, _ in heard.plans] == [reply.subtask for _, reply in heard.plans]


class ExecutorConformance:
    """Subclass it, give the maker, and let pytest collect it.

    Attributes:
        deterministic: the same contexts give the same actions; False for a sampled model.
    """

    deterministic: bool = True

    def make_executor(self) -> Executor:
        """A new executor."""
        raise NotImplementedError("Give make_executor() in your subclass: it returns the executor under test.")

    def test_actions_are_admissible(self) -> None:
        """Every action is in U_t at the first question or at a later one of the same query."""
        heard, _, result = _drive(ScriptedPlanner([_through_the_door]), self.make_executor(), InstructionTask("Go on."))
        assert heard.acts
        assert result.status in (EpisodeStatus.STOPPED, EpisodeStatus.STEP_LIMIT)
        assert any(context.admissible.allows(reply.action) for context, reply in heard.acts)

    def test_it_gets_through_an_open_doorway(self) -> None:
        """Straight ahead, two metres away and a metre wide."""
        _, _, result = _drive(ScriptedPlanner([_through_the_door]), self.make_executor(), InstructionTask("Go on."))
        assert result.pose.x_m > 1.4

    def test_the_same_contexts_give_the_same_actions(self) -> None:
        """After reset nothing of an earlier episode is left."""
        if not self.deterministic:
            pytest.skip("the executor is declared not deterministic")
        executor = self.make_executor()
        heard, _, _ = _drive(ScriptedPlanner([_through_the_door]), executor, InstructionTask("Go on."))
        executor.reset()
        assert [executor.act(context).action for context, _ in heard.acts] == [reply.action for _, reply in heard.acts]
