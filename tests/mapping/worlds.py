"""Analytic worlds of boxes: exact depth images and exact answers, no simulator."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

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
    best = np.full(len(directions), np.inf)
    safe = np.where(np.abs(directions) < 1e-12, 1e-12, directions)
    for box in boxes:
        low, high = np.array(box[:3]), np.array(box[3:])
        a, b = (low - origin) / safe, (high - origin) / safe
        enter, leave = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
        hit = (enter <= leave) & (leave > 0)
        best = np.where(hit & (np.maximum(enter, 0) < best), np.maximum(enter, 0), best)
    return best


def look(boxes: Sequence[Box], pose: Pose, camera: Camera = CAMERA) -> Observation:
    """What the camera sees at a pose."""
    u, v = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
    left, up = -(u - camera.cx_px) / camera.fx_px, -(v - camera.cy_px) / camera.fy_px
    c, s = np.cos(pose.yaw_rad), np.sin(pose.yaw_rad)
    directions = np.stack([c - s * left, s + c * left, up], axis=-1).reshape(-1, 3)
    depth = cast(boxes, pose.position_m + (0, 0, camera.height_m), directions).reshape(u.shape)
    rgb = np.zeros((*u.shape, 3), np.uint8)
    return Observation(rgb, np.where(np.isfinite(depth), depth, 0).astype(np.float32), pose, camera)


def look_around(boxes: Sequence[Box], pose: Pose, camera: Camera = CAMERA, count: int = 12) -> Iterable[Observation]:
    """A full turn in steps."""
    for k in range(count):
        yield look(boxes, pose.turned(2 * np.pi * k / count), camera)
