"""Which region owns each cell of a floor: that of the nearest waypoint that sees it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from spacevln.core.geometry import Float
from spacevln.memory.regions import CELL_M, Cells, cell_of

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
    order = {region.label: index + 1 for index, region in enumerate(memory.regions.all)}
    labels = np.array([min(order[memory.regions.of(waypoint.index).label], 255) for waypoint in members], np.uint8)
    seats = np.array([[waypoint.pose.x_m, waypoint.pose.y_m] for waypoint in members]) / CELL_M - 0.5
    owner, i0, j0 = _own(np.concatenate(parts), np.cumsum([len(part) for part in parts]), seats, labels)
    return RegionRaster(owner, int(i0), int(j0))


@njit(cache=True)
def _own(
    cells: Cells, ends: NDArray[np.int64], seats: Float, labels: NDArray[np.uint8]
) -> tuple[NDArray[np.uint8], np.int64, np.int64]:  # pragma: no cover - compiled
    """Give each cell to the nearest of the waypoints that see it; the keys of waypoint w end before ``ends[w]``."""
    i0 = j0 = np.int64(1) << 40
    i1 = j1 = -i0
    for key in cells:
        i, j = cell_of(key)
        i0, j0, i1, j1 = min(i0, i), min(j0, j), max(i1, i), max(j1, j)
    owner = np.zeros((i1 - i0 + 1, j1 - j0 + 1), np.uint8)
    nearest = np.full(owner.shape, np.inf, np.float32)
    first = 0
    for w in range(len(ends)):
        for k in range(first, ends[w]):
            i, j = cell_of(cells[k])
            gap = np.float32((i - seats[w, 0]) ** 2 + (j - seats[w, 1]) ** 2)
            if gap < nearest[i - i0, j - j0]:
                nearest[i - i0, j - j0] = gap
                owner[i - i0, j - j0] = labels[w]
        first = ends[w]
    return owner, i0, j0
