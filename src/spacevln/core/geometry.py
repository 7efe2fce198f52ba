"""Poses, frames and angles.

Metres, right-handed, z up, yaw counter-clockwise in radians (ROS REP-103). ``T_a_b`` maps coordinates of frame *b* to
frame *a*. A body or camera frame has x forward, y left, z up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]


def wrap_angle(angle_rad: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle_rad, math.tau)
    return math.pi if wrapped == -math.pi else wrapped


@dataclass(frozen=True, slots=True)
class Pose:
    """Where an agent stands: position of its feet [m] and heading [rad]."""

    x_m: float
    y_m: float
    z_m: float = 0.0
    yaw_rad: float = 0.0

    @property
    def xy_m(self) -> Float:
        """Position on the floor, shape (2,) [m]."""
        return np.array([self.x_m, self.y_m])

    @property
    def position_m(self) -> Float:
        """Position of the feet, shape (3,) [m]."""
        return np.array([self.x_m, self.y_m, self.z_m])

    @property
    def T_world_body(self) -> Float:
        """Homogeneous transform (4, 4) from the body frame (x forward, y left, z up, origin at the feet) to this pose's frame."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return np.array([[c, -s, 0.0, self.x_m], [s, c, 0.0, self.y_m], [0.0, 0.0, 1.0, self.z_m], [0.0, 0.0, 0.0, 1.0]])

    def compose(self, local: Pose) -> Pose:
        """The pose that ``local``, given relative to this pose, has in this pose's frame."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose(
            x_m=self.x_m + c * local.x_m - s * local.y_m,
            y_m=self.y_m + s * local.x_m + c * local.y_m,
            z_m=self.z_m + local.z_m,
            yaw_rad=wrap_angle(self.yaw_rad + local.yaw_rad),
        )

    def relative_to(self, origin: Pose) -> Pose:
        """Return this pose seen from ``origin`` (inverse of :meth:`compose`)."""
        c, s = math.cos(origin.yaw_rad), math.sin(origin.yaw_rad)
        dx, dy = self.x_m - origin.x_m, self.y_m - origin.y_m
        return Pose(
            x_m=c * dx + s * dy,
            y_m=-s * dx + c * dy,
            z_m=self.z_m - origin.z_m,
            yaw_rad=wrap_angle(self.yaw_rad - origin.yaw_rad),
        )

    def turned(self, angle_rad: float) -> Pose:
        """The same place with the heading turned left by ``angle_rad``."""
        return Pose(self.x_m, self.y_m, self.z_m, wrap_angle(self.yaw_rad + angle_rad))

    def distance_m(self, x_m: float, y_m: float) -> float:
        """Horizontal distance to a point [m]."""
        return math.hypot(x_m - self.x_m, y_m - self.y_m)

    def bearing_rad(self, x_m: float, y_m: float) -> float:
        """Direction of a point relative to the heading, left positive, in (-pi, pi] [rad]."""
        return wrap_angle(math.atan2(y_m - self.y_m, x_m - self.x_m) - self.yaw_rad)


def transform_points(T_a_b: Float, points_b: Float) -> Float:
    """Points (N, 3) of frame b in frame a, shape (N, 3)."""
    return points_b @ T_a_b[:3, :3].T + T_a_b[:3, 3]


def egocentric_label(bearing_rad: float, step_deg: int = 30) -> str:
    """The words a model reads for a direction: ``"front"``, ``"left 30"`` ... ``"back"`` ... ``"right 30"`` (DESIGN 4)."""
    steps = 360 // step_deg
    index = round(math.degrees(wrap_angle(bearing_rad)) / step_deg) % steps
    if index == 0:
        return "front"
    if index * 2 == steps:
        return "back"
    if index * 2 < steps:
        return f"left {index * step_deg}"
    return f"right {(steps - index) * step_deg}"
