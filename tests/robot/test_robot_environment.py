"""The robot as an environment, in Flatland, under a simulated clock."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacevln.core import Camera, EnvironmentFailure, EpisodeSpec, InstructionTask, MoveForward, Pose, SafetyStop, Stop, TurnLeft
from spacevln.core.geometry import wrap_angle
from spacevln.environments.robot.environment import RobotEnvironment
from spacevln.environments.robot.profile import Images, Limits, RobotProfile, Topics
from spacevln.environments.robot.simulation.base import BaseSettings
from spacevln.environments.robot.simulation.lockstep import Lockstep
from spacevln.environments.robot.simulation.robot import SensorSettings
from spacevln.testing.flatland import Box
from spacevln.testing.robot_world import FlatlandWorld

PROFILE = RobotProfile(
    name="simulated", images=Images(width_px=0), limits=Limits(body_radius_m=0.2), topics=Topics(labels="/labels")
)
EPISODE = EpisodeSpec("1", "flatland", Pose(0.0, 0.0), InstructionTask("go"))
CAMERA = Camera(48, 36, 79.0, 0.88)
START = Pose(-1.2, -1.2, 0.0, 0.4)
EXACT = SensorSettings(CAMERA, pose_noise_m=0.0, pose_noise_deg=0.0, depth_noise=0.0, drop_rate=0.0)
NOISY = SensorSettings(CAMERA, drop_rate=0.0)


def made(
    start: Pose = START, sensors: SensorSettings = EXACT, boxes: tuple[Box, ...] | None = None, slip: float = 0.0, **options: bool
) -> tuple[RobotEnvironment, Lockstep]:
    parts = Lockstep(PROFILE, FlatlandWorld(boxes), start, 1, base=BaseSettings(slip=slip), sensors=sensors, **options)
    environment = RobotEnvironment(parts.transport, parts.link, PROFILE, parts.clock, **options)
    environment.reset(EPISODE)
    return environment, parts


def test_eight_turns_are_a_look_around() -> None:
    environment, parts = made(sensors=NOISY, slip=0.03)
    assert environment.spec.lookaround_count == 8
    assert environment.observe().pose == Pose(0.0, 0.0)
    for k in range(1, 9):
        environment.execute(TurnLeft(45.0))
        true = wrap_angle(parts.robot.base.pose.yaw_rad - START.yaw_rad)
        assert abs(math.degrees(wrap_angle(true - math.radians(45 * k)))) < 3.0
    assert parts.robot.base.pose.distance_m(START.x_m, START.y_m) < 0.02
    assert environment.times.first_motion_s is not None
    assert 0.5 < environment.times.moving_s / (parts.clock.now_s() - environment.times.begin_s) < 1.0


def test_forward_reports_what_really_happened_and_labels_arrive() -> None:
    environment, parts = made(sensors=NOISY, slip=0.03)
    before = parts.robot.base.pose
    motion = environment.execute(MoveForward(0.5))
    there = parts.robot.base.pose
    assert before.distance_m(there.x_m, there.y_m) == pytest.approx(0.5, abs=0.05)
    assert motion.moved_m == pytest.approx(0.5, abs=0.06)
    assert not motion.collided
    seen = environment.observe()
    assert seen.labels is None  # nobody told the names
    assert seen.depth_m.shape == (36, 48)
    assert environment.live() is not None
    environment.execute(Stop())
    environment.close()
    environment.close()


@pytest.mark.parametrize("then", [MoveForward(0.5), TurnLeft(45.0)])
def test_a_way_gone_while_a_model_thought_counts(then: MoveForward | TurnLeft) -> None:
    """The next forward ends where it would have; a turn tells of the way, too."""
    environment, parts = made(Pose(-1.2, -1.2))
    end_s = parts.clock.now_s() + 1.2
    environment.proceed(9.0, lambda: parts.clock.now_s() >= end_s)
    gone_m = parts.robot.base.pose.x_m + 1.2
    assert 0.03 < gone_m < 0.3
    assert parts.commands[-1][1:] == (0.0, 0.0)
    motion = environment.execute(then)
    assert not motion.collided
    assert motion.moved_m == pytest.approx(0.5 if isinstance(then, MoveForward) else gone_m, abs=0.03)
    environment.proceed(9.0, lambda: False)
    assert environment.execute(MoveForward(0.5)).moved_m == pytest.approx(0.5, abs=0.03)  # one step at most


def test_a_wall_ends_a_forward_before_contact() -> None:
    wall = (Box(1.0, -2.0, 1.1, 2.0),)
    environment, parts = made(Pose(0.0, 0.0), boxes=wall)
    assert not environment.execute(MoveForward(0.5)).collided
    motion = environment.execute(MoveForward(0.5))
    assert motion.collided
    assert motion.moved_m < 0.3
    assert parts.robot.base.contacts == 0
    assert parts.robot.base.pose.x_m < 1.0 - 0.2


def test_blocked_wheels_are_a_stall_and_not_the_end() -> None:
    environment, parts = made()
    parts.robot.base.blocked = True
    motion = environment.execute(MoveForward(0.5))
    assert motion.collided
    assert motion.moved_m < 0.05
    parts.robot.base.blocked = False
    assert not environment.execute(MoveForward(0.5)).collided


@pytest.mark.parametrize(("stream", "reason"), [("depth", "depth"), ("pose", "pose"), ("rgb", "rgb")])
def test_a_stream_that_stays_away_ends_the_episode(stream: str, reason: str) -> None:
    environment, parts = made()
    fault_s = parts.clock.now_s() + 1.0
    parts.clock.each_tick.append(
        lambda: setattr(parts.robot.faults, "silent", frozenset({stream}) if parts.clock.now_s() > fault_s else frozenset())
    )
    with pytest.raises(EnvironmentFailure, match=rf"\({reason}\)"):
        environment.execute(MoveForward(0.5))
    late = [(v, w) for t, v, w in parts.commands if t > fault_s + 0.3 + EXACT.image_latency_s]
    assert set(late) == {(0.0, 0.0)}


def test_a_stream_that_comes_back_lets_the_primitive_go_on() -> None:
    environment, parts = made()
    begin_s = parts.clock.now_s() + 1.0
    parts.clock.each_tick.append(
        lambda: setattr(
            parts.robot.faults, "silent", frozenset({"depth"}) if begin_s < parts.clock.now_s() < begin_s + 2 else frozenset()
        )
    )
    assert not environment.execute(MoveForward(0.5)).collided
    assert environment.times.held_s > 1.0


def test_an_operator_stop_that_nobody_resumes_is_a_safety_stop() -> None:
    environment, parts = made()
    parts.clock.each_tick.append(lambda: parts.link.operate("stop") if parts.clock.now_s() > 1.5 else None)
    with pytest.raises(SafetyStop, match="operator"):
        environment.execute(MoveForward(0.5))


def test_a_resumed_operator_stop_drops_the_rest_of_the_primitive() -> None:
    environment, parts = made()
    at_s = parts.clock.now_s()

    def operator() -> None:
        if abs(parts.clock.now_s() - at_s - 1.0) < 0.005:
            assert parts.transport.call_trigger(PROFILE.topics.stop).success  # type: ignore[union-attr]
        if abs(parts.clock.now_s() - at_s - 3.0) < 0.005:
            assert parts.transport.call_trigger(PROFILE.topics.resume).success  # type: ignore[union-attr]

    parts.clock.each_tick.append(operator)
    motion = environment.execute(MoveForward(0.5))
    assert motion.collided
    assert 0.05 < motion.moved_m < 0.4
    assert not environment.execute(TurnLeft(45.0)).collided


def test_a_pose_jump_stops_the_robot() -> None:
    environment, parts = made()
    begin_s = parts.clock.now_s() + 1.0
    parts.clock.each_tick.append(
        lambda: setattr(parts.robot.faults, "pose_jump_m", 0.5 if parts.clock.now_s() > begin_s else 0.0)
    )
    with pytest.raises(SafetyStop, match="pose_jump"):
        environment.execute(MoveForward(0.5))
    late = [(v, w) for t, v, w in parts.commands if t > begin_s + 0.3]
    assert set(late) == {(0.0, 0.0)}


def test_in_a_dry_run_nothing_moves() -> None:
    environment, parts = made(dry=True)
    for action in (TurnLeft(45.0), MoveForward(0.5)):
        motion = environment.execute(action)
        assert motion.collided
        assert abs(motion.moved_m) + abs(motion.turned_rad) < 1e-6
    assert np.abs([command[1:] for command in parts.commands]).max() == 0.0


def test_a_robot_that_is_not_heard_says_what_is_missing() -> None:
    parts = Lockstep(PROFILE, FlatlandWorld(), START, 1, sensors=EXACT)
    parts.robot.faults.silent = frozenset({"rgb", "depth"})
    with pytest.raises(EnvironmentFailure, match="/camera/color/camera_info"):
        RobotEnvironment(parts.transport, parts.link, PROFILE, parts.clock)
