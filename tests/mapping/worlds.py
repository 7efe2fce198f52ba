"""Analytic worlds of boxes: exact depth images and exact answers, no simulator."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numba
import numpy as np

from spacevln.core import Camera, Observation, Pose

Box = tuple[float, float, float, float, float, float]  # x0, y0, z0, x1, y1, z1

CAMERA = Camera(160, 120, 79.0, 0.88)
FULL = Camera(640, 480, 79.0, 0.88)


def room(x0: float, y0: float, x1: float, y1: float, height: float = 2.6) -> list[Box]:
    """Floor slab, ceiling and four walls 0.2 m thick around a free rectangle."""
    t = 0.2
    return [
        (x0 - t, y0 - t, -0.2, x1 + t, y1 + t, 0.0),
        (x0 - t, y0 - t, height, x1 + t, y1 + t, height + 0.2),
        (x0 - t, y0 - t, 0, x0, y1 + t, height),
        (x1, y0 - t, 0, x1 + t, y1 + t, height),
        (x0 - t, y0 - t, 0, x1 + t, y0, height),
        (x0 - t, y1, 0, x1 + t, y1 + t, height),
    ]


def cast(boxes: Sequence[Box], origin: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Ray parameter of the first hit per direction (N, 3), inf where nothing is hit."""
    safe = np.where(np.abs(directions) < 1e-12, 1e-12, directions)
    return _slabs(np.array(boxes, float), np.asarray(origin, float), np.ascontiguousarray(safe))


@numba.njit(cache=True)
def _slabs(boxes: np.ndarray, origin: np.ndarray, directions: np.ndarray) -> np.ndarray:
    best = np.full(len(directions), np.inf)
    for n in range(len(directions)):
        for k in range(len(boxes)):
            enter, leave = -np.inf, np.inf
            for axis in range(3):
                a = (boxes[k, axis] - origin[axis]) / directions[n, axis]
                b = (boxes[k, axis + 3] - origin[axis]) / directions[n, axis]
                enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
            if enter <= leave and leave > 0 and max(enter, 0.0) < best[n]:
                best[n] = max(enter, 0.0)
    return best


def look(boxes: Sequence[Box], pose: Pose, camera: Camera = CAMERA) -> Observation:
    """What the camera sees at a pose."""
    u, v = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
    left, up = -(u - camera.cx_px) / camera.fx_px, -(v - camera.cy_px) / camera.fy_px
    c, s = np.cos(pose.yaw_rad), np.sin(pose.yaw_rad)
    directions = np.stack([c - s * left, s + c * left, up], axis=-1).reshape(-1, 3)
    depth = cast(boxes, pose.position_m + np.array([0, 0, camera.height_m]), directions).reshape(u.shape)
    rgb = np.zeros((*u.shape, 3), np.uint8)
    return Observation(rgb, np.where(np.isfinite(depth), depth, 0).astype(np.float32), pose, camera)


def look_around(boxes: Sequence[Box], pose: Pose, camera: Camera = CAMERA, count: int = 12) -> Iterable[Observation]:
    """A full turn in steps."""
    for k in range(count):
        yield look(boxes, pose.turned(2 * np.pi * k / count), camera)
