"""What Spatial Cognitive Memory asks of a metric map; ``mapping.MetricMap`` answers it, and a test's drawn map can."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core import Frontier, Pose, SpatialMap


class Field(Protocol):
    """Geodesic distances from one point (``mapping``'s geodesic field)."""

    def at(self, xy_m: ArrayLike) -> NDArray[np.float64]:
        """Way to each of the (N, 2) points [m]; inf when unknown or cut off."""

    def path_to(self, xy_m: ArrayLike) -> NDArray[np.float64]:
        """The way from the source to a point as (N, 2) points; (0, 2) when there is none."""


class Crop(Protocol):
    """A square, heading-up picture of the map: row 0 lies ahead, column 0 to the left."""

    @property
    def explored(self) -> NDArray[np.bool_]:
        """Seen cells (N, N)."""

    @property
    def obstacle(self) -> NDArray[np.bool_]:
        """Obstacle cells (N, N)."""

    @property
    def free(self) -> NDArray[np.bool_]:
        """Known free cells (N, N)."""


class MemoryMap(SpatialMap, Protocol):
    """The current floor of a metric map."""

    @property
    def floor(self) -> int:
        """0 for the floor of the start."""

    def geodesic_field(self, xy_m: ArrayLike) -> Field:
        """Distances from a point on known free space inflated by the agent's radius."""

    @property
    def travelled(self) -> NDArray[np.float64]:
        """The way walked in this episode, (N, 3): x, y [m], floor."""

    def crop(self, center_xy: ArrayLike, size_m: float, heading_rad: float) -> Crop:
        """A heading-up square around a point."""

    def frontiers(self, pose: Pose) -> Sequence[Frontier]:
        """Borders of the known free space, nearest first."""
