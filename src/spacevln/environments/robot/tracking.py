"""Closed-loop tracking of one primitive: where the body is goes in, the velocity to wish comes out."""

from __future__ import annotations

import math

from spacevln.core.geometry import Pose, wrap_angle
from spacevln.environments.robot.profile import Limits, Motions

APPROACH_PER_S = 1.4
"""Speed per metre (turn rate per radian) that is left: the approach slows down smoothly."""
SLOWEST_M_S = 0.05
SLOWEST_RAD_S = 0.12
STEER_PER_S = 1.2
CROSS_RAD_PER_M = 1.5
STRAIGHT_M = 0.1
"""So near to the target the line is no longer steered back to: noise alone would swing the wheels to and fro."""
_SMOOTH = 0.35  # weight of a new pose


class Smoothed:
    """A pose without most of its noise; begins anew at each primitive."""

    def __init__(self) -> None:
        self._pose: Pose | None = None

    def update(self, pose: Pose) -> Pose:
        """Take a pose."""
        last = self._pose
        if last is not None:
            turned = wrap_angle(pose.yaw_rad - last.yaw_rad)
            pose = Pose(
                last.x_m + _SMOOTH * (pose.x_m - last.x_m),
                last.y_m + _SMOOTH * (pose.y_m - last.y_m),
                pose.z_m,
                wrap_angle(last.yaw_rad + _SMOOTH * turned),
            )
        self._pose = pose
        return pose


class ForwardTracker:
    """Follows a line of a given length.

    Args:
        start: pose at its beginning, yaw along the line.
        distance_m: its length.
        motions, limits: tolerances and speeds.
    """

    def __init__(self, start: Pose, distance_m: float, motions: Motions, limits: Limits) -> None:
        self._start, self._distance_m = start, distance_m
        self._tolerance_m, self._speed_m_s, self._turn_rad_s = motions.tolerance_m, limits.speed_m_s, limits.turn_rad_s

    def wish(self, pose: Pose) -> tuple[float, float] | None:
        """Velocities; None when the target is reached or passed."""
        seen = pose.relative_to(self._start)
        left_m = self._distance_m - seen.x_m
        if left_m < self._tolerance_m / 2:
            return None
        speed = min(self._speed_m_s, max(SLOWEST_M_S, APPROACH_PER_S * left_m))
        if left_m < STRAIGHT_M:
            return speed, 0.0
        course = -max(-0.5, min(0.5, CROSS_RAD_PER_M * seen.y_m))
        turn = STEER_PER_S * wrap_angle(course - seen.yaw_rad)
        return speed, max(-self._turn_rad_s, min(self._turn_rad_s, turn))


class TurnTracker:
    """Turns on the spot to a heading.

    Args:
        yaw_rad: the heading.
        motions, limits: tolerances and speeds.
    """

    def __init__(self, yaw_rad: float, motions: Motions, limits: Limits) -> None:
        self._yaw_rad = yaw_rad
        self._tolerance_rad, self._turn_rad_s = math.radians(motions.tolerance_deg), limits.turn_rad_s
        self._side = 0.0

    def wish(self, pose: Pose) -> tuple[float, float] | None:
        """Velocities; None when the heading is reached or passed."""
        left_rad = wrap_angle(self._yaw_rad - pose.yaw_rad)
        self._side = self._side or math.copysign(1.0, left_rad)
        if left_rad * self._side < self._tolerance_rad / 2:
            return None
        rate = min(self._turn_rad_s, max(SLOWEST_RAD_S, APPROACH_PER_S * abs(left_rad)))
        return 0.0, self._side * rate


Tracker = ForwardTracker | TurnTracker
