"""Typed endings, budget exactness, interruption, determinism."""

from __future__ import annotations

import inspect
import signal
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from flat_runs import BED, CHAIN, SOFA, Breaking, ahead, by_feedback, run

from spacevln.agent import AgentSettings, Components, NavigationAgent, loop
from spacevln.agent.finish import FinishJudge
from spacevln.agent.look_around import Panorama
from spacevln.agent.world import World
from spacevln.core import (
    Anchor,
    CueKind,
    Detection,
    EnvironmentFailure,
    EpisodeEnded,
    EpisodeSpec,
    EpisodeStatus,
    Event,
    Feedback,
    InstructionTask,
    LandmarkCandidate,
    MapSaved,
    MoveForward,
    Observation,
    PlannerContext,
    Pose,
    SafetyStop,
    SpaceKind,
    SpendingLimit,
    StageEnd,
    StageRecord,
    StepTaken,
    Stop,
    StopReason,
    Subtask,
    TurnLeft,
)
from spacevln.perception import LabelDetector
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import BlindDetector, EventList, ScriptedExecutor, ScriptedPlanner, subtask_of


def to_the_side(context: PlannerContext) -> Subtask:
    """Away from the front, where there is room."""
    side = max(context.views[1:], key=lambda view: view.obstacle_m)
    return subtask_of(CHAIN, 0, side.label)


@pytest.mark.parametrize("limit", [1, 2, 12, 13, 14, 15, 17, 25, 26, 27, 40])
def test_never_more_steps_than_the_budget_and_the_last_one_is_stop(limit: int) -> None:
    done = run([to_the_side], [TurnLeft(), MoveForward(0.5), ahead], AgentSettings(step_limit=limit))
    steps = done.events(StepTaken)
    assert len(steps) == done.result.steps <= limit
    assert steps[-1].action == Stop()
    assert (done.result.status, done.result.stop_reason) == (EpisodeStatus.STEP_LIMIT, StopReason.BUDGET)
    assert done.result.stop_reason.forced
    assert done.result.stopped


def test_the_gate_is_asked_once_more_when_no_look_around_is_left() -> None:
    enough = run()
    short = run(settings=AgentSettings(step_limit=enough.result.steps - 1))
    assert short.result.status is EpisodeStatus.STOPPED
    assert short.result.stop_reason is StopReason.GATE
    assert len(short.result.subtasks) == 2
    assert short.result.steps == enough.result.steps - 12


@pytest.mark.parametrize("at", [1, 7, 13, 16])
@pytest.mark.parametrize(
    ("error", "status", "reason"),
    [
        (EnvironmentFailure("the simulator died"), EpisodeStatus.ENVIRONMENT_FAILURE, StopReason.ENVIRONMENT),
        (SafetyStop("a person is near"), EpisodeStatus.SAFETY, StopReason.SAFETY),
        (KeyboardInterrupt(), EpisodeStatus.INTERRUPTED, StopReason.INTERRUPT),
    ],
)
def test_what_breaks_in_the_environment_ends_typed(
    error: BaseException, status: EpisodeStatus, reason: StopReason, at: int
) -> None:
    done = run(environment=Breaking(error, at))
    assert (done.result.status, done.result.stop_reason, done.result.stopped) == (status, reason, False)
    assert done.result.steps == at - 1
    assert done.result.detail
    assert done.sink.names()[-2:] == ["MapSaved", "EpisodeEnded"]


@pytest.mark.parametrize("who", ["planner", "executor"])
def test_a_run_that_has_spent_what_it_may_stops_the_body(who: str) -> None:
    spent = SpendingLimit("The run has spent 5 USD.")
    done = run([spent]) if who == "planner" else run(executor=[spent])
    assert (done.result.status, done.result.stop_reason) == (EpisodeStatus.INTERRUPTED, StopReason.SPENDING)
    assert done.result.stop_reason.forced
    assert done.result.detail == str(spent)
    steps = done.events(StepTaken)
    assert done.result.stopped
    assert steps[-1].action == Stop()
    assert len(steps) == done.result.steps == 13
    assert done.sink.names()[-2:] == ["MapSaved", "EpisodeEnded"]


FLIGHT = Anchor("stairs up", SpaceKind.FLOOR_TRANSITION, "stairs", CueKind.STAIRS)
LOW, HALF_WAY, HIGH = (0.0,) * 5, (0.3, 0.6, 0.9, 1.2), (2.8,) * 5
"""Heights of the images of a stage; a floor is believed after a few steady steps."""


@pytest.mark.parametrize(
    ("stages", "accepted"),
    [
        ([(0, HIGH)], True),
        ([(0, LOW)], False),
        ([(0, HALF_WAY)], False),
        ([(0, HALF_WAY), (0, HIGH)], True),
        ([(-1, HIGH), (0, HIGH)], True),  # the sofa below was verified late, from the top
        ([(0, HIGH), (0, HIGH)], True),  # half a metre more, on the new floor already
    ],
)
def test_a_goal_over_stairs_is_reached_by_the_change_of_floor(stages: list[tuple[int, Sequence[float]]], accepted: bool) -> None:
    world, camera = World(BlindDetector(), Components()), Flatland().spec.camera
    shape, chain = (camera.height_px, camera.width_px), (SOFA, FLIGHT)

    def see(x_m: float, z_m: float) -> Observation:
        observation = Observation(np.zeros((*shape, 3), np.uint8), np.zeros(shape, np.float32), Pose(x_m, 0.0, z_m), camera)
        world.integrate(observation)
        return observation

    seen = see(0.0, 0.0)
    for current, heights in stages:
        world.begin_stage(subtask_of(chain, current), seen.pose)
        for step, height in enumerate(heights):
            seen = see(0.25 * step, height)
    beside = LandmarkCandidate(0, "stairs", (0.0, 0.0, 0.0), 0.1, 0.0, 0.95, True, True, CueKind.STAIRS)
    feedback = Feedback(subtask_of(chain, 0), StageRecord(Pose(0.0, 0.0)), (beside,), StageEnd.STAGE_BUDGET)
    verdict = FinishJudge(world, AgentSettings()).claimed(subtask_of(chain, 1), feedback, Panorama((seen,), ()))
    assert verdict.accepted == accepted
    assert ("change_of_floor", accepted) in verdict.clauses


def test_each_flight_of_a_route_is_taken_for_itself() -> None:
    world, camera = World(BlindDetector(), Components()), Flatland().spec.camera
    shape, chain = (camera.height_px, camera.width_px), (FLIGHT, SOFA, replace(FLIGHT, space="stairs down"))
    told = []
    for current, height in [(-1, 0.0), (-1, 2.8), (0, 2.8), (1, 2.8), (1, 0.0)]:
        world.begin_stage(subtask_of(chain, current), Pose(0.0, 0.0, height))
        for step in range(5):
            pose = Pose(0.25 * step, 0.0, height)
            world.integrate(Observation(np.zeros((*shape, 3), np.uint8), np.zeros(shape, np.float32), pose, camera))
        told.append(world.changed_floor)
    assert told == [False, True, False, False, True]


def test_a_detector_is_asked_for_the_landmark_with_its_attributes() -> None:
    asked = []

    class Listening(BlindDetector):
        def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
            asked.append(tuple(queries))
            return super().detect(observations, queries)

    world, camera = World(Listening(), Components()), Flatland().spec.camera
    shape = (camera.height_px, camera.width_px)
    observation = Observation(np.zeros((*shape, 3), np.uint8), np.zeros(shape, np.float32), Pose(0.0, 0.0), camera)
    white = replace(SOFA, cue="white couch")
    world.perceive([observation], world.begin_stage(replace(subtask_of((white, BED), -1), landmark=white.cue), Pose(0.0, 0.0)))
    world.evidence(white, [observation])
    assert [terms[:2] for terms in asked] == [("white couch", "sofa")] * 2


def test_a_stop_that_fails_is_no_stop() -> None:
    steps = run().result.steps
    done = run(environment=Breaking(EnvironmentFailure("dead"), steps))
    assert done.result.status is EpisodeStatus.ENVIRONMENT_FAILURE
    assert not done.result.stopped


def interrupt(_: object) -> Stop:
    signal.raise_signal(signal.SIGINT)  # Ctrl-C
    return Stop()


@pytest.mark.parametrize("who", ["planner", "executor"])
def test_an_interrupt_ends_at_once_with_everything_told(who: str) -> None:
    done = run([interrupt]) if who == "planner" else run(executor=[interrupt])  # type: ignore[list-item]
    assert done.result.status is EpisodeStatus.INTERRUPTED
    assert len(done.events(EpisodeEnded)) == len(done.events(MapSaved)) == 1
    assert done.result.steps == 12


def told(events: list[Event]) -> list[str]:
    """Everything of a run that can differ, images included, as text."""
    lines = []
    for event in events:
        parts = [type(event).__name__]
        for name in event.__slots__:
            value = getattr(event, name)
            if name == "observation" and value is not None:
                value = (value.rgb.tobytes(), value.depth_m.tobytes(), value.pose)
            elif name == "views":
                value = [(view.label, view.rgb.tobytes(), view.obstacle_m, view.sightings) for view in value]
            elif name == "memory" and value is not None:
                value = (value.text, value.map_image.tobytes(), value.frontiers)
            elif name == "floors":
                value = [(floor.cells.tobytes(), floor.regions.tobytes()) for floor in value]
            parts.append(f"{name}={value!r}")
        lines.append(" ".join(parts))
    return lines


def test_two_runs_tell_the_same_events() -> None:
    assert told(run(queries=("sofa", "bed")).sink.events) == told(run(queries=("sofa", "bed")).sink.events)


def test_one_agent_runs_episode_after_episode_alike() -> None:
    sink = EventList()
    agent = NavigationAgent(
        Flatland(), LabelDetector(), ScriptedPlanner([by_feedback]), ScriptedExecutor([ahead]), None, [sink], lambda: 0.0
    )
    spec = EpisodeSpec("e", "flatland", Pose(0, 0), InstructionTask("Go."))
    results = [agent.run(spec) for _ in range(2)]
    assert results[0].steps == results[1].steps
    half = len(sink.events) // 2
    assert told(sink.events[:half]) == told(sink.events[half:])


def test_the_loop_fits_beside_the_paper() -> None:
    assert len(inspect.getsource(loop).splitlines()) < 150
