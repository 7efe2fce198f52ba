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

from spacevln.core import Observation, Pose, SpatialMap
from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M
from spacevln.mapping import MetricMap
from spacevln.mapping.geodesics import FreeGrid

CELL_M = 0.05
_SPAN_CELLS = 2400  # the house lies within 60 m around the start
_RAYS = 15


@dataclass(frozen=True)
class Score:
    """Shares of one floor, 1 is best.

    Args:
        precise: obstacle cells within 10 cm of real geometry.
        marked: cells with 3 depth pixels of obstacle height or more that are obstacles.
        free: free cells whose centre is free.
        explored: floor that rays reach that is explored.
        ways: (N,) map distance over true distance, of known ways over 2 m.
        bracketed: (N,) whether each is within 5 % of the true distances of bodies half a cell thinner and thicker.
    """

    precise: float
    marked: float
    free: float
    explored: float
    ways: np.ndarray
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
        ways = np.array(list(self._ways(known, truth, floor))).reshape(-1, 2)
        reached = (np.array(sorted(self._reached[floor])) + 0.5) * CELL_M
        return Score(
            float(np.mean(truth.at(truth.distance_m, to_scene(start, obstacles)) <= 0.10)),
            float(known.is_obstacle(seen).mean()),
            float(1 - truth.at(truth.solid, to_scene(start, free)).mean()),
            float(known.is_explored(reached).mean()),
            ways[:, 0],
            ways[:, 1] != 0,
        )

    def _off_stairs(self, xy_m: np.ndarray) -> np.ndarray:
        """Without the cells on flights, which are no obstacles and have no floor."""
        scene = to_scene(self.walked.start, xy_m)
        on = [
            stairs.rect.contains(*point, -0.05) for point in scene.tolist() for stairs in self.walked.place.drawable.house.stairs
        ]
        return xy_m[~np.array(on, bool).reshape(len(xy_m), -1).any(axis=1)]

    def _ways(self, known: SpatialMap, truth: Truth, floor: int) -> Iterable[tuple[float, bool]]:
        """Map over true length of the shortest ways that the map knows whole."""
        thin, exact, thick = (_open_space(truth, AGENT_RADIUS_M + side * CELL_M / 2) for side in (-1, 0, 1))
        start, z_m = self.walked.start, self._floors[floor].z_m
        places = [stop.pose.xy_m for stop in self.walked.stops if abs(stop.pose.z_m - z_m) < 0.05]
        places = places[:: max(1, len(places) // 12)]
        for a in places[::3]:
            fields = [space.field(a - truth.origin_m) for space in (thin, exact, thick)]
            for b in places:
                way = fields[1].path_to(b - truth.origin_m) + truth.origin_m
                if math.dist(a, b) < 2.0 or len(way) < 2:
                    continue
                dense = np.concatenate([p + np.linspace(0, 1, 50)[:, None] * (q - p) for p, q in pairwise(way)])
                if known.is_free(to_episode(start, dense)).all():
                    found = known.geodesic_m(to_episode(start, a[None])[0], to_episode(start, b[None])[0])
                    low, high = (_length(fields[k].path_to(b - truth.origin_m)) for k in (0, 2))
                    yield found / _length(way), 0.95 * low <= found <= 1.05 * high


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
            d = depth_m[v, u]
            if not 0.5 <= d <= 5.0:
                continue
            local = np.array([d, -(u + 0.5 - intrinsics[2]) / intrinsics[0] * d, -(v + 0.5 - intrinsics[3]) / intrinsics[1] * d])
            z = T[2, 0] * local[0] + T[2, 1] * local[1] + T[2, 2] * local[2] + T[2, 3] - feet_m
            if not FROM_M <= z <= TO_M:
                continue
            x = T[0, 0] * local[0] + T[0, 1] * local[1] + T[0, 2] * local[2] + T[0, 3]
            y = T[1, 0] * local[0] + T[1, 1] * local[1] + T[1, 2] * local[2] + T[1, 3]
            i, j = int(np.floor(x / CELL_M)) + half, int(np.floor(y / CELL_M)) + half
            if 0 <= i < pixels.shape[0] and 0 <= j < pixels.shape[1] and pixels[i, j] < 60000:
                pixels[i, j] += 1
