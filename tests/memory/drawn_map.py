"""A metric map drawn by hand, for tests of memory: known floor plan, no sensor."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from spacevln.core import Frontier, Pose
from spacevln.mapping.geodesics import FreeGrid, GeodesicField

RESOLUTION_M = 0.05


@dataclass
class DrawnCrop:
    explored: NDArray[np.bool_]
    obstacle: NDArray[np.bool_]
    free: NDArray[np.bool_]


class DrawnMap:
    """Rooms are free rectangles (x0, y0, x1, y1); walls the obstacle cells around them; ``boxes`` stand inside as obstacles."""

    def __init__(self, rooms: list[tuple[float, ...]], boxes: list[tuple[float, ...]] = (), floor: int = 0) -> None:
        self.floor = floor
        self.travelled = np.zeros((0, 3))
        bounds = np.array(rooms)
        self.i0 = math.floor((bounds[:, 0].min() - 1) / RESOLUTION_M)
        self.j0 = math.floor((bounds[:, 1].min() - 1) / RESOLUTION_M)
        shape = (
            math.ceil((bounds[:, 2].max() + 1) / RESOLUTION_M) - self.i0,
            math.ceil((bounds[:, 3].max() + 1) / RESOLUTION_M) - self.j0,
        )
        self.free = np.zeros(shape, np.bool_)
        for room in rooms:
            self._fill(room, True)
        wall = ndimage.binary_dilation(self.free, iterations=2) & ~self.free
        for box in boxes:
            self._fill(box, False)
        self.obstacle = wall | (ndimage.binary_fill_holes(self.free | wall) & ~self.free & ~wall)
        self.explored = self.free | self.obstacle
        self.passable = (ndimage.distance_transform_edt(self.free) * RESOLUTION_M > 0.1).astype(np.uint8)

    def walk(self, *poses: Pose) -> None:
        """Go from pose to pose on the shortest way."""
        for before, after in itertools.pairwise(poses):
            way = self.path(before.xy_m, after.xy_m)
            self.travelled = np.vstack([self.travelled, np.column_stack([way, np.full(len(way), self.floor)])])

    def _fill(self, rect: tuple[float, ...], value: bool) -> None:
        x0, y0, x1, y1 = (round(edge / RESOLUTION_M) for edge in rect)
        self.free[x0 - self.i0 : x1 - self.i0, y0 - self.j0 : y1 - self.j0] = value

    def _look_up(self, layer: NDArray[np.bool_], xy_m: ArrayLike) -> NDArray[np.bool_]:
        ij = np.floor(np.asarray(xy_m, float).reshape(-1, 2) / RESOLUTION_M).astype(int) - (self.i0, self.j0)
        inside = ((ij >= 0) & (ij < layer.shape)).all(axis=1)
        i, j = np.clip(ij, 0, np.array(layer.shape) - 1).T
        return layer[i, j] & inside

    def is_explored(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return self._look_up(self.explored, xy_m)

    def is_free(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return self._look_up(self.free, xy_m)

    def is_obstacle(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return self._look_up(self.obstacle, xy_m)

    def is_passable(self, x: float, y: float) -> bool:
        return bool(self._look_up(self.passable > 0, [x, y])[0])

    def line_of_sight(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> bool:
        a, b = np.asarray(a_xy_m, float), np.asarray(b_xy_m, float)
        return bool(self.is_free(a + np.linspace(0, 1, 200)[:, None] * (b - a)).all())

    def geodesic_field(self, xy_m: ArrayLike) -> GeodesicField:
        return FreeGrid(self.i0, self.j0, RESOLUTION_M, self.passable).field(xy_m)

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        return float(self.geodesic_field(a_xy_m).at([b_xy_m])[0])

    def path(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> NDArray[np.float64]:
        return self.geodesic_field(a_xy_m).path_to(b_xy_m)

    def frontiers(self, pose: Pose) -> tuple[Frontier, ...]:  # noqa: ARG002
        return ()

    def crop(self, center_xy: ArrayLike, size_m: float, heading_rad: float) -> DrawnCrop:
        count = round(size_m / RESOLUTION_M)
        ahead = ((count - 1) / 2 - np.arange(count))[:, None] * RESOLUTION_M
        left = ((count - 1) / 2 - np.arange(count))[None, :] * RESOLUTION_M
        c, s = math.cos(heading_rad), math.sin(heading_rad)
        x0, y0 = np.asarray(center_xy, float)
        xy = np.stack([x0 + c * ahead - s * left, y0 + s * ahead + c * left], axis=-1).reshape(-1, 2)
        return DrawnCrop(*(self._look_up(layer, xy).reshape(count, count) for layer in (self.explored, self.obstacle, self.free)))
