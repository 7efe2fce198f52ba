"""How true the map of a walked house is, floor by floor."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numba
import numpy as np
from house_truth import FINE_M, FROM_M, TO_M, Truth, VisibleFloor
from house_walks import WalkedHouse, to_episode, to_scene
from scipy import ndimage

from spacevln.core import Observation, Pose, SpatialMap
from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M
from spacevln.mapping import MetricMap
from spacevln.mapping.geodesics import FreeGrid

CELL_M = 0.05
_SPAN_CELLS = 2400  # the house lies within 60 m around the start
_RAYS = 15
LEAST_WAY_M = 2.0


@dataclass(frozen=True)
class Score:
    """Shares of one floor, 1 is best.

    Args:
        precise: obstacle cells within 10 cm of real geometry.
        marked: cells with 3 depth pixels of obstacle height or more that are obstacles.
        free: free cells whose centre is free.
        explored: floor that rays reach that is explored.
        ways: (N,) map distance over true distance with the same inflation, of known ways over 2 m.
        disc_ways: (M,) the same over the true distance of a disc of the body's radius, whatever the cells.
        bracketed: (M,) whether each of these is within 5 % of the true distances of discs half a cell thinner and thicker.
    """

    precise: float
    marked: float
    free: float
    explored: float
    ways: np.ndarray
    disc_ways: np.ndarray
    bracketed: np.ndarray


class Witness:
    """Collects, frame by frame, what the map must know.

    Args:
        walked: the house and the walk.
        rng: picks the rays.
    """

    def __init__(self, walked: WalkedHouse, rng: np.random.Generator) -> None:
        self.walked, self._rng = walked, rng
        self._floors = walked.place.drawable.house.floors
        self._pixels = np.zeros((len(self._floors), _SPAN_CELLS, _SPAN_CELLS), np.uint16)
        self._reached: list[set[tuple[int, int]]] = [set() for _ in self._floors]
        self._visible = VisibleFloor(walked.place)

    def see(self, pose: Pose, observation: Observation) -> None:
        """One frame; frames from stairs prove nothing about a floor."""
        for floor in self._floors:
            if abs(pose.z_m - floor.z_m) < 0.05:
                T, camera = observation.T_world_camera, observation.camera
                intrinsics = np.array([camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px])
                _count(observation.depth_m, T, intrinsics, observation.pose.z_m, self._pixels[floor.index])
                self._cast(floor.index, pose, observation)

    def _cast(self, floor: int, pose: Pose, observation: Observation) -> None:
        ahead, side = self._rng.uniform(0.5, 5.0, _RAYS), self._rng.uniform(-0.82, 0.82, _RAYS)
        c, s = math.cos(observation.pose.yaw_rad), math.sin(observation.pose.yaw_rad)
        points = np.column_stack([ahead, ahead * side]) @ np.array([[c, s], [-s, c]]) + observation.pose.xy_m
        ij = np.floor(points / CELL_M).astype(int)
        there = self._visible.reached(pose, observation.camera, to_scene(self.walked.start, (ij + 0.5) * CELL_M))
        self._reached[floor].update(map(tuple, ij[there].tolist()))

    def score(self, world_map: MetricMap, floor: int) -> Score:
        """The map's floor of the same number against the truth."""
        truth, start, known = self.walked.truths[floor], self.walked.start, world_map.on_floor(floor)
        walked = to_episode(start, np.array([pose.xy_m for pose in self.walked.poses]))
        low, high = np.floor((walked.min(axis=0) - 6) / CELL_M), np.ceil((walked.max(axis=0) + 6) / CELL_M)
        cells = (np.argwhere(np.ones((high - low).astype(int), bool)) + low + 0.5) * CELL_M
        cells = cells[known.is_explored(cells)]
        seen = (np.argwhere(self._pixels[floor] >= 3) - _SPAN_CELLS // 2 + 0.5) * CELL_M
        obstacles, seen, free = (
            self._off_stairs(some) for some in (cells[known.is_obstacle(cells)], seen, cells[known.is_free(cells)])
        )
        places = self._places(floor)
        discs = np.array(list(_disc_ways(known, truth, start, places[:: max(1, len(places) // 8)]))).reshape(-1, 2)
        reached = (np.array(sorted(self._reached[floor])) + 0.5) * CELL_M
        return Score(
            float(np.mean(truth.at(truth.distance_m, to_scene(start, obstacles)) <= 0.10)),
            float(known.is_obstacle(seen).mean()),
            float(1 - truth.at(truth.solid, to_scene(start, free)).mean()),
            float(known.is_explored(reached).mean()),
            np.array(list(_ways(known, same_inflation(truth, start), start, places))),
            discs[:, 0],
            discs[:, 1] != 0,
        )

    def _off_stairs(self, xy_m: np.ndarray) -> np.ndarray:
        """Without the cells on flights, which are no obstacles and have no floor."""
        scene = to_scene(self.walked.start, xy_m)
        on = [
            stairs.rect.contains(*point, -0.05) for point in scene.tolist() for stairs in self.walked.place.drawable.house.stairs
        ]
        return xy_m[~np.array(on, bool).reshape(len(xy_m), -1).any(axis=1)]

    def _places(self, floor: int) -> list[np.ndarray]:
        """Some 16 places along the walk on a floor, scene frame."""
        z_m = self._floors[floor].z_m
        places = [stop.pose.xy_m for stop in self.walked.stops if abs(stop.pose.z_m - z_m) < 0.05]
        return places[:: max(1, len(places) // 16)]


def same_inflation(truth: Truth, start: Pose) -> FreeGrid:
    """Where a body may be by the true geometry, inflated as the map does it: on the map's cells, episode frame.

    A cell is solid when anything in it is; closed is what has the centre of a solid cell nearer than the body's radius.
    """
    extent = np.array(truth.solid.shape) * FINE_M
    corners = to_episode(start, truth.origin_m + np.array([(0, 0), (0, 1), (1, 0), (1, 1)]) * extent)
    low, high = np.floor(corners.min(axis=0) / CELL_M).astype(int), np.ceil(corners.max(axis=0) / CELL_M).astype(int)
    cells = np.argwhere(np.ones(high - low, bool)) + low
    solid = np.zeros(len(cells), bool)
    for part in (np.argwhere(np.ones((5, 5), bool)) + 0.5) / 5:
        solid |= truth.at(truth.solid, to_scene(start, (cells + part) * CELL_M))
    away = ndimage.distance_transform_edt(~solid.reshape(high - low))
    open_cells = (away**2 >= (AGENT_RADIUS_M / CELL_M) ** 2 - 1e-6).astype(np.uint8)
    open_cells[[0, -1]] = open_cells[:, [0, -1]] = 0
    return FreeGrid(int(low[0]), int(low[1]), CELL_M, open_cells)


def _ways(known: SpatialMap, truth: FreeGrid, start: Pose, places: list[np.ndarray]) -> Iterable[float]:
    """Map over true length of the shortest ways that the map knows whole: all pairs of places."""
    points = to_episode(start, np.array(places))
    for k, a in enumerate(points):
        field, found = truth.field(a), known.geodesic_field(a).at(points)
        for b, found_m, true_m in zip(points[:k], found, field.at(points), strict=False):
            way = field.path_to(b)
            if true_m > LEAST_WAY_M and len(way) and known.is_free(_along(way)).all():
                yield found_m / true_m


def _disc_ways(known: SpatialMap, truth: Truth, start: Pose, places: list[np.ndarray]) -> Iterable[tuple[float, bool]]:
    """Map over true length of a disc's ways, and whether discs half a cell thinner and thicker explain the difference."""
    thin, exact, thick = (_open_space(truth, AGENT_RADIUS_M + side * CELL_M / 2) for side in (-1, 0, 1))
    for k, a in enumerate(places):
        fields = [space.field(a - truth.origin_m) for space in (thin, exact, thick)]
        for b in places[:k]:
            way = fields[1].path_to(b - truth.origin_m) + truth.origin_m
            if _length(way) <= LEAST_WAY_M or not known.is_free(to_episode(start, _along(way))).all():
                continue
            found_m = known.geodesic_m(to_episode(start, a[None])[0], to_episode(start, b[None])[0])
            low_m, high_m = (_length(fields[k].path_to(b - truth.origin_m)) for k in (0, 2))
            yield found_m / _length(way), 0.95 * low_m <= found_m <= 1.05 * high_m


def _along(way: np.ndarray) -> np.ndarray:
    """Points every 2 cm on a polyline."""
    legs = [p + np.linspace(0, 1, math.ceil(math.dist(p, q) / 0.02) + 1)[:, None] * (q - p) for p, q in pairwise(way)]
    return np.concatenate(legs)


def _open_space(truth: Truth, radius_m: float) -> FreeGrid:
    """Where a body may be, on cells of 2 cm."""
    rows, columns = (size // 2 for size in truth.distance_m.shape)
    distance = truth.distance_m[: 2 * rows, : 2 * columns].reshape(rows, 2, columns, 2).mean(axis=(1, 3))
    free = (distance >= radius_m).astype(np.uint8)
    free[[0, -1]] = free[:, [0, -1]] = 0
    return FreeGrid(0, 0, 2 * FINE_M, free)


def _length(way: np.ndarray) -> float:
    return float(np.hypot(*np.diff(way, axis=0).T).sum()) if len(way) else math.inf


@numba.njit(cache=True)
def _count(depth_m: np.ndarray, T: np.ndarray, intrinsics: np.ndarray, feet_m: float, pixels: np.ndarray) -> None:
    """Pixels of obstacle height per cell, from the definition of the pinhole camera."""
    half = pixels.shape[0] // 2
    for v in range(depth_m.shape[0]):
        for u in range(depth_m.shape[1]):
            ahead = depth_m[v, u]
            if not 0.5 <= ahead <= 5.0:
                continue
            left = -(u + 0.5 - intrinsics[2]) / intrinsics[0] * ahead
            up = -(v + 0.5 - intrinsics[3]) / intrinsics[1] * ahead
            if not FROM_M <= T[2, 0] * ahead + T[2, 1] * left + T[2, 2] * up + T[2, 3] - feet_m <= TO_M:
                continue
            x = T[0, 0] * ahead + T[0, 1] * left + T[0, 2] * up + T[0, 3]
            y = T[1, 0] * ahead + T[1, 1] * left + T[1, 2] * up + T[1, 3]
            i, j = int(np.floor(x / CELL_M)) + half, int(np.floor(y / CELL_M)) + half
            if 0 <= i < pixels.shape[0] and 0 <= j < pixels.shape[1] and pixels[i, j] < 60000:
                pixels[i, j] += 1
