"""Look-arounds that turn no further than to what is not known (an extra; the paper turns once around)."""

from __future__ import annotations

from dataclasses import replace

import pytest
from flat_runs import SOFA, Run, ahead, run

from spacevln.agent import AgentSettings, Components
from spacevln.core import (
    Action,
    Anchor,
    CueKind,
    ExecutorContext,
    InstructionTask,
    LookedAround,
    MoveForward,
    ObjectGoalTask,
    PlannerContext,
    SpaceKind,
    StageEnd,
    StageEnded,
    StepTaken,
    Stop,
    Subtask,
    Task,
    TurnLeft,
)
from spacevln.testing.scripted import ExecutorLine, subtask_of

SHORT = AgentSettings(glimpses=True, short_looks=True, step_limit=120)
PLANT = ObjectGoalTask("plant")  # there is none
CHEST = Anchor("", SpaceKind.UNKNOWN, "chest", CueKind.SOLID)  # nor this


def to_the_open(context: PlannerContext) -> Subtask:
    """Towards the most open direction, to something that there is not."""
    view = max(context.views, key=lambda view: view.obstacle_m)
    return subtask_of((SOFA, CHEST), 0, view.label)


def small_steps(context: ExecutorContext) -> Action:
    """A quarter of a metre ahead while there is room."""
    return MoveForward(context.admissible.forward_m[0]) if context.admissible.forward_m else Stop()


def gives_up(context: ExecutorContext) -> Action:
    """Ahead once, then back to the planner."""
    return Stop() if context.progress.decisions else ahead(context)


def drive(task: Task = PLANT, settings: AgentSettings = SHORT, executor: ExecutorLine = small_steps) -> Run:
    queries = (task.goal,) if isinstance(task, ObjectGoalTask) else ("plant",)
    return run((to_the_open,), (executor,), settings, task=task, queries=queries)


def looks(done: Run) -> list[int]:
    """Turns of each look-around."""
    stages = [step.stage for step in done.events(StepTaken) if step.phase == "lookaround"]
    return [stages.count(event.stage) for event in done.events(LookedAround)]


def test_after_the_first_only_what_the_map_does_not_know_is_turned_to() -> None:
    first, *others = looks(drive())
    assert first == 12
    assert len(others) > 3
    assert max(others) <= 6


def test_a_direction_that_was_not_turned_to_has_no_image_but_its_obstacles() -> None:
    done = drive()
    events = done.events(LookedAround)
    for event, turns in zip(events, looks(done), strict=True):
        assert len(event.views) == 12
        assert 1 <= sum(view.rgb is not None for view in event.views) <= turns + 1  # back over the front shows it again
        assert event.views[0].rgb is not None
        assert not any(view.sightings for view in event.views if view.rgb is None)
    known = {round(view.obstacle_m, 2) for event in events for view in event.views if view.rgb is None}
    assert min(known) < 1.0


def test_nothing_is_turned_to_while_the_goal_is_in_view() -> None:
    done = drive(ObjectGoalTask("doorway"))
    ends = done.events(StageEnded)
    in_view = [
        turns for end, turns in zip(ends, looks(done)[1:], strict=False) if end.feedback.glimpses[-1].sightings
    ]  # the detector is asked for doorways only
    assert in_view
    assert set(in_view) == {0}


def test_every_image_of_a_stage_is_glimpsed_and_told_once() -> None:
    done = drive(ObjectGoalTask("doorway"))
    steps = [step.stage for step in done.events(StepTaken) if step.phase in ("align", "execute")]
    for end in done.events(StageEnded):
        assert len(end.feedback.glimpses) == 1 + steps.count(end.stage)
    told = [seen for context in done.executor.contexts for seen in context.glimpsed]
    glimpsed = [seen for end in done.events(StageEnded) for glimpse in end.feedback.glimpses for seen in glimpse.sightings]
    rest = iter(glimpsed)  # what the last move of a stage showed is the planner's alone
    assert told
    assert all(any(seen is each for each in rest) for seen in told)


@pytest.mark.parametrize("executor", [Stop(), TurnLeft(30.0), gives_up], ids=["did nothing", "stands", "gave up"])
def test_after_a_stage_that_led_nowhere_the_turn_is_whole(executor: ExecutorLine) -> None:
    done = drive(executor=executor)
    nowhere = [
        turns
        for end, turns in zip(done.events(StageEnded), looks(done)[1:], strict=False)
        if end.feedback.end is StageEnd.STOP or not end.feedback.record.moved_m
    ]
    assert nowhere
    assert set(nowhere) == {12}


@pytest.mark.parametrize("components", [Components(hsm=False), Components(stagewise=False)], ids=["no memory", "no feedback"])
def test_who_keeps_nothing_turns_once_around(components: Components) -> None:
    assert set(looks(drive(settings=replace(SHORT, components=components)))) == {12}


def test_instructions_and_whole_looks_turn_once_around() -> None:
    assert set(looks(drive(InstructionTask("Go to the plant.")))) == {12}
    assert set(looks(drive(settings=replace(SHORT, short_looks=False)))) == {12}
    assert set(looks(drive(settings=replace(SHORT, glimpses=False)))) == {12}
