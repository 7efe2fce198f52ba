"""The Spatial Waypoint graph G_t: E_t = E_map u E_chain, stored (paper appendix, "Spatial Waypoints and region topology")."""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from spacevln.core import SpatialWaypoint
from spacevln.core.geometry import Float
from spacevln.memory.metric import Field

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
        self._adjacent: dict[int, dict[int, float]] = {}

    @property
    def edges(self) -> tuple[Edge, ...]:
        """Every edge, ordered by ends and kind."""
        return tuple(self._edges[key] for key in sorted(self._edges))

    def neighbours(self, index: int) -> Mapping[int, float]:
        """Adjacent waypoints and the length of the shortest edge to each."""
        return dict(sorted(self._adjacent.get(index, {}).items()))

    def connect_chain(self, a: SpatialWaypoint, b: SpatialWaypoint, length_m: float) -> None:
        """Adj(P): join two consecutive waypoints of the chain; the shortest way walked between them counts."""
        self._put(a, b, EdgeKind.CHAIN, length_m)

    def connect_map(self, new: SpatialWaypoint, others: Sequence[SpatialWaypoint], field: Field) -> None:
        """Reach: join ``new`` with the waypoints of its floor that are locally reachable.

        Args:
            new: a waypoint not yet joined.
            others: every earlier waypoint.
            field: geodesic distances from ``new``.
        """
        others = [other for other in others if other.floor == new.floor]
        if not others:
            return
        xy = np.array([[other.pose.x_m, other.pose.y_m] for other in others])
        for other, length_m in zip(others, field.at(xy), strict=True):
            if length_m > REACH_M:
                continue
            path = field.path_to([other.pose.x_m, other.pose.y_m])
            if len(path) == 0 or _passes_third(path, xy, new, other):
                continue
            self._put(new, other, EdgeKind.MAP, float(length_m))
            self._paths[_key(new.index, other.index)] = path
        self._split(new, {waypoint.index: waypoint for waypoint in others})

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

    def _split(self, new: SpatialWaypoint, by_index: Mapping[int, SpatialWaypoint]) -> None:
        """Drop the local edges whose path the new waypoint lies on: the way is now two edges."""
        joined = {index for index in by_index if (*_key(new.index, index), EdgeKind.MAP) in self._edges}
        for (a, b), path in list(self._paths.items()):
            if a in joined and b in joined and new.index not in (a, b):
                ends = [by_index[a].pose, by_index[b].pose]
                if min(new.pose.distance_m(end.x_m, end.y_m) for end in ends) <= NEAR_PATH_M:
                    continue
                if from_path_m(path, new.pose.xy_m[None])[0] <= NEAR_PATH_M:
                    del self._paths[a, b], self._edges[a, b, EdgeKind.MAP]
                    self._relink(a, b)

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


def _passes_third(path: Float, xy: Float, new: SpatialWaypoint, other: SpatialWaypoint) -> bool:
    """Whether a waypoint that is near neither end lies near the path."""
    near_end = np.minimum(np.hypot(*(xy - new.pose.xy_m).T), np.hypot(*(xy - other.pose.xy_m).T)) <= NEAR_PATH_M
    third = xy[~near_end]
    if len(third) == 0:
        return False
    return bool(from_path_m(path, third).min() <= NEAR_PATH_M)


def from_path_m(path: Float, points: Float) -> Float:
    """Distance of each of the (N, 2) points to a polyline (M, 2) [m], shape (N,)."""
    if len(path) == 1:
        return np.asarray(np.hypot(*(points - path[0]).T))
    start, along = path[:-1], np.diff(path, axis=0)
    offset = points[:, None, :] - start[None]
    share = np.clip((offset * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0.0, 1.0)
    gaps = offset - share[..., None] * along
    return np.asarray(np.hypot(gaps[..., 0], gaps[..., 1]).min(axis=1))
