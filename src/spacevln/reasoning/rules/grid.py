"""The known floor as a grid of rooms: free space cut at the thresholds, and walks inside one room."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, distance_transform_edt, gaussian_filter, label
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from spacevln.core import Pose, SpatialMap
from spacevln.reasoning.rules.lattice import Guide
from spacevln.reasoning.rules.sightings import XY, Portal

Float = NDArray[np.float64]
CELL_M = 0.15
MARGIN_M = 1.5
DETOUR_M = 3.0  # how far a way to a near goal may lead around
COMFORT_M = 0.35  # walks keep this far from walls where they can
CROWDED = 1.5  # what a metre along an obstacle costs more
STEP_M = 0.2
NOWHERE = 0


class FloorGrid:
    """One storey.

    Args:
        space: the metric map of that storey, asked once.
        points: (N, 2) places that bound what is known.
        portals: whose thresholds part the rooms.
        margin_m: known floor around the points.
        trodden: places where the body stood: free, though the camera never saw them.
    """

    def __init__(
        self, space: SpatialMap, points: Float, portals: Sequence[Portal], trodden: Sequence[XY] = (), margin_m: float = MARGIN_M
    ) -> None:
        low = np.floor((points.min(axis=0) - margin_m) / CELL_M).astype(int)
        high = np.ceil((points.max(axis=0) + margin_m) / CELL_M).astype(int)
        self.origin = low * CELL_M
        self.shape = (int(high[0] - low[0]), int(high[1] - low[1]))
        ii, jj = np.meshgrid(np.arange(self.shape[0]), np.arange(self.shape[1]), indexing="ij")
        centres = self.origin + (np.stack([ii.ravel(), jj.ravel()], axis=1) + 0.5) * CELL_M
        self.free = np.asarray(space.is_free(centres)).reshape(self.shape)
        # surfaces are one map cell thick: looked for at four places of each cell
        quarters = [centres + CELL_M / 4 * np.array(sign) for sign in ((-1, -1), (-1, 1), (1, -1), (1, 1))]
        solid = np.asarray(space.is_obstacle(np.concatenate(quarters))).reshape(4, *self.shape)
        self.obstacle = np.any(solid, axis=0)
        self.free = (self.free | np.asarray(binary_closing(self.free, np.ones((3, 3), np.bool_)))) & ~self.obstacle
        for i, j in (self.cell((float(x), float(y))) for x, y in trodden):
            self.free[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2] |= ~self.obstacle[
                max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2
            ]
        cut = self.free.copy()
        for portal in portals:
            cut &= ~self._threshold(centres, portal).reshape(self.shape)
        self.rooms, self.count = label(cut)
        self.clearance_m = np.asarray(distance_transform_edt(cut)) * CELL_M
        self._graphs: dict[int, tuple[NDArray[np.int64], NDArray[np.int64], csr_matrix]] = {}
        self._trees: dict[tuple[int, int], tuple[Float, NDArray[np.int32]]] = {}

    @staticmethod
    def _threshold(centres: Float, portal: Portal) -> NDArray[np.bool_]:
        d = centres - np.array(portal.xy)
        c, s = math.cos(portal.along_rad), math.sin(portal.along_rad)
        along, across = np.abs(c * d[:, 0] + s * d[:, 1]), np.abs(-s * d[:, 0] + c * d[:, 1])
        return np.asarray((across <= 0.75 * CELL_M) & (along <= portal.width_m / 2 + 0.2))

    def cell(self, xy: XY) -> tuple[int, int]:
        """The cell of a point, clipped to the grid."""
        i, j = math.floor((xy[0] - self.origin[0]) / CELL_M), math.floor((xy[1] - self.origin[1]) / CELL_M)
        return min(max(i, 0), self.shape[0] - 1), min(max(j, 0), self.shape[1] - 1)

    def room_at(self, xy: XY, within_m: float = 0.5) -> int:
        """The room of the free cell nearest to a point; 0 when none is within reach."""
        i, j = self.cell(xy)
        if self.rooms[i, j]:
            return int(self.rooms[i, j])
        r = math.ceil(within_m / CELL_M)
        i0, j0 = max(i - r, 0), max(j - r, 0)
        window = self.rooms[i0 : i + r + 1, j0 : j + r + 1]
        cells = np.argwhere(window)
        if not len(cells):
            return NOWHERE
        distance = np.hypot(cells[:, 0] + i0 - i, cells[:, 1] + j0 - j)
        best = int(np.argmin(distance))
        return int(window[tuple(cells[best])]) if distance[best] * CELL_M <= within_m + 1e-9 else NOWHERE

    def area_m2(self, room: int) -> float:
        """Known floor of a room."""
        return float(np.count_nonzero(self.rooms == room)) * CELL_M**2

    def breadth_m(self, room: int) -> float:
        """Width of the widest place of a room: twice its largest clearance."""
        return 2 * float(self.clearance_m[self.rooms == room].max(initial=0.0))

    def centres(self, room: int) -> Float:
        """Centres (N, 2) of a room's cells."""
        return np.asarray(self.origin + (self._graph(room)[0] + 0.5) * CELL_M)

    def _graph(self, room: int) -> tuple[NDArray[np.int64], NDArray[np.int64], csr_matrix]:
        if room in self._graphs:
            return self._graphs[room]
        cells = np.argwhere(self.rooms == room)
        index = np.full(self.shape, -1, dtype=np.int64)
        index[cells[:, 0], cells[:, 1]] = np.arange(len(cells))
        near = 1.0 + 2.0 * np.clip(1.0 - self.clearance_m / COMFORT_M, 0.0, 1.0)
        rows, cols, costs = [], [], []
        for di, dj in ((1, 0), (0, 1), (1, 1), (1, -1)):
            a = index[: self.shape[0] - di, max(-dj, 0) : self.shape[1] - max(dj, 0)]
            b = index[di:, max(dj, 0) : self.shape[1] - max(-dj, 0)]
            weight = (
                near[: self.shape[0] - di, max(-dj, 0) : self.shape[1] - max(dj, 0)]
                + near[di:, max(dj, 0) : self.shape[1] - max(-dj, 0)]
            ) / 2
            both = (a >= 0) & (b >= 0)
            rows.append(a[both])
            cols.append(b[both])
            costs.append(math.hypot(di, dj) * CELL_M * weight[both])
        graph = csr_matrix((np.concatenate(costs), (np.concatenate(rows), np.concatenate(cols))), shape=(len(cells), len(cells)))
        self._graphs[room] = (cells, index, graph)
        return self._graphs[room]

    def snap(self, room: int, xy: XY, within_m: float = 1.0) -> int:
        """Index of the room's cell nearest to a point, -1 when none is within reach."""
        cells, index, _ = self._graph(room)
        i, j = self.cell(xy)
        if index[i, j] >= 0:
            return int(index[i, j])
        if not len(cells):
            return -1
        distance = np.hypot(*(self.origin + (cells + 0.5) * CELL_M - np.array(xy)).T)
        best = int(np.argmin(distance))
        return best if distance[best] <= within_m else -1

    def walk(self, room: int, start: XY, goal: XY) -> Float | None:
        """A short, comfortable walk (N, 2) every 0.2 m inside a room; None when there is none."""
        cells, _, graph = self._graph(room)
        a, b = self.snap(room, start), self.snap(room, goal)
        if a < 0 or b < 0:
            return None
        if (room, a) not in self._trees:
            cost, parents = dijkstra(graph, directed=False, indices=np.array([a]), return_predecessors=True)
            self._trees[room, a] = (np.asarray(cost[0]), np.asarray(parents[0]))
        _, parents = self._trees[room, a]
        steps = [b]
        while steps[-1] != a:
            parent = int(parents[steps[-1]])
            if parent < 0:
                return None
            steps.append(parent)
        points = self.origin + (cells[np.array(steps[::-1])] + 0.5) * CELL_M
        points[0], points[-1] = start, goal
        return resampled(self._pulled(points, room))

    @cached_property
    def loose_price(self) -> Float:
        """(I, J) price of a metre for who may brush along obstacles and walk over unseen floor."""
        cost = np.where(self.obstacle, 60.0, np.where(self.free, 1.0, 2.5))
        room_m = (np.asarray(distance_transform_edt(~self.obstacle)) - 0.5) * CELL_M
        return np.asarray(cost + CROWDED * np.clip(1.0 - room_m / COMFORT_M, 0.0, 1.0))

    @cached_property
    def _loose_graph(self) -> csr_matrix:
        cost = self.loose_price
        index = np.arange(cost.size).reshape(self.shape)
        rows, cols, costs = [], [], []
        for di, dj in ((1, 0), (0, 1), (1, 1), (1, -1)):
            a = (slice(0, self.shape[0] - di), slice(max(-dj, 0), self.shape[1] - max(dj, 0)))
            b = (slice(di, None), slice(max(dj, 0), self.shape[1] - max(-dj, 0)))
            rows.append(index[a].ravel())
            cols.append(index[b].ravel())
            costs.append((math.hypot(di, dj) * CELL_M * (cost[a] + cost[b]) / 2).ravel())
        return csr_matrix((np.concatenate(costs), (np.concatenate(rows), np.concatenate(cols))), shape=(cost.size, cost.size))

    def loose_length_m(self, goal: XY) -> Float:
        """(I, J) priced length of the loose way from every cell to a goal."""
        i, j = self.cell(goal)
        length = dijkstra(self._loose_graph, directed=False, indices=np.array([i * self.shape[1] + j]))
        return np.asarray(length[0]).reshape(self.shape)

    def loose_walk(self, start: XY, goal: XY) -> Float | None:
        """A walk over the whole storey that may brush along obstacles and over unseen floor at a price; None when cut off."""
        (i, j), (k, m) = self.cell(start), self.cell(goal)
        first = i * self.shape[1] + j
        _, parents = dijkstra(self._loose_graph, directed=False, indices=np.array([first]), return_predecessors=True)
        steps = [k * self.shape[1] + m]
        while steps[-1] != first:
            parent = int(parents[0][steps[-1]])
            if parent < 0:
                return None
            steps.append(parent)
        cells = np.stack(np.divmod(np.array(steps[::-1]), self.shape[1]), axis=1)
        if len(cells) < 2:
            return None
        points = self.origin + (cells + 0.5) * CELL_M
        points[0], points[-1] = start, goal
        if len(points) > 4:  # smooth the corners of the grid
            inner = (points[:-2] + 2 * points[1:-1] + points[2:]) / 4
            points = np.concatenate([points[:1], inner, points[-1:]])
        return resampled(points)

    def _pulled(self, points: Float, room: int) -> Float:
        """Without the corners that a straight walk can skip."""
        keep = [0]
        while keep[-1] < len(points) - 1:
            low, high = keep[-1] + 1, len(points) - 1
            while low < high:
                middle = (low + high + 1) // 2
                if self.clear(points[keep[-1]], points[middle], room):
                    low = middle
                else:
                    high = middle - 1
            keep.append(low)
        return np.asarray(points[np.array(keep)])

    def clear(self, a: Float, b: Float, room: int) -> bool:
        """Whether a straight walk stays inside a room, its ends aside."""
        n = max(2, int(math.hypot(*(b - a)) / (CELL_M / 2)))
        line = a + np.linspace(0.0, 1.0, n)[2:-2, None] * (b - a)
        ij = np.floor((line - self.origin) / CELL_M).astype(int)
        return (
            bool((self.rooms[ij[:, 0], ij[:, 1]] == room).all() and (self.clearance_m[ij[:, 0], ij[:, 1]] > 0.16).all())
            if len(ij)
            else True
        )


def square_rad(space: SpatialMap, pose: Pose, reach_m: float = 5.0) -> float:
    """Direction of the walls around a pose, modulo a right angle, from the edges of the known obstacles."""
    axis = np.arange(-reach_m, reach_m, 0.1)
    xx, yy = np.meshgrid(pose.x_m + axis, pose.y_m + axis, indexing="ij")
    solid = np.asarray(space.is_obstacle(np.stack([xx.ravel(), yy.ravel()], axis=1))).reshape(xx.shape)
    gx, gy = np.gradient(gaussian_filter(solid.astype(np.float64), 1.5))
    angle, weight = np.arctan2(gy, gx), gx**2 + gy**2
    return math.atan2(float((weight * np.sin(4 * angle)).sum()), float((weight * np.cos(4 * angle)).sum())) / 4


def comfortable_guide(space: SpatialMap, pose: Pose, goal: XY) -> Guide:
    """The way to a goal that keeps off obstacles, over known floor where it can."""
    grid = FloorGrid(space, np.array([[pose.x_m, pose.y_m], goal]), (), ((pose.x_m, pose.y_m),), DETOUR_M)
    return Guide(grid.origin, CELL_M, grid.loose_price, grid.loose_length_m(goal))


def resampled(path: Float, step_m: float = STEP_M) -> Float:
    """A polyline at equal steps; both ends are kept."""
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    s = np.append(np.arange(0.0, max(float(arc[-1]) - 0.05, 1e-9), step_m), arc[-1])
    return np.stack([np.interp(s, arc, path[:, 0]), np.interp(s, arc, path[:, 1])], axis=1)
