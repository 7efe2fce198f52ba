"""The flight of stairs that a stage takes: what lies on its incline is walked on, not walked into.

Whoever stands at the foot of a flight sees none of its first treads, and where one came from the side nobody ever did. The map,
which knows treads by the steps that lead to them, takes the next ones for obstacles; where the flight begins and ends tells more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_HALF_WIDTH_M = 0.35  # narrower than any flight: railings stay obstacles


@dataclass(frozen=True, slots=True)
class Incline:
    """A straight line up or down a flight.

    Args:
        start_m, end_m: (x, y, z) where it begins and ends.
    """

    start_m: tuple[float, float, float]
    end_m: tuple[float, float, float]

    def heights_m(self, x_m: NDArray[np.float64], y_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Height of the line over points, same shape [m]; NaN beside it."""
        (x0, y0, z0), (x1, y1, z1) = self.start_m, self.end_m
        length2 = (x1 - x0) ** 2 + (y1 - y0) ** 2
        if length2 == 0.0:
            return np.full(np.broadcast(x_m, y_m).shape, np.nan)
        share = ((x_m - x0) * (x1 - x0) + (y_m - y0) * (y1 - y0)) / length2
        across = ((y_m - y0) * (x1 - x0) - (x_m - x0) * (y1 - y0)) / np.sqrt(length2)
        on_it = (share >= 0.0) & (share <= 1.0) & (np.abs(across) <= _HALF_WIDTH_M)
        return np.asarray(np.where(on_it, z0 + share * (z1 - z0), np.nan))
