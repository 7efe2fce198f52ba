"""Regions: waypoints of one type whose metric supports agree (paper appendix, "Spatial Waypoints and region topology").

The support of a waypoint is the free floor in line of sight of it, up to 3 m away and not beyond a threshold (a doorway or
opening that was seen). Waypoints of one type join when their supports overlap, or when they see each other within 5 m;
thresholds, and connectors between them, keep them apart.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from spacevln.core import Pose, SpatialWaypoint
from spacevln.memory.metric import MemoryMap
from spacevln.memory.thresholds import Threshold, Thresholds, crossing_m

CELL_M = 0.1
UNKNOWN_PLACE = "unknown place"  # type of what the planner gave no name
SUPPORT_RADIUS_M = 3.0  # [ours; authors' code 2 m]
SEED_RADIUS_M = 0.5  # the floor around a waypoint always belongs to it
GROWTH_M = 1.0  # into floor that furniture hides from the waypoint itself
MIN_OVERLAP = 0.1  # of the smaller support
JOIN_DISTANCE_M = 5.0  # [authors' code]
_RAYS = 200
_STEP_M = 0.05
REFRESH_M = 8.0  # waypoints this near to the newest may see more than before
_COMPLETE_SHARE = 0.03  # of the rays that may end in the unknown
_UNKNOWN_GAP_M = 0.3  # a ray may cross this much unseen floor

_ANGLES = np.arange(_RAYS) * (math.tau / _RAYS)
_DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)
_CROP_M = 2 * SUPPORT_RADIUS_M + 0.2
_RANGES = np.arange(1, round(SUPPORT_RADIUS_M / _STEP_M) + 1) * _STEP_M
_OFFSET = 1 << 30

Cells = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Region:
    """A space: one or several waypoints of the same type that share their floor.

    Args:
        label: type and number, ``"bedroom 2"``; stays with the region while it grows.
        type: normalised region type or free text.
        floor: storey.
        waypoints: member indices, ascending.
    """

    label: str
    type: str
    floor: int
    waypoints: tuple[int, ...]


def cells_of(xy_m: NDArray[np.float64]) -> Cells:
    """Sorted unique keys of the 0.1 m cells that hold the (N, 2) points."""
    ij = np.floor(xy_m / CELL_M).astype(np.int64)
    return np.unique((ij[:, 0] + _OFFSET) << 32 | (ij[:, 1] + _OFFSET))


@njit(cache=True)
def cell_of(key: int) -> tuple[int, int]:  # pragma: no cover - compiled
    """Indices i and j of a cell's key."""
    return (key >> 32) - _OFFSET, (key & 0xFFFFFFFF) - _OFFSET


@dataclass(frozen=True, slots=True, eq=False)
class Support:
    """The free floor seen from a waypoint.

    Args:
        cells: keys of its 0.1 m cells, sorted.
        complete: nothing unseen ended the sight; more exploring will not change it.
        thresholds: numbers of those believed when it was seen.
    """

    cells: Cells
    complete: bool
    thresholds: tuple[int, ...]


def support(pose: Pose, metric_map: MemoryMap, known: Thresholds) -> Support:
    """What can be seen of the free floor from a pose, as far as walls, thresholds and 3 m, and the floor right beside it."""
    thresholds = known.on(metric_map.floor)
    crop = metric_map.crop(pose.xy_m, _CROP_M, 0.0)
    rows, columns = _ray_pixels(len(crop.free))
    free, wall = crop.free[rows, columns], crop.obstacle[rows, columns] & (_RANGES > 2 * CELL_M)
    seed = _RANGES <= SEED_RADIUS_M
    near = crossing_m(pose.xy_m, _DIRECTIONS, thresholds)[:, None] > _RANGES
    sight = near & (np.cumsum(wall, axis=1) == 0)
    in_view = np.cumsum(~free & ~seed, axis=1) * _STEP_M <= _UNKNOWN_GAP_M
    hidden = (sight & ~in_view).any(axis=1)
    seen = np.zeros(crop.free.shape, np.uint8)
    inside = sight & in_view & (free | seed)
    seen[rows[inside], columns[inside]] = 1
    pixels = np.argwhere(_grown(seen, crop.free, pose, thresholds))
    middle, cell_m = (len(seen) - 1) / 2, _CROP_M / len(seen)
    return Support(
        cells_of(pose.xy_m + (middle - pixels) * cell_m), bool(hidden.mean() <= _COMPLETE_SHARE), known.believed(metric_map.floor)
    )


def _grown(seen: NDArray[np.uint8], free: NDArray[np.bool_], pose: Pose, thresholds: Sequence[Threshold]) -> NDArray[np.uint8]:
    """Spread over free floor into the shadows of things, up to 1 m, never across a threshold."""
    per_metre = len(seen) / _CROP_M
    open_floor = free.astype(np.uint8) | seen
    for threshold in thresholds:
        ends = (len(seen) - 1) / 2 - (np.array([threshold.a_m, threshold.b_m]) - pose.xy_m) * per_metre
        if np.abs(ends - len(seen) / 2).max() < len(seen):
            (v0, u0), (v1, u1) = np.rint(ends).astype(int).tolist()
            cv2.line(open_floor, (u0, v0), (u1, v1), 0, 3)
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    grown = seen.astype(np.uint8)
    for _ in range(round(GROWTH_M * per_metre)):
        grown = np.asarray(cv2.bitwise_and(cv2.dilate(grown, cross), open_floor), np.uint8)
    return grown


@lru_cache(maxsize=4)
def _ray_pixels(side: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row and column of each step of each ray in a crop of ``side`` pixels whose upper edge lies along +x."""
    middle, per_metre = (side - 1) / 2, side / _CROP_M
    along = _DIRECTIONS[:, None, :] * _RANGES[None, :, None] * per_metre
    rows, columns = np.rint(middle - along[..., 0]), np.rint(middle - along[..., 1])
    return rows.astype(np.int64), columns.astype(np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class RegionsState:
    """All that :class:`Regions` holds between two waypoints.

    Args:
        supports: by waypoint.
        joined: whether two waypoints of one type stand in one space, for the pairs that were looked at.
        regions: in the order of their first waypoints.
    """

    supports: tuple[Support, ...]
    joined: Mapping[tuple[int, int], bool]
    regions: tuple[Region, ...]


class Regions:
    """Which waypoint belongs to which region. Follows the waypoints as they come; labels are stable."""

    def __init__(self) -> None:
        self.version = 0
        self._supports: list[Support] = []
        self._numbers: list[int] = []  # number in the label, by waypoint
        self._joined: dict[tuple[int, int], bool] = {}
        self._regions: tuple[Region, ...] = ()
        self._of: list[int] = []  # index into _regions, by waypoint

    @classmethod
    def restored(cls, state: RegionsState) -> Regions:
        """Inverse of :attr:`state`."""
        regions = cls()
        regions.version = 1
        regions._supports, regions._joined = list(state.supports), dict(state.joined)
        regions._regions = state.regions
        of = {index: k for k, region in enumerate(state.regions) for index in region.waypoints}
        regions._of = [of[index] for index in range(len(state.supports))]
        regions._numbers = regions._numbers_now()
        return regions

    @property
    def state(self) -> RegionsState:
        """What a saved memory keeps."""
        return RegionsState(tuple(self._supports), dict(sorted(self._joined.items())), self._regions)

    @property
    def all(self) -> tuple[Region, ...]:
        """Every region, in the order of its first waypoint."""
        return self._regions

    def of(self, waypoint: int) -> Region:
        """The region of a waypoint."""
        return self._regions[self._of[waypoint]]

    def support_of(self, waypoint: int) -> Cells:
        """The cells of a waypoint."""
        return self._supports[waypoint].cells

    def update(self, waypoints: Sequence[SpatialWaypoint], metric_map: MemoryMap, thresholds: Thresholds) -> None:
        """Take in new waypoints, and look again from those of the current floor that had not seen everything.

        Args:
            waypoints: all of them.
            metric_map: of the current floor, on which every new waypoint lies.
            thresholds: seen so far.
        """
        believed = thresholds.believed(metric_map.floor)
        latest = waypoints[-1].pose
        changed = set()
        for waypoint in waypoints:
            new = waypoint.index >= len(self._supports)
            if not new:
                old = self._supports[waypoint.index]
                near = waypoint.pose.distance_m(latest.x_m, latest.y_m) <= REFRESH_M
                if waypoint.floor != metric_map.floor or not near or (old.complete and old.thresholds == believed):
                    continue
            seen = support(waypoint.pose, metric_map, thresholds)
            changed.add(waypoint.index)
            if new:
                self._supports.append(seen)
            else:
                self._supports[waypoint.index] = seen
        self._joined = {pair: joined for pair, joined in self._joined.items() if not changed.intersection(pair)}
        self._rebuild(waypoints, metric_map, thresholds)
        self.version += 1

    def at(self, xy_m: NDArray[np.float64], floor: int, waypoints: Sequence[SpatialWaypoint]) -> Region | None:
        """The region that a point lies in: that of the nearest waypoint whose support holds it."""
        key = cells_of(np.asarray(xy_m, np.float64)[None])[0]
        best: tuple[float, int] | None = None
        for waypoint in waypoints:
            cells = self._supports[waypoint.index].cells
            slot = np.searchsorted(cells, key)
            if waypoint.floor == floor and slot < len(cells) and cells[slot] == key:
                candidate = (waypoint.pose.distance_m(float(xy_m[0]), float(xy_m[1])), waypoint.index)
                best = candidate if best is None else min(best, candidate)
        return None if best is None else self.of(best[1])

    def _agree(self, a: SpatialWaypoint, b: SpatialWaypoint, metric_map: MemoryMap, thresholds: Thresholds) -> bool:
        """Whether two waypoints of one type stand in one space."""
        if thresholds.between(a.floor, a.pose.xy_m, b.pose.xy_m):
            return False
        way = metric_map.path(a.pose.xy_m, b.pose.xy_m)
        if any(thresholds.between(a.floor, p, q) for p, q in pairwise(way)):
            return False  # their floors meet outside, as before two doors side by side
        one, two = self._supports[a.index].cells, self._supports[b.index].cells
        shared = len(np.intersect1d(one, two, assume_unique=True))
        if shared >= MIN_OVERLAP * min(len(one), len(two)):
            return True
        near = a.pose.distance_m(b.pose.x_m, b.pose.y_m) <= JOIN_DISTANCE_M
        return near and metric_map.line_of_sight(a.pose.xy_m, b.pose.xy_m)

    def _rebuild(self, waypoints: Sequence[SpatialWaypoint], metric_map: MemoryMap, thresholds: Thresholds) -> None:
        """Join what agrees, near pairs first; pairs that are joined already need no look."""
        parent = list(range(len(waypoints)))

        def root(index: int) -> int:
            while parent[index] != index:
                index = parent[index]
            return index

        for a, b in _near_pairs(waypoints):
            low, high = sorted((root(a), root(b)))
            if low == high:
                continue
            if (a, b) not in self._joined:
                if waypoints[a].floor != metric_map.floor:
                    continue
                self._joined[a, b] = self._agree(waypoints[a], waypoints[b], metric_map, thresholds)
            if self._joined[a, b]:
                parent[high] = low
        groups: dict[int, list[int]] = {}
        for index in range(len(waypoints)):
            groups.setdefault(root(index), []).append(index)
        self._label(waypoints, list(groups.values()))

    def _label(self, waypoints: Sequence[SpatialWaypoint], groups: list[list[int]]) -> None:
        """Number the regions of each type; a region keeps the lowest number its waypoints ever had."""
        taken: dict[str, set[int]] = {}
        regions: list[Region] = []
        self._of = [0] * len(waypoints)
        for members in groups:
            kind = _type_of(waypoints[members[0]])
            used = taken.setdefault(kind, set())
            had = [self._numbers[index] for index in members if index < len(self._numbers)]
            number = min((n for n in had if n not in used), default=0)
            if not number:
                reserved = used | {n for index, n in enumerate(self._numbers) if _type_of(waypoints[index]) == kind}
                number = next(n for n in range(1, len(waypoints) + 2) if n not in reserved)
            used.add(number)
            for index in members:
                self._of[index] = len(regions)
            regions.append(Region(f"{kind} {number}", kind, waypoints[members[0]].floor, tuple(members)))
        self._regions = tuple(regions)
        self._numbers = self._numbers_now()

    def _numbers_now(self) -> list[int]:
        return [int(self.of(index).label.rsplit(" ", 1)[1]) for index in range(len(self._of))]


def _type_of(waypoint: SpatialWaypoint) -> str:
    return waypoint.region or UNKNOWN_PLACE


def _near_pairs(waypoints: Sequence[SpatialWaypoint]) -> list[tuple[int, int]]:
    """Pairs of one type and floor whose supports could touch, nearest first."""
    groups: dict[tuple[str, int], list[int]] = {}
    for waypoint in waypoints:
        groups.setdefault((waypoint.region, waypoint.floor), []).append(waypoint.index)
    pairs: list[tuple[float, int, int]] = []
    for _, members in sorted(groups.items()):
        xy = np.array([[waypoints[index].pose.x_m, waypoints[index].pose.y_m] for index in members])
        gaps = np.hypot(xy[:, None, 0] - xy[None, :, 0], xy[:, None, 1] - xy[None, :, 1])
        near_a, near_b = np.nonzero(np.triu(gaps <= 2 * SUPPORT_RADIUS_M, 1))
        pairs.extend((float(gaps[a, b]), members[a], members[b]) for a, b in zip(near_a, near_b, strict=True))
    return [(a, b) for _, a, b in sorted(pairs)]
