"""Every fault of a robot, while it drives: the velocity is zero within 0.3 s, the record is whole, the end has a name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from spacevln.assembly import Configuration
from spacevln.core import (
    Camera,
    Detection,
    EnvironmentFailure,
    EpisodeSpec,
    InstructionTask,
    MoveForward,
    Observation,
    Pose,
    SafetyStop,
)
from spacevln.environments.robot.environment import RobotEnvironment
from spacevln.environments.robot.profile import Images, Limits, Motions, RobotProfile, Topics
from spacevln.environments.robot.simulation.base import BaseSettings
from spacevln.environments.robot.simulation.lockstep import Lockstep
from spacevln.environments.robot.simulation.robot import SensorSettings
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.episode import Episode
from spacevln.recording import read_events
from spacevln.recording.schema import EpisodeEndedLine, StepTakenLine
from spacevln.testing.flatland import Box
from spacevln.testing.robot_world import FlatlandWorld

WITHIN_S = 0.3
PROFILE = RobotProfile(
    name="simulated",
    images=Images(width_px=0),
    limits=Limits(body_radius_m=0.2, unseen_m_s=0.35),
    motions=Motions(patience_s=1.0),
)
PATIENT = PROFILE.model_copy(update={"motions": Motions(patience_s=4.0)})
"""Waits until the guard knows that what is late is late for good."""
BY_TF = PROFILE.model_copy(update={"topics": Topics(odometry="")})
SENSORS = SensorSettings(Camera(16, 12, 79.0, 0.88), depth_encoding="32FC1")
ROOM = tuple(Box(*sides) for sides in ((6, -6, 6.1, 6), (-6.1, -6, -6, 6), (-6, 6, 6, 6.1), (-6, -6.1, 6, -6)))
WHOLE_S = 2.5
EPISODE = EpisodeSpec("1", "flatland", Pose(0.0, 0.0), InstructionTask("Go to the chair."))

Fault = Callable[[Lockstep], object]


def faulty(**changes: object) -> Fault:
    return lambda parts: [setattr(parts.robot.faults, name, value) for name, value in changes.items()]


FAULTS: dict[str, tuple[RobotProfile, Fault, str]] = {
    "colour stops": (PROFILE, faulty(silent=frozenset({"rgb"})), "environment_failure"),
    "depth stops": (PROFILE, faulty(silent=frozenset({"depth"})), "environment_failure"),
    "odometry stops": (PROFILE, faulty(silent=frozenset({"pose"})), "environment_failure"),
    "TF stops": (BY_TF, faulty(silent=frozenset({"pose"})), "environment_failure"),
    "clock jumps on": (PROFILE, faulty(clock_s=1.0), "safety"),
    "clock jumps back": (PATIENT, faulty(clock_s=-0.4), "safety"),
    "pose jumps": (PROFILE, faulty(pose_jump_m=0.5), "safety"),
    "depth is NaN": (PROFILE, faulty(blind=True), "environment_failure"),
    "operator stops": (PROFILE, lambda parts: parts.link.operate("stop"), "safety"),
    "transport dies": (PROFILE, faulty(cut=True), "environment_failure"),
    "wheels are blocked": (PROFILE, lambda parts: setattr(parts.robot.base, "blocked", True), "step_limit"),
}


class Nothing:
    """Detects nothing."""

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        del queries
        return [()] * len(observations)


@dataclass
class Broken:
    """A robot on which something breaks while it drives, the first time after a while."""

    parts: Lockstep
    environment: RobotEnvironment
    since_s: list[float]

    @classmethod
    def made(cls, profile: RobotProfile, fault: Fault) -> Broken:
        parts = Lockstep(profile, FlatlandWorld(ROOM), Pose(0.0, 0.0), 1, base=BaseSettings(slip=0.03), sensors=SENSORS)
        environment, since_s = RobotEnvironment(parts.transport, parts.link, profile, parts.clock), list[float]()

        def act() -> None:
            driving = parts.robot.base.speed_m_s > 0.25 or abs(parts.robot.base.turn_rad_s) > 0.6
            if not since_s and driving and parts.clock.now_s() >= environment.times.begin_s + WHOLE_S:
                since_s.append(parts.clock.now_s())
                fault(parts)

        parts.clock.each_tick.insert(0, act)
        return cls(parts, environment, since_s)

    def check_wheels(self, name: str) -> None:
        within, after = (
            [(v, w) for t, v, w in self.parts.commands if self.since_s[0] + a < t <= self.since_s[0] + b]
            for a, b in ((0.0, WITHIN_S + 1e-6), (WITHIN_S, 1.0))
        )
        if name == "wheels are blocked":  # tried again after a while, and noticed anew
            assert (0.0, 0.0) in within
        else:
            assert set(after) == {(0.0, 0.0)}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_on_a_turn_stops_the_wheels_and_the_record_is_whole(name: str, tmp_path: Path) -> None:
    """The agent's first look-around."""
    profile, fault, status = FAULTS[name]
    broken = Broken.made(profile, fault)
    with Session(Configuration(step_budget=12), broken.environment, detector=Nothing()) as session:
        result = session.attempt(Episode(EPISODE), tmp_path)
    broken.check_wheels(name)
    lines = list(read_events(tmp_path))
    steps = [line for line in lines if isinstance(line, StepTakenLine)]
    assert isinstance(lines[-1], EpisodeEndedLine)
    assert result.status == lines[-1].status == status
    assert lines[-1].steps == len(steps) == result.metrics.steps


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_on_the_way_ahead_stops_the_wheels(name: str) -> None:
    profile, fault, status = FAULTS[name]
    broken = Broken.made(profile, fault)
    broken.environment.reset(EPISODE)
    ends = {"environment_failure": EnvironmentFailure, "safety": SafetyStop, "step_limit": Stalled}
    with pytest.raises(ends[status]):
        go_on(broken.environment)
    broken.parts.clock.sleep(1.0)
    broken.check_wheels(name)


def go_on(environment: RobotEnvironment) -> None:
    for _ in range(4):
        if environment.execute(MoveForward(0.5)).collided:
            raise Stalled


class Stalled(Exception):  # noqa: N818 - a motion told as short
    pass
