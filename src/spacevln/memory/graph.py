"""The Spatial Waypoint graph G_t: E_t = E_map u E_chain, stored (paper appendix, "Spatial Waypoints and region topology")."""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from spacevln.core import SpatialWaypoint
from spacevln.core.geometry import Float
from spacevln.memory.metric import MemoryMap

REACH_M = 5.0  # longest E_map edge; longer ways are paths over edges [ours]
NEAR_PATH_M = 0.5  # a third waypoint this near to the path splits the edge [ours]


class EdgeKind(StrEnum):
    """Where an edge comes from."""

    MAP = "map"  # Reach(w_i, w_j; m_t) = 1, locally
    CHAIN = "chain"  # consecutive in the executed chain


@dataclass(frozen=True, slots=True)
class Edge:
    """An undirected edge between waypoints ``a`` < ``b``.

    Args:
        length_m: of the known way; never below the straight line.
        floor_transition: the two ends lie on different floors.
    """

    a: int
    b: int
    kind: EdgeKind
    length_m: float
    floor_transition: bool = False

    def other(self, index: int) -> int:
        """The end that is not ``index``."""
        return self.b if index == self.a else self.a


class WaypointGraph:
    """Waypoints by index and the edges between them."""

    def __init__(self) -> None:
        self._edges: dict[tuple[int, int, EdgeKind], Edge] = {}
        self._paths: dict[tuple[int, int], Float] = {}  # of E_map edges
        self._legs: dict[tuple[int, int], Float] = {}  # of E_chain edges on one floor
        self._adjacent: dict[int, dict[int, float]] = {}

    @classmethod
    def restored(cls, ways: Sequence[tuple[Edge, Float]]) -> WaypointGraph:
        """The graph of these edges, each with the way along it (:meth:`path_of`)."""
        graph = cls()
        for edge, path in ways:
            graph._edges[edge.a, edge.b, edge.kind] = edge
            (graph._paths if edge.kind is EdgeKind.MAP else graph._legs)[edge.a, edge.b] = path
            graph._relink(edge.a, edge.b)
        return graph

    @property
    def edges(self) -> tuple[Edge, ...]:
        """Every edge, ordered by ends and kind."""
        return tuple(self._edges[key] for key in sorted(self._edges))

    def neighbours(self, index: int) -> Mapping[int, float]:
        """Adjacent waypoints and the length of the shortest edge to each."""
        return dict(sorted(self._adjacent.get(index, {}).items()))

    def connect_chain(self, a: SpatialWaypoint, b: SpatialWaypoint, path: Float, length_m: float) -> None:
        """Adj(P): join two consecutive waypoints of the chain; the shortest way between them counts.

        Args:
            a, b: consecutive.
            path: (N, 2) points of the way [m].
            length_m: of that way.
        """
        self._put(a, b, EdgeKind.CHAIN, length_m)
        self._legs[_key(a.index, b.index)] = path

    def path_of(self, edge: Edge) -> Float:
        """The known way along an edge, (N, 2) points [m]; from either end."""
        return (self._paths if edge.kind is EdgeKind.MAP else self._legs)[edge.a, edge.b]

    def connect_map(self, new: SpatialWaypoint, others: Sequence[SpatialWaypoint], metric_map: MemoryMap) -> None:
        """Reach: join ``new`` with the waypoints of its floor that are locally reachable.

        Args:
            new: a waypoint not yet joined.
            others: every earlier waypoint.
            metric_map: m_t, on the floor of ``new``.
        """
        others = [other for other in others if other.floor == new.floor]
        if not others:
            return
        field = metric_map.geodesic_field(new.pose.xy_m)
        xy = np.array([[other.pose.x_m, other.pose.y_m] for other in others])
        for other, length_m in zip(others, field.at(xy), strict=True):
            if length_m > REACH_M:
                continue
            path = field.path_to([other.pose.x_m, other.pose.y_m])
            if len(path) == 0 or _passes_third(path, float(length_m), xy, metric_map):
                continue
            self._put(new, other, EdgeKind.MAP, float(length_m))
            self._paths[_key(new.index, other.index)] = path
        for (a, b), path in list(self._paths.items()):
            length_m = self._edges[a, b, EdgeKind.MAP].length_m
            if new.index not in (a, b) and _passes_third(path, length_m, new.pose.xy_m[None], metric_map):
                del self._paths[a, b], self._edges[a, b, EdgeKind.MAP]  # the way is now two edges
                self._relink(a, b)

    def shortest(self, sources: Mapping[int, float]) -> tuple[dict[int, float], dict[int, int]]:
        """Dijkstra from several waypoints, each with the way to it.

        Returns:
            distance [m] of every waypoint that can be reached, and its predecessor on the way (sources have none).
        """
        distance: dict[int, float] = {}
        previous: dict[int, int] = {}
        queue = [(way, index, -1) for index, way in sources.items()]
        heapq.heapify(queue)
        while queue:
            way, index, before = heapq.heappop(queue)
            if index in distance:
                continue
            distance[index] = way
            if before >= 0:
                previous[index] = before
            for other, length in self._adjacent.get(index, {}).items():
                if other not in distance:
                    heapq.heappush(queue, (way + length, other, index))
        return distance, previous

    def _put(self, a: SpatialWaypoint, b: SpatialWaypoint, kind: EdgeKind, length_m: float) -> None:
        if a.index == b.index:
            return
        straight = a.pose.distance_m(b.pose.x_m, b.pose.y_m)
        low, high = _key(a.index, b.index)
        known = self._edges.get((low, high, kind))
        length = max(length_m if known is None else min(length_m, known.length_m), straight)
        self._edges[low, high, kind] = Edge(low, high, kind, length, a.floor != b.floor)
        self._relink(low, high)

    def _relink(self, a: int, b: int) -> None:
        lengths = [edge.length_m for kind in EdgeKind if (edge := self._edges.get((a, b, kind))) is not None]
        for one, two in ((a, b), (b, a)):
            links = self._adjacent.setdefault(one, {})
            if lengths:
                links[two] = min(lengths)
            else:
                links.pop(two, None)


def _key(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a < b else (b, a)


def _passes_third(path: Float, length_m: float, xy: Float, metric_map: MemoryMap) -> bool:
    """Whether one of the (N, 2) points that is near neither end lies near the path, with no wall between."""
    from_a, from_b = np.hypot(*(xy - path[0]).T), np.hypot(*(xy - path[-1]).T)
    third = xy[(np.minimum(from_a, from_b) > NEAR_PATH_M) & (from_a + from_b <= length_m + 2 * NEAR_PATH_M)]
    if len(third) == 0:
        return False
    nearest = nearest_on_path(path, third)
    near = np.hypot(*(nearest - third).T) <= NEAR_PATH_M
    return any(metric_map.line_of_sight(a, b) for a, b in zip(third[near], nearest[near], strict=True))


def nearest_on_path(path: Float, points: Float) -> Float:
    """The point of a polyline (M, 2) that is nearest to each of the points (N, 2), shape (N, 2)."""
    if len(path) == 1:
        return np.repeat(path, len(points), axis=0)
    start, along = path[:-1], np.diff(path, axis=0)
    offset = points[:, None, :] - start[None]
    share = np.clip((offset * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0.0, 1.0)
    on_path = start + share[..., None] * along
    best = np.argmin(((on_path - points[:, None, :]) ** 2).sum(axis=2), axis=1)
    return np.asarray(on_path[np.arange(len(points)), best])
