"""Which region owns each cell of a floor: that of the nearest waypoint that sees it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from spacevln.core.geometry import Float
from spacevln.memory.regions import CELL_M, cell_ij

if TYPE_CHECKING:
    from spacevln.memory.hierarchical import HierarchicalSpatialMemory

_SAMPLE_M = 0.2


class RegionRaster(NamedTuple):
    """Owners of the 0.1 m cells of one floor.

    Args:
        owner: 1 + index of the region by [i - i0, j - j0]; 0 = none.
        i0, j0: first cell, i along x.
    """

    owner: NDArray[np.uint8]
    i0: int
    j0: int

    def at(self, xy_m: Float) -> NDArray[np.uint8]:
        """1 + index of the region at each of the (N, 2) points; 0 = none."""
        ij = np.floor(np.asarray(xy_m) / CELL_M).astype(np.int64) - (self.i0, self.j0)
        inside = ((ij >= 0) & (ij < self.owner.shape)).all(axis=1)
        i, j = np.clip(ij, 0, np.array(self.owner.shape) - 1).T
        return np.where(inside, self.owner[i, j], 0).astype(np.uint8)

    def crossed(self, path: Float) -> set[int]:
        """Indices of the regions that a polyline (N, 2) leads through."""
        at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
        steps = np.linspace(0.0, at[-1], max(2, int(at[-1] / _SAMPLE_M) + 1))
        points = np.stack([np.interp(steps, at, path[:, 0]), np.interp(steps, at, path[:, 1])], axis=1)
        return {owner - 1 for owner in np.unique(self.at(points)).tolist() if owner}


def region_raster(memory: HierarchicalSpatialMemory, floor: int) -> RegionRaster | None:
    """Owners of every cell of a floor; None while the floor has no waypoint."""
    members = [waypoint for waypoint in memory.waypoints if waypoint.floor == floor]
    if not members:
        return None
    parts = [memory.regions.support_of(waypoint.index) for waypoint in members]
    ij = cell_ij(np.concatenate(parts))
    (i0, j0), (height, width) = ij.min(axis=1), ij.max(axis=1) - ij.min(axis=1) + 1
    order = {region.label: index + 1 for index, region in enumerate(memory.regions.all)}
    labels = np.array([min(order[memory.regions.of(waypoint.index).label], 255) for waypoint in members], np.uint8)
    seats = np.array([[waypoint.pose.x_m, waypoint.pose.y_m] for waypoint in members]) / CELL_M - (i0 + 0.5, j0 + 0.5)
    ends = np.cumsum([len(part) for part in parts])
    owner = _own(ij[0] - i0, ij[1] - j0, ends, seats, labels, int(height), int(width))
    return RegionRaster(owner, int(i0), int(j0))


@njit(cache=True)
def _own(
    i_of: NDArray[np.int64],
    j_of: NDArray[np.int64],
    ends: NDArray[np.int64],
    seats: Float,
    labels: NDArray[np.uint8],
    height: int,
    width: int,
) -> NDArray[np.uint8]:  # pragma: no cover - compiled
    """Give each cell to the nearest of the waypoints that see it; those of waypoint w end before ``ends[w]``."""
    owner = np.zeros((height, width), np.uint8)
    nearest = np.full((height, width), np.inf, np.float32)
    first = 0
    for w in range(len(ends)):
        for k in range(first, ends[w]):
            i, j = i_of[k], j_of[k]
            gap = np.float32((i - seats[w, 0]) ** 2 + (j - seats[w, 1]) ** 2)
            if gap < nearest[i, j]:
                nearest[i, j] = gap
                owner[i, j] = labels[w]
        first = ends[w]
    return owner
