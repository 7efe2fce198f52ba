"""Coarse grids of a house for reasoning about routes: which room, what is walkable, what hides what.

These serve choosing and describing; distances that are published come from :mod:`..walking.geodesics`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from spacevln.environments.houses.episodes.item_geometry import surface_distance
from spacevln.environments.houses.ground.walkable import RESOLUTION_M, Walkable
from spacevln.environments.houses.plan import Item, Opening, Rect

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Ints = NDArray[np.int64]
XY = tuple[float, float]

CELL_M = 0.1
CLEARANCE_M = 0.15  # a little more than the agent's 0.1 m, so that canonical paths keep off furniture
EYE_M = 0.88
_MARGIN_M = 0.5


def opening_rect(opening: Opening, wall_m: float) -> Rect:
    """The hole in the wall, a little deeper than the wall."""
    half, deep = opening.width_m / 2, wall_m / 2 + 0.05
    if opening.along == "x":
        return Rect(opening.x - half, opening.y - deep, opening.x + half, opening.y + deep)
    return Rect(opening.x - deep, opening.y - half, opening.x + deep, opening.y + half)


class Space:
    """The grids of one house.

    Args:
        walkable: of the house whose rooms and items are rasterised.
    """

    def __init__(self, walkable: Walkable) -> None:
        house = walkable.house
        self.house = house
        rects = [rect for room in house.rooms for rect in room.rects] + [stairs.rect for stairs in house.stairs]
        self.x0 = min(r.x0 for r in rects) - _MARGIN_M
        self.y0 = min(r.y0 for r in rects) - _MARGIN_M
        shape_i = math.ceil((max(r.x1 for r in rects) + _MARGIN_M - self.x0) / CELL_M)
        shape_j = math.ceil((max(r.y1 for r in rects) + _MARGIN_M - self.y0) / CELL_M)
        self.shape = (shape_i, shape_j)
        self.xs = self.x0 + (np.arange(shape_i) + 0.5) * CELL_M
        self.ys = self.y0 + (np.arange(shape_j) + 0.5) * CELL_M
        n = len(house.floors)
        self.room = np.full((n, *self.shape), -1, dtype=np.int32)
        self.hole = np.full((n, *self.shape), -1, dtype=np.int32)
        self.opaque = np.ones((n, *self.shape), dtype=np.bool_)
        self.walkable = np.zeros((n, *self.shape), dtype=np.bool_)
        for floor in house.floors:
            self._rasterise(floor.index, walkable)

    def _mask(self, rect: Rect) -> tuple[slice, slice]:
        i0, i1 = np.searchsorted(self.xs, [rect.x0, rect.x1])
        j0, j1 = np.searchsorted(self.ys, [rect.y0, rect.y1])
        return slice(int(i0), int(i1)), slice(int(j0), int(j1))

    def _rasterise(self, floor: int, walkable: Walkable) -> None:
        house = self.house
        inside = np.zeros(self.shape, dtype=np.bool_)
        for room in house.rooms:
            if room.floor == floor:
                for rect in room.rects:
                    self.room[floor][self._mask(rect)] = room.id
                    inside[self._mask(rect)] = True
        for opening in house.openings:
            if opening.floor == floor and opening.kind != "window":
                cells = self._mask(opening_rect(opening, house.wall_thickness_m))
                inside[cells] = True
                self.hole[floor][cells] = opening.id
        opaque = ~inside
        z_m = house.floors[floor].z_m
        for item in house.items:
            if item.floor != floor or not item.solid or item.z - z_m > 1.3:
                continue
            if item.z - z_m < EYE_M + 0.2 and item.z - z_m + item.size[2] > EYE_M + 0.3:
                cells, near = self._around(item)
                opaque[cells] |= near
        self.opaque[floor] = opaque
        space = walkable.floors[floor]
        i = np.clip(((self.xs - space.origin_m[0]) / RESOLUTION_M).astype(np.int64), 0, space.clearance_m.shape[0] - 1)
        j = np.clip(((self.ys - space.origin_m[1]) / RESOLUTION_M).astype(np.int64), 0, space.clearance_m.shape[1] - 1)
        free = inside & (space.clearance_m[np.ix_(i, j)] >= CLEARANCE_M)
        for stairs in house.stairs:
            if floor in (stairs.lower_floor, stairs.lower_floor + 1):
                free[self._mask(stairs.rect)] = False
        self.walkable[floor] = free

    def _around(self, item: Item) -> tuple[tuple[slice, slice], Bool]:
        reach = math.hypot(item.size[0], item.size[1]) / 2 + CELL_M
        cells = self._mask(Rect(item.x - reach, item.y - reach, item.x + reach, item.y + reach))
        xx, yy = np.meshgrid(self.xs[cells[0]], self.ys[cells[1]], indexing="ij")
        near = surface_distance(item, np.stack([xx.ravel(), yy.ravel()], axis=1)) < 0.04
        return cells, near.reshape(xx.shape)

    def ij(self, xy: Float) -> NDArray[np.int64]:
        """Cells of points (N, 2), clipped to the grid."""
        cells = np.floor((xy - np.array([self.x0, self.y0])) / CELL_M).astype(np.int64)
        return np.asarray(np.clip(cells, 0, np.array(self.shape) - 1), dtype=np.int64)

    def xy(self, ij: NDArray[np.int64]) -> Float:
        """Centres of cells (N, 2)."""
        return np.asarray(np.array([self.x0, self.y0]) + (ij + 0.5) * CELL_M, dtype=np.float64)

    def room_mask(self, room: int) -> Bool:
        """Walkable cells of a room and of the holes in its walls."""
        floor = self.house.rooms[room].floor
        mask = self.room[floor] == room
        for opening in self.house.openings:
            if opening.floor == floor and opening.kind != "window" and room in opening.rooms:
                mask = mask | (self.hole[floor] == opening.id)
        return np.asarray(mask & self.walkable[floor], dtype=np.bool_)

    @lru_cache(maxsize=64)  # noqa: B019 - lives as long as the house's space
    def graph(self, room: int, floor: int) -> tuple[NDArray[np.int64], NDArray[np.int64], csr_array[np.float64, tuple[int, int]]]:
        """Cells (N, 2), their index image, and the 8-connected graph of a room, or of a whole floor (``room`` = -1)."""
        mask = self.walkable[floor] if room < 0 else self.room_mask(room)
        cells = np.argwhere(mask)
        index = np.full(self.shape, -1, dtype=np.int64)
        index[mask] = np.arange(len(cells))
        rows, cols, costs = [], [], []
        for di, dj in ((1, 0), (0, 1), (1, 1), (1, -1)):
            a = index[: self.shape[0] - di, max(-dj, 0) : self.shape[1] - max(dj, 0)]
            b = index[di:, max(dj, 0) : self.shape[1] - max(-dj, 0)]
            both = (a >= 0) & (b >= 0)
            rows.append(a[both])
            cols.append(b[both])
            costs.append(np.full(int(both.sum()), math.hypot(di, dj) * CELL_M))
        graph = csr_array((np.concatenate(costs), (np.concatenate(rows), np.concatenate(cols))), shape=(len(cells), len(cells)))
        return cells, index, graph

    def snap(self, xy: XY, room: int, floor: int, within_m: float = 0.6) -> int:
        """Index of the graph's cell nearest to a point, -1 when none lies within ``within_m``."""
        cells, index, _ = self.graph(room, floor)
        if not len(cells):
            return -1
        i = min(max(int((xy[0] - self.x0) / CELL_M), 0), self.shape[0] - 1)
        j = min(max(int((xy[1] - self.y0) / CELL_M), 0), self.shape[1] - 1)
        node = int(index[i, j])
        if node >= 0:
            return node
        ni, nj = self._nearest(room, floor)
        node = int(index[ni[i, j], nj[i, j]])
        x, y = self.xs[cells[node][0]], self.ys[cells[node][1]]
        return node if math.hypot(x - xy[0], y - xy[1]) <= within_m else -1

    @lru_cache(maxsize=64)  # noqa: B019
    def _nearest(self, room: int, floor: int) -> NDArray[np.int32]:
        _, index, _ = self.graph(room, floor)
        return np.asarray(distance_transform_edt(index < 0, return_distances=False, return_indices=True), dtype=np.int32)

    def standing(self, xy: XY, room: int, within_m: float = 0.3) -> XY | None:
        """The point itself if the agent can comfortably stand there, else the nearest such place of the room, or None."""
        floor = self.house.rooms[room].floor
        i, j = self.ij(np.array([xy]))[0]
        if self.walkable[floor, i, j]:
            return xy
        cells, _, _ = self.graph(room, floor)
        node = self.snap(xy, room, floor, within_m)
        return None if node < 0 else (float(self.xs[cells[node][0]]), float(self.ys[cells[node][1]]))

    def path(self, room: int, a: tuple[float, float], b: tuple[float, float]) -> Float | None:
        """A short polyline (N, 2) inside a room between two points, or None when furniture or walls part them."""
        floor = self.house.rooms[room].floor
        cells, _, _ = self.graph(room, floor)
        start, goal = self.snap(a, room, floor), self.snap(b, room, floor)
        if start < 0 or goal < 0:
            return None
        parents = self._parents(room, floor, goal)
        steps = [start]
        while steps[-1] != goal:
            parent = int(parents[steps[-1]])
            if parent < 0:
                return None
            steps.append(parent)
        points = self.xy(cells[np.array(steps)])
        points[0], points[-1] = a, b
        return self.pulled(points, self.walkable[floor])

    @lru_cache(maxsize=256)  # noqa: B019
    def _parents(self, room: int, floor: int, goal: int) -> NDArray[np.int32]:
        _, _, graph = self.graph(room, floor)
        _, parents = dijkstra(graph, directed=False, indices=np.array([goal]), return_predecessors=True)
        return np.asarray(parents[0], dtype=np.int32)

    def pulled(self, points: Float, walkable: Bool) -> Float:
        """The polyline without the corners that a straight walk can skip."""
        keep = [0]
        last = len(points) - 1
        while keep[-1] < last:
            low, high = keep[-1] + 1, last
            while low < high:  # furthest point in a straight walk (found by bisection: sight is nearly monotone)
                middle = (low + high + 1) // 2
                if self._clear(points[keep[-1]], points[middle], walkable):
                    low = middle
                else:
                    high = middle - 1
            keep.append(low)
        return np.asarray(points[np.array(keep)], dtype=np.float64)

    def _clear(self, a: Float, b: Float, free: Bool) -> bool:
        n = max(2, int(math.hypot(*(b - a)) / (CELL_M / 2)))
        t = np.linspace(0.0, 1.0, n)[1:-1, None]
        ij = self.ij(a + t * (b - a))
        return bool(free[ij[:, 0], ij[:, 1]].all())

    def sees(self, floor: int, eyes: Float, targets: Float, short_m: float = 0.2) -> Bool:
        """Line of sight (N,) at eye height from points (N, 2) to points (N, 2), up to ``short_m`` before each target."""
        d = targets - eyes
        dist = np.maximum(np.hypot(d[:, 0], d[:, 1]), 1e-6)
        d = d * (np.maximum(dist - short_m, 0.0) / dist)[:, None]
        t = np.linspace(0.0, 1.0, max(2, int(dist.max() / (0.8 * CELL_M)) + 1))[None, :, None]
        points = (eyes[:, None] + d[:, None] * t - (self.x0, self.y0)) / CELL_M
        ij = np.minimum(np.maximum(points.astype(np.int64), 0), np.array(self.shape) - 1)
        return np.asarray(~self.opaque[floor][ij[..., 0], ij[..., 1]].any(axis=1))

    def rough_field(self, x: float, y: float, floor: int, limit_m: float = 40.0) -> RoughField:
        """Approximate walking distances to a point, over stairs."""
        out = np.full((len(self.house.floors), *self.shape), np.inf)
        ways: dict[int, tuple[XY, int]] = {}
        parents: dict[int, NDArray[np.int32]] = {}
        queue = [(floor, (x, y), 0.0)]
        while queue:
            level, point, offset = queue.pop(0)
            cells, _, graph = self.graph(-1, level)
            source = self.snap(point, -1, level)
            if source < 0:
                continue
            found, onward = dijkstra(graph, directed=False, indices=np.array([source]), limit=limit_m, return_predecessors=True)
            dist, parents[level] = found[0] + offset, onward[0]
            out[level][cells[:, 0], cells[:, 1]] = dist
            for near, far, far_floor, length in self.stair_ends(level):
                node = self.snap(near, -1, level)
                if node >= 0 and math.isfinite(dist[node]) and far_floor not in ways and far_floor != floor:
                    ways[far_floor] = (near, level)
                    queue.append((far_floor, far, float(dist[node]) + length))
        return RoughField(self, out, ways, parents)

    def stair_ends(self, floor: int) -> list[tuple[tuple[float, float], tuple[float, float], int, float]]:
        """Stairs from a floor: (end here, end there, floor there, length)."""
        out = []
        for stairs in self.house.stairs:
            foot, top = stairs_ends(stairs.rect, stairs.up_yaw_rad)
            rise = self.house.floors[stairs.lower_floor + 1].z_m - self.house.floors[stairs.lower_floor].z_m
            length = math.hypot(math.dist(foot, top), rise)
            if stairs.lower_floor == floor:
                out.append((foot, top, floor + 1, length))
            elif stairs.lower_floor + 1 == floor:
                out.append((top, foot, floor - 1, length))
        return out


@dataclass(frozen=True, slots=True)
class RoughField:
    """Approximate distances to a goal.

    Args:
        space: whose grid it is on.
        distance_m: (floors, I, J), inf where cut off.
        ways: per storey other than the goal's: the far end of the stairs that lead on from it, and the storey there.
        parents: per storey: of every cell of the walkable graph, the next one on the way; negative at its end.
    """

    space: Space
    distance_m: Float
    ways: dict[int, tuple[XY, int]]
    parents: dict[int, NDArray[np.int32]]

    def value(self, x: float, y: float, floor: int) -> float:
        """The distance from the walkable cell nearest to a point."""
        cells, _, _ = self.space.graph(-1, floor)
        node = self.space.snap((x, y), -1, floor)
        return float(self.distance_m[floor][tuple(cells[node])]) if node >= 0 else math.inf

    def path(self, x: float, y: float, floor: int, end: XY) -> Float | None:
        """A short polyline (N, 3) from a point to the goal, or None."""
        pieces = []
        for _ in range(len(self.space.house.floors)):
            finish, level = self.ways.get(floor, (end, floor))
            line = self._descent(x, y, floor)
            if line is None:
                return None
            if level == floor:
                line[-1] = end
            pieces.append(np.column_stack([line, np.full(len(line), self.space.house.floors[floor].z_m)]))
            if level == floor:
                return np.concatenate(pieces)
            (x, y), floor = finish, level
        return None

    def _descent(self, x: float, y: float, floor: int) -> Float | None:
        cells, _, _ = self.space.graph(-1, floor)
        node = self.space.snap((x, y), -1, floor)
        if node < 0 or floor not in self.parents:
            return None
        steps = [node]
        parents = self.parents[floor]
        while (node := int(parents[node])) >= 0:
            steps.append(node)
        points = self.space.xy(cells[np.array(steps)])
        points[0] = (x, y)
        return self.space.pulled(points, self.space.walkable[floor]) if len(points) > 1 else points


def stairs_ends(rect: Rect, up_yaw_rad: float, beyond_m: float = 0.35) -> tuple[tuple[float, float], tuple[float, float]]:
    """Points on the two storeys just before and after a flight: (foot, top)."""
    ux, uy = round(math.cos(up_yaw_rad)), round(math.sin(up_yaw_rad))
    cx, cy = rect.centre
    half = (rect.width / 2 if ux else rect.depth / 2) + beyond_m
    return (cx - ux * half, cy - uy * half), (cx + ux * half, cy + uy * half)
