"""What the guard knows of the floor around the body: where something stands, and where nothing was ever seen.

A level camera sees neither low things nor the floor nearer than a metre. What it saw of them from farther away is kept, in the
fixed frame, on a grid that rolls along with the body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float, Pose, transform_points
from spacevln.environments.robot.messages import CameraInfo
from spacevln.environments.robot.profile import Limits

CELL_M = 0.05
RANGE_M = 3.0
GONE_S = 1.0
"""After so long it is forgotten what is tall enough to be seen, and is not, though the camera looks there."""
AHEAD_M = 0.8
"""How far ahead unseen floor matters: more than it takes to slow down."""
_CELLS = 2 * round(RANGE_M / CELL_M) + 20
_SPARE = 8  # cells that the body may move before the grid rolls
_ROWS = 120  # image rows that are looked at, and half as many columns: as dense as the cells at two metres
_POINTS = 3  # of something in a cell, to count
_DOUBTS = 3  # images that show floor where something stood
_EDGE_PX = 4
_NEVER = -1e9


def kept_free_m(limits: Limits) -> float:
    """Radius of the disc around the base in which the centre of no occupied cell may lie."""
    return limits.body_radius_m + CELL_M / 2


@dataclass(slots=True, eq=False)
class _Grid:
    """(N, N) per cell; ``origin`` is the number of the cell at its corner.

    ``seen_s`` when something was seen there, ``low`` whether it is too low to be seen when near, ``doubts`` how many images
    showed floor there since, ``floor`` whether floor was seen or the body stood there.
    """

    origin: NDArray[np.int64]
    seen_s: Float = field(default_factory=lambda: np.full((_CELLS, _CELLS), _NEVER))
    low: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((_CELLS, _CELLS), np.bool_))
    doubts: NDArray[np.int64] = field(default_factory=lambda: np.zeros((_CELLS, _CELLS), np.int64))
    floor: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((_CELLS, _CELLS), np.bool_))

    def rolled(self, origin: NDArray[np.int64]) -> _Grid:
        """The same cells in a grid with another corner; what leaves it is forgotten."""
        grid, (di, dj) = _Grid(origin), (origin - self.origin).tolist()
        if max(abs(di), abs(dj)) >= _CELLS:
            return grid
        here = np.s_[max(0, -di) : _CELLS - max(0, di), max(0, -dj) : _CELLS - max(0, dj)]
        there = np.s_[max(0, di) : _CELLS - max(0, -di), max(0, dj) : _CELLS - max(0, -dj)]
        for new, old in ((grid.seen_s, self.seen_s), (grid.low, self.low), (grid.doubts, self.doubts), (grid.floor, self.floor)):
            new[here] = old[there]
        return grid


class Surroundings:
    """Obstacles and seen floor around the body.

    Args:
        limits: size of the body and what counts as floor.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._grid: _Grid | None = None
        self._solid: Float = np.zeros((0, 2))
        self._stood: tuple[int, int] | None = None
        self.valid_share = 0.0

    def stand(self, pose: Pose) -> None:
        """The body is here: there is floor beneath it."""
        cell = math.floor(pose.x_m / CELL_M), math.floor(pose.y_m / CELL_M)
        if cell == self._stood:
            return
        self._stood, grid = cell, self._around(pose)
        reach = math.ceil(self._limits.body_radius_m / CELL_M)
        i, j = (np.array(cell) - grid.origin).tolist()
        window = np.s_[i - reach : i + reach + 1, j - reach : j + reach + 1]
        di, dj = np.indices((2 * reach + 1, 2 * reach + 1)) - reach
        grid.floor[window] |= np.hypot(di, dj) * CELL_M <= self._limits.body_radius_m

    def see(self, depth_m: NDArray[np.float32], info: CameraInfo, T_base_camera: Float, pose: Pose, now_s: float) -> None:
        """Take a depth image.

        Args:
            depth_m: (H, W), 0 for no measurement, not rectified: wide angles do not matter for stopping.
            info: its intrinsics.
            T_base_camera: (4, 4), our camera frame in the body.
            pose: of the body when it was taken, fixed frame.
            now_s: steady time.
        """
        step = max(1, info.height // _ROWS)
        rows, columns = np.mgrid[step // 2 : info.height : step, step : info.width : 2 * step]
        depth = depth_m[rows, columns].astype(np.float64)
        measured = depth > 0
        self.valid_share = float(measured.mean())
        near = measured & (depth < RANGE_M)
        ahead = depth[near]
        left = -(columns[near] - info.k[2]) / info.k[0] * ahead
        up = -(rows[near] - info.k[5]) / info.k[4] * ahead
        points = transform_points(T_base_camera, np.stack([ahead, left, up], axis=-1))
        grid, xy_m = self._around(pose), transform_points(pose.T_world_body, points)[:, :2]
        self._take(grid, xy_m, points[:, 2], self._lowest_m(info, T_base_camera), now_s)
        self._forget(grid, info, pose.T_world_body @ T_base_camera, now_s)
        self._solid = np.asarray((np.argwhere(grid.seen_s > _NEVER) + grid.origin + 0.5) * CELL_M, np.float64)

    def free_m(self, pose: Pose) -> float:
        """How far the body's disc can move ahead before it touches something known, less ``stop_m``; at most 3 m, at least 0."""
        contact_m = self._contact_m(self._solid, pose, RANGE_M + self._limits.stop_m)
        return max(0.0, contact_m - self._limits.stop_m)

    def seen_m(self, pose: Pose) -> float:
        """How far the body's disc can move ahead on floor that was seen; at most 0.8 m, at least 0."""
        grid, reach = self._around(pose), math.ceil((AHEAD_M + self._limits.body_radius_m) / CELL_M)
        low = np.floor(pose.xy_m / CELL_M).astype(np.int64) - grid.origin - reach
        i, j = np.maximum(low, 0).tolist()
        side = 2 * reach + 1
        unseen: NDArray[np.int64] = np.argwhere(~grid.floor[i : i + side, j : j + side])
        return max(0.0, self._contact_m((unseen + (i, j) + grid.origin + 0.5) * CELL_M, pose, AHEAD_M))

    def _contact_m(self, centres: Float, pose: Pose, most_m: float) -> float:
        """Way ahead until the disc touches the first of some cells, at most ``most_m``."""
        d = centres - pose.xy_m
        c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        x, y = c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1]
        radius = kept_free_m(self._limits)
        hit = (np.abs(y) < radius) & (x > 0)
        contact: Float = x[hit] - np.sqrt(radius**2 - y[hit] ** 2)
        return min(most_m, float(contact.min(initial=most_m)))

    def _lowest_m(self, info: CameraInfo, T_base_camera: Float) -> float:
        """Height of the lowest thing that the camera still sees right before the body."""
        ray = T_base_camera[:3, :3] @ np.array([1.0, 0.0, -(info.height - info.k[5]) / info.k[4]])
        reach_m = self._limits.body_radius_m + self._limits.stop_m - float(T_base_camera[0, 3])
        return float(T_base_camera[2, 3] + reach_m * ray[2] / max(1e-6, ray[0]))

    def _take(self, grid: _Grid, xy_m: Float, heights_m: Float, lowest_m: float, now_s: float) -> None:
        """Enter points: fixed frame, and heights over the floor."""
        ij = np.floor(xy_m / CELL_M).astype(np.int64) - grid.origin
        within = ((ij >= 0) & (ij < _CELLS)).all(axis=1)
        ij, heights_m = ij[within], heights_m[within]
        stands = (heights_m > self._limits.floor_m) & (heights_m < self._limits.body_height_m)
        lies = np.abs(heights_m) <= self._limits.floor_m
        counts = np.bincount(ij[stands] @ (_CELLS, 1), minlength=_CELLS**2).reshape(_CELLS, _CELLS)
        tops: Float = np.zeros((_CELLS, _CELLS))
        np.maximum.at(tops, tuple(ij[stands].T), heights_m[stands])
        solid, floor = counts >= _POINTS, np.zeros((_CELLS, _CELLS), np.bool_)
        floor[tuple(ij[lies].T)] = True
        grid.floor |= _grown(floor)  # rows of the image are farther apart than cells
        grid.doubts[floor & ~solid] += 1
        grid.seen_s[solid], grid.low[solid], grid.doubts[solid] = now_s, tops[solid] < lowest_m, 0

    def _forget(self, grid: _Grid, info: CameraInfo, T_fixed_camera: Float, now_s: float) -> None:
        """What is not there any more: floor was seen in its place, or it should be seen and is not."""
        grid.seen_s[grid.doubts >= _DOUBTS] = _NEVER
        tall = np.argwhere(~grid.low & (grid.seen_s > _NEVER) & (now_s - grid.seen_s > GONE_S))
        d = (tall + grid.origin + 0.5) * CELL_M - T_fixed_camera[:2, 3]
        ahead, left = d @ T_fixed_camera[:2, 0], d @ T_fixed_camera[:2, 1]
        nearest_m = self._limits.body_radius_m + self._limits.stop_m
        looked = (ahead > nearest_m) & (ahead < RANGE_M - CELL_M)
        looked &= (left * info.k[0] < (info.k[2] - _EDGE_PX) * ahead) & (
            -left * info.k[0] < (info.width - info.k[2] - _EDGE_PX) * ahead
        )
        grid.seen_s[tuple(tall[looked].T)] = _NEVER

    def _around(self, pose: Pose) -> _Grid:
        """The grid, with the body near its middle."""
        wanted = np.floor(pose.xy_m / CELL_M).astype(np.int64) - _CELLS // 2
        if self._grid is None:
            self._grid = _Grid(wanted)
        elif np.abs(wanted - self._grid.origin).max() > _SPARE:
            self._grid = self._grid.rolled(wanted)
        return self._grid


def _grown(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """With the neighbours, four at a time."""
    grown = cells.copy()
    grown[1:] |= cells[:-1]
    grown[:-1] |= cells[1:]
    wide = grown.copy()
    wide[:, 1:] |= grown[:, :-1]
    wide[:, :-1] |= grown[:, 1:]
    return wide
