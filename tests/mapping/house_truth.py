"""What really stands and lies in a house, from its triangles and from rays through them; nothing here knows the map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numba
import numpy as np
from scipy import ndimage

from spacevln.core import Camera, Pose
from spacevln.environments.houses.environment import Place
from spacevln.environments.houses.ground.footprints import wall_shapes
from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M
from spacevln.environments.houses.rendering.triangles import triangles_of

FINE_M = 0.01
FROM_M, TO_M = 0.15, 1.30


@dataclass(frozen=True)
class Truth:
    """What stands 0.15 to 1.30 m over one floor, on cells of 1 cm (scene frame).

    Args:
        origin_m: corner of cell (0, 0).
        solid: a surface, a wall, or what is closed in by them.
        distance_m: from a cell's centre to the nearest solid cell's.
    """

    origin_m: np.ndarray
    solid: np.ndarray
    distance_m: np.ndarray

    def at(self, grid: np.ndarray, xy_m: np.ndarray) -> np.ndarray:
        ij = np.clip(np.floor((xy_m - self.origin_m) / FINE_M).astype(int), 0, np.array(grid.shape) - 1)
        return grid[ij[:, 0], ij[:, 1]]


def truth_of(place: Place, floor: int) -> Truth:
    """Surfaces from every triangle, walls from the plan, and what these enclose so that no way leads in."""
    soup = triangles_of(place.drawable.model, place.drawable.geom_instance)
    corners = np.ascontiguousarray(soup.vertices["position"], np.float64)[soup.indices.reshape(-1, 3)]
    z_m, space = place.drawable.house.floors[floor].z_m, place.ground.floors[floor]
    origin_m = np.array(space.origin_m) - 0.5
    shape = np.ceil((np.array(space.clearance_m.shape) * 0.05 + 1.0) / FINE_M).astype(int)
    marked = np.zeros(shape, np.uint8)
    _mark_surfaces(corners - np.array([*origin_m, z_m]), marked, FINE_M, FROM_M, TO_M)
    for x, y, _, _, half_x, half_y in wall_shapes(place.drawable.house, floor):
        low, high = (np.array([x, y]) + side * np.array([half_x, half_y]) - origin_m for side in (-1, 1))
        (i0, j0), (i1, j1) = np.ceil(low / FINE_M - 0.5).astype(int), np.ceil(high / FINE_M - 0.5).astype(int)
        marked[i0:i1, j0:j1] = 1
    parts, _ = ndimage.label(marked == 0)
    standing = space.centre(0, 0) + np.argwhere(space.clearance_m >= AGENT_RADIUS_M) * 0.05
    i, j = np.floor((standing - origin_m) / FINE_M).astype(int).T
    solid = (marked != 0) | ~np.isin(parts, np.setdiff1d(parts[i, j], [0]))
    return Truth(origin_m, solid, ndimage.distance_transform_edt(~solid) * FINE_M)


@numba.njit(cache=True)
def _mark_surfaces(triangles: np.ndarray, solid: np.ndarray, cell_m: float, low_m: float, high_m: float) -> None:
    """Cut every triangle at heights 1 cm apart (catches steep ones) and look down on it (catches flat ones)."""
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        low, high = max(low_m, min(a[2], b[2], c[2])), min(high_m, max(a[2], b[2], c[2]))
        if low > high:
            continue
        for k in range(int(np.ceil(low / cell_m)), int(np.floor(high / cell_m)) + 1):
            _mark_cut(a, b, c, k * cell_m, solid, cell_m)
        _mark_cut(a, b, c, low, solid, cell_m)
        _mark_from_above(a, b, c, solid, cell_m, low_m, high_m)


@numba.njit(cache=True)
def _mark_cut(a: np.ndarray, b: np.ndarray, c: np.ndarray, z: float, solid: np.ndarray, cell_m: float) -> None:
    ends, found = np.empty((3, 2)), 0
    for p, q in ((a, b), (b, c), (c, a)):
        if p[2] != q[2] and min(p[2], q[2]) <= z <= max(p[2], q[2]):
            s = (z - p[2]) / (q[2] - p[2])
            ends[found, 0], ends[found, 1] = p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])
            found += 1
    for k in range(1, found):
        n = int(np.hypot(ends[k, 0] - ends[0, 0], ends[k, 1] - ends[0, 1]) / (0.5 * cell_m)) + 1
        for m in range(n + 1):
            i = int(np.floor((ends[0, 0] + (ends[k, 0] - ends[0, 0]) * m / n) / cell_m))
            j = int(np.floor((ends[0, 1] + (ends[k, 1] - ends[0, 1]) * m / n) / cell_m))
            if 0 <= i < solid.shape[0] and 0 <= j < solid.shape[1]:
                solid[i, j] = 1


@numba.njit(cache=True)
def _mark_from_above(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, solid: np.ndarray, cell_m: float, low_m: float, high_m: float
) -> None:
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if abs(area) < 1e-10:
        return
    for i in range(max(0, int(min(a[0], b[0], c[0]) / cell_m)), min(solid.shape[0], int(max(a[0], b[0], c[0]) / cell_m) + 1)):
        for j in range(max(0, int(min(a[1], b[1], c[1]) / cell_m)), min(solid.shape[1], int(max(a[1], b[1], c[1]) / cell_m) + 1)):
            x, y = (i + 0.5) * cell_m - a[0], (j + 0.5) * cell_m - a[1]
            v, w = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area, ((b[0] - a[0]) * y - (b[1] - a[1]) * x) / area
            if v >= 0 and w >= 0 and v + w <= 1 and low_m <= a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2]) <= high_m:
                solid[i, j] = 1


class VisibleFloor:
    """Which floor points rays from the camera reach in the simulator's own geometry.

    Args:
        place: the house.
    """

    def __init__(self, place: Place) -> None:
        self._model = place.drawable.model
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self._geom = np.zeros(1, np.int32)

    def reached(self, pose: Pose, camera: Camera, points: np.ndarray) -> np.ndarray:
        """Whether each of the points (N, 2) lies inside the image, 0.5 to 5.0 m ahead, and a ray reaches its floor, all scene."""
        c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        ahead, left = (points - pose.xy_m) @ (c, s), (points - pose.xy_m) @ (-s, c)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = camera.cx_px - camera.fx_px * left / ahead
            v = camera.cy_px + camera.fy_px * camera.height_m / ahead
        inside = (ahead >= 0.5) & (ahead <= 5.0) & (u >= 0) & (u < camera.width_px) & (v < camera.height_px)
        origin = pose.position_m + np.array([0, 0, camera.height_m])
        return np.array(
            [
                bool(within) and self._reaches(origin, np.array([x, y, pose.z_m]))
                for within, (x, y) in zip(inside, points, strict=True)
            ]
        )

    def _reaches(self, origin: np.ndarray, floor_point: np.ndarray) -> bool:
        ray = floor_point - origin
        share = mujoco.mj_ray(self._model, self._data, origin, ray, None, 1, -1, self._geom)
        return bool(abs(share - 1) * np.linalg.norm(ray) <= 0.02)
