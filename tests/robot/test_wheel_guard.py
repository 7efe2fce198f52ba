"""The guard's rules under a clock that the test turns."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from spacevln.core import Camera, Pose
from spacevln.environments.robot.calibration import info_of
from spacevln.environments.robot.guard.status import GuardState, StopReason
from spacevln.environments.robot.guard.wheel import WheelGuard
from spacevln.environments.robot.messages import Header
from spacevln.environments.robot.profile import Limits, Mount, RobotProfile
from spacevln.environments.robot.transforms import matrix_of_mount

TICK_S = 0.02
CAMERA = Camera(80, 60, 79.0, 0.88)
INFO = info_of(CAMERA, Header(0))
T_BASE_CAMERA = matrix_of_mount(Mount(z_m=0.88))
BELOW = (np.arange(60)[:, None] - INFO.k[5]) / INFO.k[4]
FLOOR_M = 0.88 / np.maximum(BELOW, 1e-3)
"""Depth of the empty floor: first seen 1.4 m ahead."""


class Hand:
    """A clock turned by hand."""

    def __init__(self) -> None:
        self.t_s = 100.0

    def now_s(self) -> float:
        return self.t_s

    def stamp_ns(self) -> int:
        return round(self.t_s * 1e9)

    def sleep(self, duration_s: float) -> None:
        self.t_s += duration_s


SEEN = Limits(unseen_m_s=0.35)
"""Unseen floor does not matter."""


class Bench:
    """A guard with a body that does what it is told, and a wall ahead."""

    def __init__(self, limits: Limits = SEEN, wall_m: float = 4.0) -> None:
        self.clock = Hand()
        self.guard = WheelGuard(RobotProfile(name="t", limits=limits), self.clock)
        self.pose, self.wall_m, self.wall_top_m = Pose(0.0, 0.0), wall_m, 9.0
        self.silent: set[str] = set()
        self.offset_s, self.jump_m, self.blind, self.stuck, self.floor = 0.0, 0.0, False, False, False
        self.command = (0.0, 0.0)
        self.count = 0

    def run(self, seconds: float, wish: tuple[float, float] | None = (0.3, 0.0)) -> list[tuple[float, float]]:
        commands = []
        for _ in range(round(seconds / TICK_S)):
            self.clock.t_s += TICK_S
            self.count += 1
            if not self.stuck:
                self.pose = self.pose.compose(Pose(self.command[0] * TICK_S, 0.0, 0.0, self.command[1] * TICK_S))
            self._measure()
            if wish is not None:
                self.guard.wish(*wish)
            self.command = self.guard.tick()
            commands.append(self.command)
        return commands

    def _measure(self) -> None:
        stamp_ns = self.clock.stamp_ns() + round(self.offset_s * 1e9)
        if "pose" not in self.silent:
            self.guard.hear_pose(stamp_ns, Pose(self.pose.x_m + self.jump_m, self.pose.y_m, 0.0, self.pose.yaw_rad))
        if self.count % 5 == 0:
            if "rgb" not in self.silent:
                self.guard.hear_rgb(stamp_ns)
            if "depth" not in self.silent:
                self.guard.hear_depth(stamp_ns, self._depth_m(), INFO, T_BASE_CAMERA)

    def _depth_m(self) -> NDArray[np.float32]:
        left_m = self.wall_m - self.pose.x_m
        wall_m = np.where((0.88 - BELOW * left_m < self.wall_top_m) & (left_m > 0), left_m, 50.0)
        depth_m = np.minimum(wall_m, FLOOR_M) if self.floor else wall_m
        return np.repeat(depth_m * (not self.blind), 80, axis=1).astype(np.float32)


def test_nothing_moves_before_everything_is_heard() -> None:
    bench = Bench()
    bench.silent = {"rgb"}
    assert set(bench.run(1.0)) == {(0.0, 0.0)}
    assert bench.guard.status().reason is StopReason.RGB
    bench.silent = set()
    assert bench.run(1.0)[-1] == (0.3, 0.0)


def test_speed_and_acceleration_are_limited() -> None:
    bench = Bench()
    bench.run(0.2, (0.0, 0.0))
    commands = np.array(bench.run(2.0, (9.0, -9.0)))
    limits = Limits()
    assert commands.max(axis=0)[0] == limits.speed_m_s
    assert commands.min(axis=0)[1] == -limits.turn_rad_s
    assert np.diff(commands[:, 0]).max() <= limits.accel_m_s2 * TICK_S + 1e-9
    assert np.abs(np.diff(commands[:, 1])).max() <= limits.turn_accel_rad_s2 * TICK_S + 1e-9
    assert np.array(bench.run(1.0, (-1.0, 0.0)))[:, 0].min() >= 0.0  # never backwards


def test_the_body_stops_before_a_wall() -> None:
    bench = Bench(wall_m=2.0)
    bench.run(15.0, (0.35, 0.0))
    limits = Limits()
    assert 2.0 - bench.pose.x_m - limits.body_radius_m == pytest.approx(limits.stop_m, abs=0.08)
    assert bench.command == (0.0, 0.0)
    assert bench.guard.status().limited
    assert bench.run(1.0, (0.0, 0.5))[-1] == (0.0, 0.5)  # turning on the spot is allowed


def test_what_was_seen_low_is_remembered_when_it_is_too_near_to_be_seen() -> None:
    bench = Bench(wall_m=1.2)
    bench.wall_top_m, bench.floor = 0.35, True  # at 0.85 m the camera looks over it
    bench.run(0.3, (0.0, 0.0))
    bench.run(25.0, None)
    bench.run(8.0, (0.35, 0.0))
    assert bench.pose.x_m < 1.2 - Limits().body_radius_m


def test_floor_that_was_never_seen_is_crossed_slowly_and_what_was_seen_is_not_forgotten() -> None:
    bench, limits = Bench(Limits(), wall_m=9.0), Limits()
    bench.floor = True
    bench.run(0.3, (0.0, 0.0))
    slow = bench.run(10.0, (0.35, 0.0))
    assert max(v for v, _ in slow) == limits.unseen_m_s
    assert bench.pose.x_m == pytest.approx(10 * limits.unseen_m_s, abs=0.05)
    bench.run(8.0, (0.35, 0.0))
    assert bench.command == (limits.speed_m_s, 0.0)  # 1.4 m from the start everything was seen
    bench.run(1.0, (0.0, 0.0))
    bench.run(10.0, None)
    assert bench.run(1.0, (0.35, 0.0))[-1] == (limits.speed_m_s, 0.0)


@pytest.mark.parametrize(("top_m", "forgotten"), [(1.8, True), (0.35, False)])
def test_what_is_gone_is_forgotten_if_the_camera_would_see_it(top_m: float, forgotten: bool) -> None:
    bench = Bench(wall_m=1.2)
    bench.floor, bench.wall_top_m = True, top_m
    bench.run(0.3, (0.0, 0.0))
    assert bench.guard.status().free_m == pytest.approx(1.2 - 0.25 - 0.1, abs=0.06)
    bench.wall_m = 9.0
    bench.run(2.0, (0.0, 0.0))
    assert (bench.guard.status().free_m > 2.5) is forgotten


def test_floor_in_the_place_of_something_low_frees_it() -> None:
    bench = Bench(wall_m=float(FLOOR_M[54, 0]))  # rows of this small image are farther apart than the guard's cells
    bench.floor, bench.wall_top_m = True, 0.35
    bench.run(0.3, (0.0, 0.0))
    bench.wall_m = 9.0
    bench.run(0.5, (0.0, 0.0))
    assert bench.guard.status().free_m > 2.5


@pytest.mark.parametrize("stream", ["pose", "rgb", "depth"])
def test_a_lost_stream_stops_within_0_3_s_and_its_return_resumes(stream: str) -> None:
    bench = Bench(wall_m=9.0)
    bench.run(1.5)
    bench.silent = {stream}
    commands = bench.run(0.3)
    assert commands[-1] == (0.0, 0.0)
    assert bench.guard.status().state is GuardState.HELD
    assert bench.guard.status().reason == stream
    bench.silent = set()
    assert bench.run(1.5)[-1] == (0.3, 0.0)
    assert bench.guard.status().stops == 1


def test_a_silent_agent_stops_within_0_3_s() -> None:
    bench = Bench(wall_m=9.0)
    bench.run(1.5)
    assert bench.run(0.3, None)[-1] == (0.0, 0.0)
    assert bench.guard.status().reason is StopReason.AGENT
    assert bench.run(1.0)[-1] == (0.3, 0.0)
    bench.guard.wish(0.0, 0.0)
    bench.run(1.0, None)  # who has asked for standing still may be silent
    assert bench.guard.status().state is GuardState.READY


def test_blind_depth_stops() -> None:
    bench = Bench(wall_m=9.0)
    bench.run(1.5)
    bench.blind = True
    assert bench.run(0.3)[-1] == (0.0, 0.0)
    assert bench.guard.status().reason is StopReason.BLIND


@pytest.mark.parametrize(
    ("change", "reason"), [({"offset_s": 1.0}, "clock"), ({"offset_s": 0.3}, "clock"), ({"jump_m": 0.4}, "pose_jump")]
)
def test_jumps_latch_until_the_operator_resumes(change: dict[str, float], reason: str) -> None:
    bench = Bench(wall_m=9.0)
    bench.run(2.5)
    for name, value in change.items():
        setattr(bench, name, value)
    assert bench.run(0.1)[-1] == (0.0, 0.0)
    assert bench.guard.status().reason == reason
    assert bench.guard.status().state is GuardState.STOPPED
    bench.offset_s = 0.0
    assert bench.run(0.5)[-1] == (0.0, 0.0)
    bench.guard.operate("resume")
    assert bench.run(1.5)[-1] == (0.3, 0.0)


def test_late_messages_hold_the_wheels_for_as_long_as_they_are_late() -> None:
    """A busy network is no clock that jumped."""
    bench = Bench(wall_m=20.0)
    bench.run(2.5)
    bench.offset_s = -0.3
    assert bench.run(0.3)[-1] == (0.0, 0.0)
    assert bench.guard.status().state is GuardState.HELD
    bench.offset_s = 0.0
    assert bench.run(1.5)[-1] == (0.3, 0.0)
    assert bench.guard.status().stops == 1


def test_what_is_late_at_the_start_is_no_jump() -> None:
    bench = Bench(wall_m=20.0)
    bench.offset_s = -0.4
    bench.run(0.5)
    bench.offset_s = 0.0
    assert bench.run(3.0)[-1] == (0.3, 0.0)
    assert bench.guard.status().stops == 0


def test_what_is_late_for_good_has_another_clock() -> None:
    bench = Bench(wall_m=20.0)
    bench.run(2.5)
    bench.offset_s = -0.3
    commands = bench.run(2.5)
    assert set(commands[15:]) == {(0.0, 0.0)}
    assert bench.guard.status().reason is StopReason.CLOCK
    bench.offset_s = 0.0
    assert bench.run(0.5)[-1] == (0.0, 0.0)
    bench.guard.operate("resume")
    assert bench.run(1.5)[-1] == (0.3, 0.0)


def test_clocks_that_drift_apart_slowly_are_no_jump() -> None:
    bench = Bench(wall_m=90.0)
    for k in range(20):
        bench.offset_s = 0.02 * k
        bench.run(2.0)
    assert bench.guard.status().stops == 0


@pytest.mark.parametrize("wish", [(0.35, 0.0), (0.0, 0.8)])
def test_wheels_that_do_not_turn_are_noticed_within_0_3_s(wish: tuple[float, float]) -> None:
    bench = Bench(wall_m=9.0)
    bench.run(1.5, wish)
    bench.stuck = True
    commands = bench.run(0.3, wish)
    assert commands[-1] == (0.0, 0.0)
    assert bench.guard.status().reason is StopReason.WHEELS
    bench.stuck = False
    assert bench.run(0.5, wish)[-1] == (0.0, 0.0)  # until the agent has asked for standing still
    bench.guard.wish(0.0, 0.0)
    assert bench.run(1.5, wish)[-1] == wish


def test_blocked_wheels_are_noticed_when_creeping_too() -> None:
    """A creeping body must be pushed for some centimetres before its pose tells that it does not move."""
    bench = Bench(wall_m=9.0)
    bench.run(3.0, (0.08, 0.0))
    assert bench.guard.status().stops == 0
    bench.stuck = True
    assert bench.run(1.2, (0.08, 0.0))[-1] == (0.0, 0.0)
    assert bench.guard.status().reason is StopReason.WHEELS


def test_the_operator_stops_in_every_state() -> None:
    for before in ("moving", "still", "held"):
        bench = Bench(wall_m=9.0)
        bench.silent = {"rgb"} if before == "held" else set()
        bench.run(1.0, (0.3, 0.0) if before == "moving" else (0.0, 0.0))
        bench.guard.operate("stop")
        assert bench.run(TICK_S)[-1] == (0.0, 0.0)
        assert bench.guard.status().reason is StopReason.OPERATOR
        bench.silent = set()
        assert set(bench.run(1.0)) == {(0.0, 0.0)}
        bench.guard.operate("resume")
        assert bench.run(1.0)[-1] == (0.3, 0.0)


def test_the_fence_stops_ahead_of_it_and_latches_outside() -> None:
    fence = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    bench = Bench(Limits(geofence_m=fence, unseen_m_s=0.35), wall_m=9.0)
    bench.run(8.0)
    assert 0.7 < bench.pose.x_m < 1.0
    assert bench.guard.status().state is GuardState.READY
    for x_m in (0.95, 1.02):  # somebody pushes it
        bench.pose = Pose(x_m, 0.0)
        bench.run(0.1)
    assert bench.guard.status().reason is StopReason.GEOFENCE


def test_noise_of_a_centimetre_is_no_fault() -> None:
    """Pose noise of 1 cm and 0.5 degrees, a lag of 0.1 s: ten metres and many turns without a stop."""
    rng = np.random.default_rng(3)
    bench = Bench(wall_m=30.0)
    real = bench.guard.hear_pose

    def noisy(stamp_ns: int, pose: Pose) -> None:
        x, y, yaw = rng.standard_normal(3)
        real(stamp_ns, Pose(pose.x_m + 0.01 * x, pose.y_m + 0.01 * y, 0.0, pose.yaw_rad + math.radians(0.5) * yaw))

    bench.guard.hear_pose = noisy  # type: ignore[method-assign]
    for index in range(12):
        bench.run(2.0, (0.35, 0.0) if index % 2 else (0.0, 0.8))
        bench.run(0.5, (0.0, 0.0))
    assert bench.guard.status().stops == 0
