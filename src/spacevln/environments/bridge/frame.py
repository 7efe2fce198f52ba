"""Habitat's coordinates (x right, y up, -z forward) in the scene frame (x forward, y left, z up) and back (DESIGN 4)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core.geometry import Pose, wrap_angle

Points = NDArray[np.float64]


def points_from_habitat(points: ArrayLike) -> Points:
    """Habitat's (x, y, z) become (-z, -x, y); shape (N, 3)."""
    x, y, z = np.asarray(points, dtype=np.float64).reshape(-1, 3).T
    return np.column_stack([-z, -x, y])


def points_to_habitat(points: ArrayLike) -> Points:
    """Inverse of :func:`points_from_habitat`; shape (N, 3)."""
    x, y, z = np.asarray(points, dtype=np.float64).reshape(-1, 3).T
    return np.column_stack([-y, z, -x])


def yaw_from_habitat(quaternion: tuple[float, float, float, float]) -> float:
    """Heading of a rotation [x, y, z, w] about Habitat's vertical [rad]; turning left is positive in both frames."""
    return wrap_angle(2.0 * math.atan2(quaternion[1], quaternion[3]))


def pose_from_habitat(position: ArrayLike, quaternion: tuple[float, float, float, float]) -> Pose:
    """A start pose in the scene frame."""
    x, y, z = points_from_habitat(position)[0]
    return Pose(float(x), float(y), float(z), yaw_from_habitat(quaternion))


def pose_to_habitat(pose: Pose) -> tuple[list[float], list[float]]:
    """Position and rotation [x, y, z, w] of a pose, as dataset files hold them."""
    position = [float(value) + 0.0 for value in points_to_habitat(pose.position_m)[0]]
    return position, [0.0, math.sin(pose.yaw_rad / 2) + 0.0, 0.0, math.cos(pose.yaw_rad / 2)]


def camera_from_habitat(position: ArrayLike, quaternion: tuple[float, float, float, float]) -> Points:
    """Pose (4, 4) of a camera in the scene frame: Habitat's cameras look along -z with x right, ours along x with y left."""
    x, y, z, w = quaternion
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    axes = points_from_habitat((rotation @ np.array([[0.0, -1, 0], [0, 0, 1], [-1, 0, 0]])).T)
    T_scene_camera = np.eye(4)
    T_scene_camera[:3, :3] = axes.T
    T_scene_camera[:3, 3] = points_from_habitat(position)[0]
    return T_scene_camera
