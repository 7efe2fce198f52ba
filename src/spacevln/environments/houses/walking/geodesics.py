"""Shortest distances for the agent's disc over the whole house.

Method: a search over 5 cm cells in which every cell remembers the last bend of its shortest path and hands it on along lines of
sight (Theta*: Daniel, Nash, Koenig and Felner, JAIR 2010), so that distances are sums of straight pieces and not of grid steps.
Free cells are those whose centre keeps the agent's radius from every obstacle. On stairs, distances run along the slope.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import UsageError
from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M, RESOLUTION_M, Walkable
from spacevln.environments.houses.layout.structure import direction, portion
from spacevln.environments.houses.plan import Stairs
from spacevln.environments.houses.walking.anyangle import look_up, spread

Float = NDArray[np.float64]
Ints = NDArray[np.int64]
Point = Sequence[float] | Float

_SNAP_CELLS = 3
_HALF_DIAGONAL_M = RESOLUTION_M * math.sqrt(0.5)


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """The free space of all storeys; node = (floor * nx + i) * ny + j; lengths inside the search are in cells.

    Args:
        free: (F, nx, ny), where the agent's centre may be.
        slack: (F, nx, ny), how far a line may go on from a cell without leaving free space.
        zone: (F, nx, ny), 0 on a floor, 1 on stairs along x, 2 on stairs along y.
        link: (F * nx * ny,), the node on the other storey that continues a flight, or -1.
        stretch: length of the slope over its horizontal run.
    """

    free: NDArray[np.bool_]
    slack: NDArray[np.float32]
    zone: NDArray[np.int8]
    link: Ints
    stretch: float


class Geodesics:
    """Shortest distances and paths in a walkable space.

    Args:
        walkable: the space.
        radius_m: of the agent's disc.
    """

    def __init__(self, walkable: Walkable, radius_m: float = AGENT_RADIUS_M) -> None:
        self.walkable = walkable
        clearance = np.stack([space.clearance_m for space in walkable.floors])
        free = clearance >= radius_m
        free[:, [0, -1], :] = free[:, :, [0, -1]] = False
        slack = np.maximum(0.0, (clearance - radius_m - _HALF_DIAGONAL_M) / RESOLUTION_M).astype(np.float32)
        self.grid = Grid(free, slack, np.zeros(free.shape, np.int8), np.full(free.size, -1, np.int64), self._mark_stairs())
        for stairs in walkable.house.stairs:
            self._link(stairs)

    def _mark_stairs(self) -> float:
        stretches = [1.0]
        for stairs in self.walkable.house.stairs:
            low, high = (self.walkable.house.floors[stairs.lower_floor + k].z_m for k in (0, 1))
            run = stairs.rect.width if direction(stairs)[0] else stairs.rect.depth
            stretches.append(math.hypot(run, high - low) / run)
        return max(stretches)

    def _link(self, stairs: Stairs) -> None:
        ux, uy = direction(stairs)
        lower, space = stairs.lower_floor, self.walkable.floors[stairs.lower_floor]
        for k in (0, 1):
            self.grid.zone[lower + k][space.cells_of(portion(stairs, 0.5 * k, 0.5 + 0.5 * k))] = 1 if ux else 2
        low = self.grid.free[lower] & (self.grid.zone[lower] > 0)
        high = self.grid.free[lower + 1] & (self.grid.zone[lower + 1] > 0)
        _, nx, ny = self.grid.free.shape
        for i, j in np.argwhere(low).tolist():
            for ahead in (1, 2):
                a, b = i + ahead * ux, j + ahead * uy
                if high[a, b] and not low[i + ux, j + uy]:
                    here, there = (lower * nx + i) * ny + j, ((lower + 1) * nx + a) * ny + b
                    self.grid.link[here], self.grid.link[there] = there, here
                    break

    def distances_from(self, goal_points: Sequence[Point] | Float) -> Field:
        """Distances from the nearest of some points (K, 3) to everywhere.

        Points where the agent cannot stand are moved to the nearest free cell within 0.15 m, or left out.
        """
        return self._search(goal_points, -1)

    def distance_m(self, a_xyz: Point, b_xyz: Point) -> float:
        """Length of the shortest way between two points (x, y, z of the feet) [m]; inf when there is none."""
        return self._to(a_xyz, b_xyz).at(*_xyz(a_xyz))

    def path(self, a_xyz: Point, b_xyz: Point) -> Float:
        """The shortest way from a to b as a polyline (N, 3) with bends only at corners; (0, 3) when there is none."""
        return self._to(a_xyz, b_xyz).path(*_xyz(a_xyz))

    def _to(self, a_xyz: Point, b_xyz: Point) -> Field:
        x, y, z = _xyz(a_xyz)
        node, _ = self._node(x, y, z)
        return self._search([b_xyz], node)

    def _search(self, points: Sequence[Point] | Float, target: int) -> Field:
        if len(points) == 0:
            raise UsageError("Distances from no point at all were asked for: give at least one goal point.")
        seeds, xy = [], []
        for point in points:
            node, cell_xy = self._node(*_xyz(point))
            if node >= 0:
                seeds.append(node)
                xy.append(cell_xy)
        g = self.grid
        found = spread(
            g.free,
            g.slack,
            g.zone,
            g.link,
            g.stretch,
            np.array(seeds, np.int64),
            np.array(xy, np.float64).reshape(-1, 2),
            target,
        )
        return Field(self, *found)

    def cell_xy(self, x: float, y: float) -> tuple[float, float]:
        """A point in cell units."""
        x0, y0 = self.walkable.floors[0].origin_m
        return (x - x0) / RESOLUTION_M, (y - y0) / RESOLUTION_M

    def _node(self, x: float, y: float, z: float) -> tuple[int, tuple[float, float]]:
        """The free node of a point, or the nearest one within reach, and the point in cell units; -1 when there is none."""
        f = self.walkable.floor_index(x, y, z)
        u, v = self.cell_xy(x, y)
        _, nx, ny = self.grid.free.shape
        best, node = math.inf, -1
        for i in range(max(0, int(u) - _SNAP_CELLS), min(nx, int(u) + _SNAP_CELLS + 1)):
            for j in range(max(0, int(v) - _SNAP_CELLS), min(ny, int(v) + _SNAP_CELLS + 1)):
                away = math.hypot(i + 0.5 - u, j + 0.5 - v)
                if self.grid.free[f, i, j] and away < best:
                    best, node = away, (f * nx + i) * ny + j
        return (node, (u, v)) if best <= _SNAP_CELLS else (-1, (u, v))

    def position_m(self, u: float, v: float, floor: int) -> tuple[float, float, float]:
        """A point in cell units on a storey, in the scene frame."""
        x0, y0 = self.walkable.floors[0].origin_m
        x, y = x0 + u * RESOLUTION_M, y0 + v * RESOLUTION_M
        return x, y, self.walkable.floor_height_m(x, y, self.walkable.house.floors[floor].z_m)


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Distances from a set of sources to everywhere; per node in cell units.

    Args:
        geodesics: the space it belongs to.
        distance: inf where no way leads.
        bend_x, bend_y, bend_distance: last bend before the node, seen from the source, and how far it is from the source.
        bend: node of that bend; -1 - k for source k itself.
    """

    geodesics: Geodesics
    distance: Float
    bend_x: Float
    bend_y: Float
    bend_distance: Float
    bend: Ints

    def at(self, x: float, y: float, z: float) -> float:
        """Distance from a point (feet) to the nearest source [m]; inf when cut off or where the agent cannot stand."""
        return self._best(x, y, z)[0]

    def at_many(self, points_m: Float) -> Float:
        """Distances of points (N, 3), shape (N,)."""
        return np.array([self.at(*_xyz(point)) for point in points_m])

    def grid_m(self) -> Float:
        """Distances of all cells (F, nx, ny) [m], inf where the agent cannot be; cells as in ``Walkable.floors``."""
        return self.distance.reshape(self.geodesics.grid.free.shape) * RESOLUTION_M

    def path(self, x: float, y: float, z: float) -> Float:
        """The shortest way from a point to the nearest source as a polyline (N, 3); (0, 3) when there is none."""
        distance, node, direct = self._best(x, y, z)
        if not math.isfinite(distance):
            return np.zeros((0, 3))
        geodesics, (_, nx, ny) = self.geodesics, self.geodesics.grid.free.shape
        points = [(x, y, geodesics.walkable.floor_height_m(x, y, z))]
        if not direct:
            points.append(geodesics.position_m((node // ny) % nx + 0.5, node % ny + 0.5, node // (nx * ny)))
        while True:
            following = int(self.bend[node])
            floor = (node if following < 0 else following) // (nx * ny)
            points.append(geodesics.position_m(self.bend_x[node], self.bend_y[node], floor))
            if following < 0:
                return _distinct(np.array(points))
            node = following

    def _best(self, x: float, y: float, z: float) -> tuple[float, int, bool]:
        geodesics, g = self.geodesics, self.geodesics.grid
        f = geodesics.walkable.floor_index(x, y, z)
        u, v = geodesics.cell_xy(x, y)
        bends = (self.bend_x, self.bend_y, self.bend_distance, self.bend)
        distance, node, direct = look_up(g.free, g.slack, g.zone, g.stretch, self.distance, *bends, f, u, v, _SNAP_CELLS)
        return float(distance) * RESOLUTION_M, int(node), bool(direct)


def _xyz(point: Point) -> tuple[float, float, float]:
    x, y, z = point
    return float(x), float(y), float(z)


def _distinct(points: Float) -> Float:
    """The polyline without repeated points."""
    keep = np.ones(len(points), np.bool_)
    keep[1:] = np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-6
    return points[keep]
