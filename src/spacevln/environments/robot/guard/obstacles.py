"""Free way ahead of the body, from depth images and a short memory of what they showed.

A level camera does not see low things nearer than a metre; what was seen of them before is kept for a while, in the fixed
frame.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float, Pose, transform_points
from spacevln.environments.robot.messages import CameraInfo
from spacevln.environments.robot.profile import Limits

CELL_M = 0.05
RANGE_M = 3.0
KEPT_S = 20.0
_ROWS = 60  # image rows that are looked at: about as dense as the cells at two metres
_POINTS = 3  # in a cell, to count
_FAR_M = RANGE_M


class ObstacleMemory:
    """Obstacles around the body.

    Args:
        limits: size of the body and what counts as floor.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._cells: NDArray[np.int64] = np.zeros((0, 2), np.int64)
        self._seen_s: NDArray[np.float64] = np.zeros(0)
        self.valid_share = 0.0

    def see(self, depth_m: NDArray[np.float32], info: CameraInfo, T_base_camera: Float, pose: Pose, now_s: float) -> None:
        """Take a depth image.

        Args:
            depth_m: (H, W), 0 for no measurement, not rectified: wide angles do not matter for stopping.
            info: its intrinsics.
            T_base_camera: (4, 4), our camera frame in the body.
            pose: of the body when it was taken, fixed frame.
            now_s: steady time.
        """
        step = max(1, info.height // _ROWS)
        rows, columns = np.mgrid[step // 2 : info.height : step, step // 2 : info.width : step]
        depth = depth_m[rows, columns].astype(np.float64)
        measured = depth > 0
        self.valid_share = float(measured.mean())
        near = measured & (depth < RANGE_M)
        ahead = depth[near]
        left = -(columns[near] - info.k[2]) / info.k[0] * ahead
        up = -(rows[near] - info.k[5]) / info.k[4] * ahead
        points = transform_points(T_base_camera, np.stack([ahead, left, up], axis=-1))
        inside = (points[:, 2] > self._limits.floor_m) & (points[:, 2] < self._limits.body_height_m)
        self._remember(transform_points(pose.T_world_body, points[inside])[:, :2], pose, now_s)

    def free_m(self, pose: Pose) -> float:
        """How far the body's disc can move ahead before it touches something known, less ``stop_m``; at most 3 m, at least 0."""
        if not len(self._cells):
            return _FAR_M
        centres = (self._cells + 0.5) * CELL_M - pose.xy_m
        c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        x, y = c * centres[:, 0] + s * centres[:, 1], -s * centres[:, 0] + c * centres[:, 1]
        radius = self._limits.body_radius_m + CELL_M / 2
        hit = (np.abs(y) < radius) & (x > 0)
        if not hit.any():
            return _FAR_M
        contact = x[hit] - np.sqrt(radius**2 - y[hit] ** 2)
        return max(0.0, min(_FAR_M, float(contact.min()) - self._limits.stop_m))

    def _remember(self, xy_m: Float, pose: Pose, now_s: float) -> None:
        cells, counts = np.unique(np.floor(xy_m / CELL_M).astype(np.int64), axis=0, return_counts=True)
        cells = cells[counts >= _POINTS]
        every = np.vstack([cells, self._cells])  # the newest first: unique keeps the first of each
        seen = np.concatenate([np.full(len(cells), now_s), self._seen_s])
        every, first = np.unique(every, axis=0, return_index=True)
        seen = seen[first]
        distance = np.hypot(*((every + 0.5) * CELL_M - pose.xy_m).T)
        kept = (now_s - seen < KEPT_S) & (distance < RANGE_M)
        self._cells, self._seen_s = every[kept], seen[kept]
