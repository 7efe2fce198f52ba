"""In which directions around a place unknown floor begins: what the map can say of a look-around before it is made."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Pose, SpatialMap

BEARINGS = 72
FROM_M, TO_M = 0.35, 3.5
STEP_M = 0.05
LEAST_M = 0.25  # of unknown floor along a bearing; less is a gap between the pixels of one image


def unknown_bearings(space: SpatialMap, pose: Pose) -> NDArray[np.float64]:
    """Egocentric bearings, left positive, under which floor is unknown up to ``TO_M`` and before the first obstacle [rad].

    Args:
        space: the map.
        pose: from where one would look.

    Returns:
        (N,) in the order of ``BEARINGS`` counter-clockwise from the front, each in (-pi, pi]; a bearing counts only beside
        another one, as a single one is a crack.
    """
    bearings = np.arange(BEARINGS) * 2 * math.pi / BEARINGS
    reach = np.arange(FROM_M, TO_M, STEP_M)
    yaw = pose.yaw_rad + bearings[:, None]
    points = np.stack([pose.x_m + reach * np.cos(yaw), pose.y_m + reach * np.sin(yaw)], axis=-1).reshape(-1, 2)
    behind = np.logical_or.accumulate(space.is_obstacle(points).reshape(BEARINGS, -1), axis=1)
    unknown_m = STEP_M * (~space.is_explored(points).reshape(BEARINGS, -1) & ~behind).sum(axis=1)
    unknown = unknown_m >= LEAST_M
    unknown &= np.roll(unknown, 1) | np.roll(unknown, -1)
    found = np.asarray(bearings[unknown], np.float64)
    found[found > math.pi] -= 2 * math.pi
    return found
