"""Borders between known free space and the unknown: where exploring goes on (Yamauchi 1997)."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from spacevln.core import Frontier, Pose
from spacevln.mapping.geodesics import GeodesicField

MIN_WIDTH_M = 0.3
MAX_REACH_M = 1.5  # from the first cell of a frontier; a longer border is several


def find_frontiers(field: GeodesicField, border: NDArray[np.uint8], pose: Pose) -> tuple[Frontier, ...]:
    """Frontiers that the field reaches, nearest first; those narrower than 0.3 m are gaps of the sensor.

    A longer border than 1.5 m is parted: it is not one place.

    Args:
        field: distances from the agent.
        border: 1 at the cells of the field's window beside which the unknown begins.
        pose: live pose, for the bearings.
    """
    if not field.reaches_anything:
        return ()
    resolution_m = field.grid.resolution_m
    groups = _group(field.cells, border, MIN_WIDTH_M / resolution_m, MAX_REACH_M / resolution_m)
    points = field.grid.to_xy(groups[:, :2] + 0.5)
    found = [
        Frontier(
            (float(x), float(y)),
            float(group[2] * resolution_m),
            pose.bearing_rad(float(x), float(y)),
            float(group[3] * resolution_m),
        )
        for (x, y), group in zip(points, groups, strict=True)
    ]
    return tuple(sorted(found, key=lambda frontier: (frontier.geodesic_m, frontier.position_m)))


@numba.njit(cache=True)
def _group(
    time: NDArray[np.float32], border: NDArray[np.uint8], min_cells: float, max_cells: float
) -> Any:  # pragma: no cover - compiled
    """Per group of connected frontier cells: i, j and distance of the one reached first, width of the group; eats ``border``."""
    n_i, n_j = time.shape
    for i in range(n_i):
        for j in range(n_j):
            if border[i, j] != 0 and not time[i, j] < np.inf:
                border[i, j] = 0
    queue = np.empty((n_i * n_j, 2), np.int32)
    rows = np.empty((n_i * n_j // 4 + 1, 4))
    count = 0
    for i in range(1, n_i - 1):
        for j in range(1, n_j - 1):
            if border[i, j] == 0:
                continue
            border[i, j] = 0
            queue[0, 0], queue[0, 1] = i, j
            start, end = 0, 1
            best_i, best_j = i, j
            low_i, high_i, low_j, high_j = i, i, j, j
            while start < end:
                a, b = queue[start, 0], queue[start, 1]
                start += 1
                low_i, high_i, low_j, high_j = min(low_i, a), max(high_i, a), min(low_j, b), max(high_j, b)
                if time[a, b] < time[best_i, best_j]:
                    best_i, best_j = a, b
                for p in range(a - 1, a + 2):
                    for q in range(b - 1, b + 2):
                        if border[p, q] != 0 and np.hypot(p - i, q - j) <= max_cells:
                            border[p, q] = 0
                            queue[end, 0], queue[end, 1] = p, q
                            end += 1
            width = np.hypot(high_i - low_i + 1, high_j - low_j + 1)
            if width >= min_cells:
                rows[count, 0], rows[count, 1], rows[count, 2], rows[count, 3] = best_i, best_j, time[best_i, best_j], width
                count += 1
    return rows[:count].copy()
