"""Questions about one storey: what its points are, lines of sight, ways, frontiers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core import Frontier, Pose, UsageError
from spacevln.mapping import wavefront
from spacevln.mapping.cells import free_of
from spacevln.mapping.floors import Floor
from spacevln.mapping.frontiers import find_frontiers
from spacevln.mapping.geodesics import FreeGrid, GeodesicField
from spacevln.mapping.tiles import TiledLayer

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FIELD_REACH_M = 40.0  # geodesics look at most this far around their start
_FIELDS_KEPT = 32


class FloorView:
    """A :class:`~spacevln.core.interfaces.SpatialMap` of one floor; every answer is of the moment of the question.

    Args:
        floor: the storey.
        resolution_m: of the map.
    """

    def __init__(self, floor: Floor, resolution_m: float) -> None:
        self._floor = floor
        self._resolution_m = resolution_m
        self._version = -1
        self._grids: dict[tuple[int, int, int, int], FreeGrid] = {}
        self._fields: dict[tuple[float, float], GeodesicField] = {}

    @property
    def floor(self) -> int:
        """Id of the floor."""
        return self._floor.id

    # -- points ------------------------------------------------------------------------------------------------------------

    def is_explored(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points was seen, shape (N,)."""
        return np.asarray(self._values(self._floor.seen, xy_m) != 0)

    def is_free(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points is known free floor, shape (N,)."""
        return np.asarray(free_of(self._values(self._floor.seen, xy_m), self._values(self._floor.solid, xy_m)))

    def is_obstacle(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points is a known obstacle (0.15 to 1.30 m over the floor), shape (N,)."""
        return np.asarray(self._values(self._floor.solid, xy_m) != 0)

    def _values(self, layer: TiledLayer, xy_m: ArrayLike) -> NDArray[np.uint8]:
        return layer.at(np.floor(points_xy(xy_m) / self._resolution_m).astype(np.int64))

    def line_of_sight(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> bool:
        """Whether every cell on the straight line between two points is known free floor; never over more than 40 m."""
        ends = np.concatenate([points_xy(a_xy_m), points_xy(b_xy_m)]) / self._resolution_m
        i0, j0 = (math.floor(value) for value in ends.min(axis=0))
        i1, j1 = (math.floor(value) + 1 for value in ends.max(axis=0))
        if max(i1 - i0, j1 - j0) * self._resolution_m > _FIELD_REACH_M:
            return False
        seen, solid = (layer.window(i0, j0, i1 - i0, j1 - j0) for layer in (self._floor.seen, self._floor.solid))
        (a_i, a_j), (b_i, b_j) = ends - (i0, j0)
        return bool(wavefront.clear_line(free_of(seen, solid).astype(np.uint8), a_i, a_j, b_i, b_j))

    # -- ways --------------------------------------------------------------------------------------------------------------

    def geodesic_field(self, xy_m: ArrayLike) -> GeodesicField:
        """Distances from a point to all known free space, inflated by the agent's radius; kept until the map changes.

        A start that is not free is moved to the nearest free cell within 0.3 m. A field looks 40 m around its start.
        """
        x, y = points_xy(xy_m)[0].tolist()
        self._refresh()
        field = self._fields.get((x, y))
        if field is None:
            field = self._grid(x, y).field((x, y))
            while len(self._fields) >= _FIELDS_KEPT:
                del self._fields[next(iter(self._fields))]
            self._fields[x, y] = field
        return field

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        """Shortest way on known free space inflated by the agent's radius [m]; inf when unknown or cut off."""
        return float(self.geodesic_field(a_xy_m).at(b_xy_m)[0])

    def path(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> Float:
        """That way, pulled straight, (N, 2) points with both ends; (0, 2) when there is none."""
        return self.geodesic_field(a_xy_m).path_to(b_xy_m)

    def frontiers(self, pose: Pose) -> tuple[Frontier, ...]:
        """Reachable borders of the known free space at least 0.3 m wide, nearest on the way first."""
        field = self.geodesic_field(pose.xy_m)
        grid = field.grid
        return find_frontiers(field, self._floor.reachable.border.window(grid.i0, grid.j0, *grid.passable.shape), pose)

    def _refresh(self) -> None:
        floor = self._floor
        if self._version != floor.version:
            floor.reachable.refresh(floor.seen, floor.solid, floor.ground)
            self._grids.clear()
            self._fields.clear()
            self._version = floor.version

    def _grid(self, x: float, y: float) -> FreeGrid:
        """Where the body may be, at most 40 m around a point; the rim is closed."""
        i0, j0, i1, j1 = bounds = self._bounds(x, y)
        grid = self._grids.get(bounds)
        if grid is None:
            passable = self._floor.reachable.passable.window(i0, j0, i1 - i0, j1 - j0)
            passable[[0, -1]] = 0
            passable[:, [0, -1]] = 0
            grid = self._grids[bounds] = FreeGrid(i0, j0, self._resolution_m, passable)
        return grid

    def _bounds(self, x: float, y: float) -> tuple[int, int, int, int]:
        i, j = math.floor(x / self._resolution_m), math.floor(y / self._resolution_m)
        reach = round(_FIELD_REACH_M / self._resolution_m)
        i0, j0, i1, j1 = self._floor.bounds or (i, j, i, j)
        if i1 - i0 > reach or j1 - j0 > reach:
            i0, j0, i1, j1 = max(i0, i - reach), max(j0, j - reach), min(i1, i + reach), min(j1, j + reach)
        i0, j0 = i0 - 2, j0 - 2
        return i0, j0, max(i1 + 2, i0 + 4), max(j1 + 2, j0 + 4)


def points_xy(xy_m: ArrayLike) -> Float:
    """Points as (N, 2) float64.

    Raises:
        UsageError: the shape is another, or a value is not finite.
    """
    points = np.asarray(xy_m, np.float64)
    if points.ndim == 1 and points.shape == (2,):
        points = points[None]
    if points.ndim != 2 or points.shape[1] != 2:
        raise UsageError(f"Points of shape {points.shape} are not (N, 2): give x and y in metres per row.")
    if not np.isfinite(points).all():
        raise UsageError("A point is not finite: give x and y in metres.")
    return points
