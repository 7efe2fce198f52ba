"""The rule planner and executor on synthetic boundaries, and under the public conformance suites."""

import math
from dataclasses import replace

import numpy as np
import pytest
from plain_space import PlainSpace, context, seen

from spacevln.control import ControlSettings, validate_subtask
from spacevln.core import (
    AdmissibleActions,
    Camera,
    ExecutedDecision,
    ExecutorContext,
    Feedback,
    InstructionTask,
    ModelError,
    MoveForward,
    ObjectGoalTask,
    Observation,
    ObstacleDistances,
    Pose,
    SpaceKind,
    StageEnd,
    StageRecord,
    Stop,
    Subtask,
    TurnLeft,
    TurnRight,
)
from spacevln.core.stages import Anchor
from spacevln.reasoning.rules import RuleExecutor, RulePlanner
from spacevln.testing.reasoning import ExecutorConformance, PlannerConformance

# a living room west of a hallway; a doorway leads on east into a bedroom, another one north into a bathroom
ROOMS = PlainSpace([(-2, -2, 2, 2), (2, -0.5, 2.2, 0.5), (2.2, -2, 6, 2), (-0.5, 2, 0.5, 2.2), (-2, 2.2, 2, 5)])
START = Pose(-1.0, -1.0, 0.0, 0.0)


def sightings(pose: Pose = START) -> list[object]:
    return [
        seen("sofa", -1.9, 0.5, pose, "white"),
        seen("doorway", 2.1, 0.0, pose, width_m=1.0),
        seen("doorway", 0.0, 2.1, pose, width_m=1.0, along_rad=0.0),
        seen("bed", 5.5, 1.0, pose, "blue"),
        seen("nightstand", 5.6, -0.5, pose),
        seen("toilet", -1.0, 4.8, pose),
        seen("bathtub", 1.0, 4.8, pose),
    ]


def first(instruction: str, planner: RulePlanner | None = None) -> Subtask:
    boundary = context(InstructionTask(instruction), START, ROOMS, sightings())  # type: ignore[arg-type]
    reply = (planner or RulePlanner()).plan(boundary)
    assert validate_subtask(reply, boundary, ControlSettings()) == []
    return reply.subtask


def test_the_instruction_decides_which_door_is_taken() -> None:
    bed = first("Leave the living room and walk into the bedroom. Stop next to the bed.")
    bath = first("Exit the living room. Enter the bathroom and wait by the bathtub.")
    assert bed.target_m is not None
    assert bath.target_m is not None
    assert bed.target_m[0] > 4.0
    assert bath.target_m[1] > 3.0
    assert bed.landmark == "bed"
    assert bath.final_anchor.cue == "bathtub"


def test_left_and_right_are_those_of_the_walk() -> None:
    left = first("Walk past the white sofa and go through the door on the left. Stop.")
    ahead = first("Go straight through the door. Stop.")
    assert left.target_m is not None
    assert ahead.target_m is not None
    assert left.target_m[1] > 2.0
    assert ahead.target_m[0] > 2.0


def test_same_contexts_give_the_same_replies_and_reset_forgets() -> None:
    planner = RulePlanner()
    once = first("Leave the room and enter the bedroom.", planner)
    planner.reset()
    assert first("Leave the room and enter the bedroom.", planner) == once


def test_the_stage_that_reached_the_goal_is_followed_by_completion() -> None:
    planner = RulePlanner()
    task = InstructionTask("Leave the living room and walk into the bedroom. Stop next to the bed.")
    subtask = planner.plan(context(task, START, ROOMS, sightings())).subtask  # type: ignore[arg-type]
    assert subtask.target_m is not None
    there = Pose(subtask.target_m[0], subtask.target_m[1], 0.0, 0.0)
    feedback = Feedback(subtask, StageRecord(START), (), StageEnd.ARRIVAL)
    boundary = context(task, there, ROOMS, sightings(there), stage=1, feedback=feedback, last_subtask=subtask)  # type: ignore[arg-type]
    reply = planner.plan(boundary)
    assert reply.subtask.complete
    assert reply.subtask.next_anchor is None
    assert validate_subtask(reply, boundary, ControlSettings()) == []
    again = planner.plan(replace(boundary, rejections=("finish refused",)))
    assert not again.subtask.complete


@pytest.mark.parametrize("text", ["", "\U0001f600", "\u53bb\u53a8\u623f"])
def test_an_instruction_that_names_nothing_is_a_typed_failure(text: str) -> None:
    with pytest.raises(ModelError, match="names no place or action"):
        first(text)


def test_object_goals_head_for_a_seen_instance_else_for_a_likely_room() -> None:
    goal = RulePlanner().plan(context(ObjectGoalTask("couch"), START, ROOMS, sightings())).subtask  # type: ignore[arg-type]
    assert goal.landmark == "couch"
    unseen = RulePlanner().plan(context(ObjectGoalTask("shower"), START, ROOMS, sightings())).subtask  # type: ignore[arg-type]
    assert unseen.target_m is not None
    assert unseen.target_m[1] > 2.0
    assert unseen.final_anchor.cue == "shower"
    assert not unseen.targets_final_anchor


def test_without_memory_it_still_plans() -> None:
    boundary = context(InstructionTask("Go into the bedroom."), START, ROOMS, sightings(), memory=False)  # type: ignore[arg-type]
    reply = RulePlanner().plan(boundary)
    assert validate_subtask(reply, boundary, ControlSettings()) == []


def executor_context(pose: Pose, target: tuple[float, float], admissible: AdmissibleActions) -> ExecutorContext:
    anchor = Anchor("bedroom", SpaceKind.ROOM)
    subtask = Subtask((anchor, anchor), 0, anchor, anchor, "front", "go", "", False, target_m=(*target, 0.0))
    observation = Observation(np.zeros((4, 4, 3), np.uint8), np.ones((4, 4), np.float32), pose, Camera(4, 4, 79.0, 0.88))
    return ExecutorContext(observation, ObstacleDistances(2, 2, 2), (), subtask, StageRecord(pose), admissible, ROOMS, 5)


FREE = AdmissibleActions((0.25, 0.5, 0.75, 1.0, 1.25), True, True)


@pytest.mark.parametrize("yaw_deg", range(-180, 180, 45))
def test_the_executor_reaches_its_target_through_the_door_and_stops(yaw_deg: int) -> None:
    executor, pose = RuleExecutor(), Pose(-1.0, -1.0, 0.0, math.radians(yaw_deg))
    for _ in range(30):
        action = executor.act(executor_context(pose, (4.5, 0.5), FREE)).action
        match action:
            case Stop():
                break
            case MoveForward(distance_m=d):
                pose = pose.compose(Pose(d, 0.0))
            case TurnLeft(angle_deg=angle):
                pose = pose.turned(math.radians(angle))
            case TurnRight(angle_deg=angle):
                pose = pose.turned(-math.radians(angle))
        assert ROOMS.is_free([[pose.x_m, pose.y_m]]).all()
    assert pose.distance_m(4.5, 0.5) <= 0.45


@pytest.mark.parametrize(
    "admissible",
    [AdmissibleActions((), True, False), AdmissibleActions((), False, True), AdmissibleActions((0.25,), False, False)],
)
def test_the_executor_stays_inside_the_admissible_actions(admissible: AdmissibleActions) -> None:
    for yaw in np.linspace(-3, 3, 9):
        reply = RuleExecutor().act(executor_context(Pose(0.0, 0.0, 0.0, float(yaw)), (4.5, 0.5), admissible))
        assert admissible.allows(reply.action)


def test_what_the_body_slid_along_is_a_wall_on_that_side() -> None:
    executor, target = RuleExecutor(), (-0.25, -0.25)
    there = Pose(-0.85, -1.1, 0.0, 0.0)  # asked was a step ahead: something to the front left pushed to the right
    assert isinstance(executor.act(executor_context(START, target, FREE)).action, TurnLeft)
    step = ExecutedDecision(MoveForward(0.25), None, 0.18, 0.0, 1, False, True)
    felt = replace(executor_context(there, target, FREE), progress=StageRecord(START, (step,)))
    turn = executor.act(felt).action
    unfelt = RuleExecutor().act(executor_context(there, target, FREE)).action
    assert isinstance(unfelt, TurnLeft)
    assert unfelt.angle_deg == pytest.approx(60.0)
    assert turn != unfelt


def test_a_goal_that_comes_into_view_ends_the_stage_once() -> None:
    lamp, other = seen("lamp", 1.0, 0.0, START), seen("lamp", 1.0, -1.5, START)
    to_the_door = executor_context(START, (4.5, 0.5), FREE)
    final = Anchor("", SpaceKind.UNKNOWN, "lamp")
    plain = replace(to_the_door, subtask=replace(to_the_door.subtask, chain=(*to_the_door.subtask.chain, final)))
    executor = RuleExecutor()
    assert not isinstance(executor.act(replace(plain, goal="lamp")).action, Stop)
    assert isinstance(executor.act(replace(plain, goal="lamp", glimpsed=(lamp,))).action, Stop)
    assert not isinstance(executor.act(replace(plain, goal="lamp", glimpsed=(lamp,))).action, Stop)  # the planner knows of it
    assert isinstance(executor.act(replace(plain, goal="lamp", glimpsed=(lamp, other))).action, Stop)
    assert not isinstance(executor.act(replace(plain, goal="sofa", glimpsed=(lamp,))).action, Stop)
    assert not isinstance(executor.act(replace(plain, glimpsed=(lamp,))).action, Stop)  # an instruction names no goal object
    executor.reset()
    assert isinstance(executor.act(replace(plain, goal="lamp", glimpsed=(lamp,))).action, Stop)


class TestRulePlanner(PlannerConformance):
    """The public suite."""

    def make_planner(self) -> RulePlanner:
        return RulePlanner()


class TestRuleExecutor(ExecutorConformance):
    """The public suite."""

    def make_executor(self) -> RuleExecutor:
        return RuleExecutor()
