"""Tracking by true pose, with slip and pose noise of 1 cm and 0.5 degrees: the statistics of many targets, simulated clock."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest

from spacevln.core import Camera, EpisodeSpec, InstructionTask, MoveForward, Pose, TurnLeft, TurnRight
from spacevln.core.geometry import wrap_angle
from spacevln.environments.robot.environment import RobotEnvironment
from spacevln.environments.robot.profile import Images, Limits, RobotProfile, Watchdog
from spacevln.environments.robot.simulation.base import BaseSettings
from spacevln.environments.robot.simulation.lockstep import Lockstep
from spacevln.environments.robot.simulation.robot import SensorSettings
from spacevln.testing.flatland import Box
from spacevln.testing.robot_world import FlatlandWorld

WITHIN_M, WITHIN_RAD, SHARE = 0.05, math.radians(3.0), 0.95
PROFILE = RobotProfile(
    name="simulated",
    images=Images(width_px=0),
    limits=Limits(unseen_m_s=0.35),  # so small a camera sees little of the floor; full speed is the harder case
    watchdog=Watchdog(image_s=1.5),
)
SENSORS = SensorSettings(Camera(16, 12, 79.0, 0.88), image_hz=2.0, drop_rate=0.0)
ROOM = tuple(Box(*sides) for sides in ((4, -4, 4.1, 4), (-4.1, -4, -4, 4), (-4, 4, 4, 4.1), (-4, -4.1, 4, -4)))


@dataclass(frozen=True)
class Tracked:
    """Of one primitive: distance and angle from where it should have ended, and sign changes of the command in tolerance."""

    off_m: float
    off_rad: float
    changes: int


def track(environment: RobotEnvironment, parts: Lockstep, action: MoveForward | TurnLeft | TurnRight) -> Tracked:
    before, trail, begin = parts.robot.base.pose, list[Pose](), len(parts.commands)
    parts.clock.each_tick.append(lambda: trail.append(parts.robot.base.pose))
    environment.execute(action)
    parts.clock.each_tick.pop()
    goal = before.compose(_asked(action))
    every = len(trail) // max(1, len(parts.commands) - begin)
    inside = [_inside(pose, goal, action) for pose in trail[every - 1 :: every]]
    commands = parts.commands[begin:][inside.index(True) :] if True in inside else []
    after = parts.robot.base.pose
    return Tracked(
        after.distance_m(goal.x_m, goal.y_m),
        abs(wrap_angle(after.yaw_rad - goal.yaw_rad)),
        max(map(_changes, _columns(commands))),
    )


def _asked(action: MoveForward | TurnLeft | TurnRight) -> Pose:
    if isinstance(action, MoveForward):
        return Pose(action.distance_m, 0.0)
    return Pose(0.0, 0.0, 0.0, math.radians(action.angle_deg) * (1 if isinstance(action, TurnLeft) else -1))


def _inside(pose: Pose, goal: Pose, action: MoveForward | TurnLeft | TurnRight) -> bool:
    if isinstance(action, MoveForward):
        return pose.distance_m(goal.x_m, goal.y_m) < WITHIN_M
    return abs(wrap_angle(pose.yaw_rad - goal.yaw_rad)) < WITHIN_RAD


def _columns(commands: list[tuple[float, float, float]]) -> tuple[list[float], list[float]]:
    return [v for _, v, _ in commands], [w for _, _, w in commands]


def _changes(values: list[float]) -> int:
    signs = [math.copysign(1.0, value) for value in values if value]
    return sum(a != b for a, b in itertools.pairwise(signs))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_targets_are_met_by_true_pose(seed: int) -> None:
    """Fifty forwards of 0.5 m and fifty turns, to both sides."""
    parts = Lockstep(PROFILE, FlatlandWorld(ROOM), Pose(0.0, 0.0), seed, base=BaseSettings(slip=0.03), sensors=SENSORS)
    environment = RobotEnvironment(parts.transport, parts.link, PROFILE, parts.clock)
    environment.reset(EpisodeSpec("1", "flatland", Pose(0.0, 0.0), InstructionTask("go")))
    forwards, turns = list[Tracked](), list[Tracked]()
    for index in range(50):
        turns.append(track(environment, parts, TurnLeft(45.0) if index % 16 < 8 else TurnRight(45.0)))
        forwards.append(track(environment, parts, MoveForward(0.5)))
    assert np.mean([each.off_m <= WITHIN_M for each in forwards]) >= SHARE
    assert np.mean([each.off_rad <= WITHIN_RAD for each in turns]) >= SHARE
    assert max(each.changes for each in (*forwards, *turns)) <= 2
    assert parts.robot.base.contacts == 0
