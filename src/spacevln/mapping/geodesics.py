"""Geodesic distance on known free space from one point: one field answers for every target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.mapping import wavefront

Float = NDArray[np.float64]

# The embedded houses search ways with kernels of their own (environments.houses.walking.anyangle), on purpose: the agent's
# packages import no environment, and a truth that shared its code with the map could not judge the map.

SNAP_M = 0.3  # an end that is not free is moved to free space at most this far


@dataclass(frozen=True, slots=True, eq=False)
class FreeGrid:
    """Where the centre of the body may be, on a window of the floor.

    Args:
        i0, j0: first cell of the window.
        resolution_m: cell size.
        passable: (rows, columns) uint8, 1 = known free space inflated by the agent's radius; the rim is 0.
    """

    i0: int
    j0: int
    resolution_m: float
    passable: NDArray[np.uint8]

    def to_cells(self, xy_m: ArrayLike) -> Float:
        """Points (N, 2) [m] in cells of the window."""
        return np.asarray(xy_m, np.float64).reshape(-1, 2) / self.resolution_m - (self.i0, self.j0)

    def to_xy(self, cells: Float) -> Float:
        """Points in cells of the window (N, 2) in metres."""
        return np.asarray((cells + np.array([self.i0, self.j0])) * self.resolution_m)

    def field(self, xy_m: ArrayLike) -> GeodesicField:
        """Distances from a point; a point that is not passable is moved to the nearest passable cell within 0.3 m."""
        start = self.to_cells(xy_m)[0]
        i, j = wavefront.nearest_open(self.passable, start[0], start[1], SNAP_M / self.resolution_m)
        gap = 0.0
        if i < 0:
            return GeodesicField(self, start, np.zeros((0, 0), np.float32))
        if (int(np.floor(start[0])), int(np.floor(start[1]))) != (i, j):
            gap = float(np.hypot(start[0] - i - 0.5, start[1] - j - 0.5))
            start = np.array([i + 0.5, j + 0.5])
        return GeodesicField(self, start, wavefront.march(self.passable, start[0], start[1]) + np.float32(gap))


@dataclass(frozen=True, slots=True, eq=False)
class GeodesicField:
    """Distances from one start on known free space, as it was known when the field was made.

    Args:
        grid: the free space.
        start_cells: (2,) the start, in cells of the grid.
        cells: (rows, columns) float32 distances in cells, inf where no known way leads; (0, 0) when the start is cut off.
    """

    grid: FreeGrid
    start_cells: Float
    cells: NDArray[np.float32]

    @property
    def reaches_anything(self) -> bool:
        """Whether free space was found at the start."""
        return self.cells.size > 0

    def at(self, xy_m: ArrayLike, snap_m: float = SNAP_M) -> Float:
        """Distance to each of the (N, 2) points [m], shape (N,).

        A point that is not passable counts as the nearest passable cell within ``snap_m`` plus the gap to it; inf when there
        is none or no known way leads there. Never below the straight distance.
        """
        points = self.grid.to_cells(xy_m)
        if not self.reaches_anything:
            return np.full(len(points), np.inf)
        resolution_m = self.grid.resolution_m
        return np.asarray(
            wavefront.sample(
                self.cells, self.grid.passable, points, self.start_cells[0], self.start_cells[1], snap_m / resolution_m
            )
            * resolution_m
        )

    def path_to(self, xy_m: ArrayLike, snap_m: float = SNAP_M) -> Float:
        """The way to a point as (N, 2) points [m], pulled straight; (0, 2) when there is none.

        Both ends are included; an end that is not passable is replaced by the nearest passable cell.
        """
        if self.reaches_anything:
            point = self.grid.to_cells(xy_m)[0]
            i, j = wavefront.nearest_open(self.grid.passable, point[0], point[1], snap_m / self.grid.resolution_m)
            if i >= 0 and self.cells[i, j] < np.inf:
                way = wavefront.descend(self.cells, self.grid.passable, self.start_cells[0], self.start_cells[1], i, j)
                if (int(np.floor(point[0])), int(np.floor(point[1]))) == (i, j) and (
                    len(way) < 2 or wavefront.clear_line(self.grid.passable, way[-2, 0], way[-2, 1], point[0], point[1])
                ):
                    way[-1] = point
                return self.grid.to_xy(way)
        return np.zeros((0, 2))
