"""What goes wrong with a real camera: noise of depth and pose, holes, lost frames. Nothing of it is the map's own doing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from spacevln.core import Observation, Pose

# Disparity of the Redwood model: 35.130 / depth in pixels, measured in eighths, with a deviation of 1/36 pixel.
_REDWOOD_DISPARITY = 35.130
_REDWOOD_STEPS = 8.0
_REDWOOD_DEVIATION = 1 / 36
_REDWOOD_SHUFFLE_PX = 0.25


@dataclass(frozen=True)
class Trouble:
    """How much of each.

    Args:
        pose: 1 = a deviation of 2 cm in x and y and of 1 degree in yaw, of every frame by itself.
        depth: 1 = the Redwood model of a PrimeSense camera (Choi, Zhou, Koltun 2015) without its lens distortion table.
        holes: share of the depth missing, in blotches of 8 x 8 pixels.
        dropped: share of the frames lost.
    """

    pose: float = 0.0
    depth: float = 0.0
    holes: float = 0.0
    dropped: float = 0.0


def troubled(frames: Iterable[Observation], trouble: Trouble, rng: np.random.Generator) -> Iterator[Observation]:
    """The frames as such a camera would give them."""
    for frame in frames:
        if rng.random() < trouble.dropped:
            continue
        depth_m = frame.depth_m
        if trouble.depth:
            depth_m = redwood(depth_m, trouble.depth, rng)
        if trouble.holes:
            blotches = rng.random((math.ceil(depth_m.shape[0] / 8), math.ceil(depth_m.shape[1] / 8))) < trouble.holes
            gone = np.kron(blotches, np.ones((8, 8), bool))[: depth_m.shape[0], : depth_m.shape[1]]
            depth_m = np.where(gone, np.float32(0), depth_m)
        dx, dy, turn = rng.normal(0, trouble.pose, 3) * (0.02, 0.02, math.radians(1.0))
        pose = Pose(frame.pose.x_m + dx, frame.pose.y_m + dy, frame.pose.z_m, frame.pose.yaw_rad + turn)
        yield replace(frame, depth_m=depth_m, pose=pose, T_world_camera=None)


def redwood(depth_m: np.ndarray, amount: float, rng: np.random.Generator) -> np.ndarray:
    """Pixels shuffled by a quarter pixel at half resolution, disparity with noise and in steps of an eighth."""
    rows, columns = depth_m.shape
    v, u = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    shuffled = [
        np.clip(np.rint(axis + rng.normal(0, _REDWOOD_SHUFFLE_PX * amount, depth_m.shape)), 0, last - 1).astype(int)
        for axis, last in ((v, rows), (u, columns))
    ]
    picked = depth_m[shuffled[0] // 2 * 2, shuffled[1] // 2 * 2]
    with np.errstate(divide="ignore"):
        disparity = _REDWOOD_DISPARITY / picked + rng.normal(0, _REDWOOD_DEVIATION * amount, depth_m.shape)
        steps = np.rint(disparity * _REDWOOD_STEPS)
        noisy = _REDWOOD_DISPARITY * _REDWOOD_STEPS / steps
    return np.where((picked > 0) & (picked < 10) & (steps > 0), noisy, 0).astype(np.float32)
