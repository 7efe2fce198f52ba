"""The area that must not be left."""

from __future__ import annotations

import itertools
from collections.abc import Sequence


def inside(corners: Sequence[tuple[float, float]], x_m: float, y_m: float) -> bool:
    """Whether a point lies in a polygon (even-odd rule); no corners are no fence."""
    if not corners:
        return True
    crossings = 0
    for (ax, ay), (bx, by) in itertools.pairwise((*corners, corners[0])):
        if (ay > y_m) != (by > y_m) and x_m < ax + (y_m - ay) / (by - ay) * (bx - ax):
            crossings += 1
    return crossings % 2 == 1
