"""Obstacle distance in a direction, from the map and from the depth image of the moment.

Distances are measured from the agent's centre to the nearest surface that the body, a disc, would touch when it moved in that
direction: a corridor as wide as the body is looked along, not a single ray.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from spacevln.core import Observation, Pose
from spacevln.mapping.cells import (
    DEPTH_FROM_M,
    DEPTH_TO_M,
    GROUND_BIN,
    HEIGHT_BIN_M,
    OBSTACLE_FROM_M,
    OBSTACLE_TO_M,
    STAIR,
)
from spacevln.mapping.floors import ON_STAIRS_M, Floor
from spacevln.mapping.incline import Incline
from spacevln.mapping.projection import camera_view
from spacevln.mapping.settling import TREAD_TOP_BIN

MAP_REACH_M = 2.0  # farther, the map is not asked
DEPTH_REACH_M = DEPTH_TO_M
NEAR_CLIP_M = 0.49  # reported when the sector is closer than the camera can measure
_NEAR_SLACK_M = 0.03
_NEAR_SHARE = 0.18
_NEAR_SAMPLES = 6
_NEAR_HALF_RAD = math.radians(5.0)
_NEAR_ROWS = (0.38, 0.92)
_STRIDE_PX = 3
_BIN_M = 0.025
_MIN_SAMPLES = 3
_BINS = 320


def body_distances_m(
    floor: Floor,
    observation: Observation,
    bearings_rad: tuple[float, ...],
    agent_radius_m: float,
    resolution_m: float,
    incline: Incline | None = None,
) -> tuple[float, ...]:
    """See :meth:`spacevln.mapping.MetricMap.sector_distance_m`, for several directions."""
    pose = observation.pose
    directions = [(math.cos(pose.yaw_rad + bearing), math.sin(pose.yaw_rad + bearing)) for bearing in bearings_rad]
    view = camera_view(observation, pose.x_m, pose.y_m)
    depth_m = np.ascontiguousarray(observation.depth_m, np.float32)
    treads = _treads(floor, pose, resolution_m, incline)
    seen_m = [depth_distance_m(depth_m, view, direction, agent_radius_m, treads) for direction in directions]
    if abs(pose.z_m - floor.z_m) > ON_STAIRS_M:
        map_m = [DEPTH_REACH_M for _ in directions]  # what stands on the floor left behind is over or under the agent
    else:
        map_m = _map_distances_m(floor, pose, directions, agent_radius_m, resolution_m, incline)
    return tuple(float(min(DEPTH_REACH_M, known, seen)) for known, seen in zip(map_m, seen_m, strict=True))


def _map_distances_m(
    floor: Floor,
    pose: Pose,
    directions: list[tuple[float, float]],
    agent_radius_m: float,
    resolution_m: float,
    incline: Incline | None,
) -> list[float]:
    """What the map tells, up to ``MAP_REACH_M``; inf beyond."""
    reach = math.ceil(MAP_REACH_M / resolution_m) + 1
    i0, j0 = math.floor(pose.x_m / resolution_m) - reach, math.floor(pose.y_m / resolution_m) - reach
    solid = floor.solid.window(i0, j0, 2 * reach, 2 * reach)
    if incline is not None:
        solid = np.where(np.isnan(_over_cells(incline, i0, j0, 2 * reach, resolution_m)), solid, 0).astype(np.uint8)
    body = agent_radius_m / resolution_m
    at_i, at_j, most = pose.x_m / resolution_m - i0, pose.y_m / resolution_m - j0, MAP_REACH_M / resolution_m
    return [resolution_m * map_distance_cells(solid, at_i, at_j, c, s, body, body, most) for c, s in directions]


def _over_cells(incline: Incline, i0: int, j0: int, cells: int, resolution_m: float) -> NDArray[np.float64]:
    """Height of an incline over the cells of a square window [m]; NaN beside it."""
    along = np.asarray((np.arange(cells) + 0.5) * resolution_m, np.float64)
    return incline.heights_m((i0 * resolution_m + along)[:, None], (j0 * resolution_m + along)[None, :])


def _treads(
    floor: Floor, pose: Pose, resolution_m: float, incline: Incline | None
) -> tuple[NDArray[np.uint8], NDArray[np.int8], int, float]:
    """Windows of flags and tread heights around the agent; empty while no stairs are known."""
    if not floor.ground.tiles and incline is None:
        return np.zeros((0, 0), np.uint8), np.zeros((0, 0), np.int8), 0, resolution_m
    reach = math.ceil(DEPTH_REACH_M / resolution_m)
    i0, j0 = math.floor(pose.x_m / resolution_m) - reach, math.floor(pose.y_m / resolution_m) - reach
    feet_bins = round((pose.z_m - floor.z_m) / HEIGHT_BIN_M)
    seen, ground = floor.seen.window(i0, j0, 2 * reach, 2 * reach), floor.ground.window(i0, j0, 2 * reach, 2 * reach)
    if incline is not None:
        heights_m = _over_cells(incline, i0, j0, 2 * reach, resolution_m) - floor.z_m
        untold = ~np.isnan(heights_m) & (seen & STAIR == 0)
        seen, ground = np.where(untold, seen | STAIR, seen), ground.copy()
        ground[untold] = np.clip(np.round(heights_m[untold] / HEIGHT_BIN_M), -127, 127).astype(np.int8)
    return seen, ground, feet_bins, resolution_m


def depth_distance_m(
    depth_m: NDArray[np.float32],
    view: NDArray[np.float64],
    direction: tuple[float, float],
    half_width_m: float,
    stairs: tuple[NDArray[np.uint8], NDArray[np.int8], int, float],
) -> float:
    """Nearest surface in a direction by the depth image [m]; inf when it shows none.

    Args:
        view: camera, relative to the agent's feet (see ``mapping.projection``).
        direction: unit vector, world frame.
        half_width_m: half the width of the body.
        stairs: windows of ``seen`` and ``ground`` around the agent, height of the feet over the floor in bins, resolution.
    """
    c, s = direction
    forward, left = view[0] * c + view[3] * s, view[1] * c + view[4] * s
    bearing = math.atan2(left, forward)
    near = _columns(view, bearing, _NEAR_HALF_RAD, depth_m.shape[1])
    rows = depth_m.shape[0]
    close, size = _close_samples(depth_m, int(_NEAR_ROWS[0] * rows), int(_NEAR_ROWS[1] * rows), near[0], near[1])
    if close >= _NEAR_SAMPLES and close >= _NEAR_SHARE * size:
        return NEAR_CLIP_M
    wide = _columns(view, bearing, math.atan2(half_width_m, DEPTH_FROM_M) + math.radians(2.0), depth_m.shape[1])
    nearest = _nearest_bin(depth_m, view, c, s, half_width_m, wide[0], wide[1], *stairs)
    return nearest * _BIN_M if nearest < _BINS else math.inf


def _columns(view: NDArray[np.float64], bearing: float, half_rad: float, width: int) -> tuple[int, int]:
    """Image columns within an angle of a camera bearing, clipped to the image."""
    ends = [max(-1.5, min(1.5, bearing + side * half_rad)) for side in (1.0, -1.0)]
    u = [view[14] - view[12] * math.tan(end) for end in ends]
    return max(0, min(width, math.floor(u[0]))), max(0, min(width, math.ceil(u[1])))


@numba.njit(cache=True)
def _close_samples(
    depth_m: NDArray[np.float32], v0: int, v1: int, u0: int, u1: int
) -> tuple[int, int]:  # pragma: no cover - compiled
    """Samples at the camera's lower limit in a part of the image, and all of them."""
    close, size = 0, 0
    limit = np.float32(DEPTH_FROM_M + _NEAR_SLACK_M)
    for v in range(v0, v1, _STRIDE_PX):
        for u in range(u0, u1, _STRIDE_PX):
            size += 1
            close += 0.0 < depth_m[v, u] <= limit
    return close, size


@numba.njit(cache=True)
def _nearest_bin(
    depth_m: NDArray[np.float32],
    view: NDArray[np.float64],
    c: float,
    s: float,
    half_width_m: float,
    u0: int,
    u1: int,
    seen: NDArray[np.uint8],
    ground: NDArray[np.int8],
    feet_bins: int,
    resolution_m: float,
) -> int:  # pragma: no cover - compiled
    """Distance bin up to which enough pixels show something standing in the body's way; ``_BINS`` when none is."""
    counts = np.zeros(_BINS, np.int64)
    half = seen.shape[0] * 0.5
    # Per column: ahead, across and up per metre of depth, before the row's part is added.
    step = -_STRIDE_PX / view[12]
    step_along, step_across = (c * view[1] + s * view[4]) * step, (c * view[4] - s * view[1]) * step
    at_along, at_across = c * view[9] + s * view[10], c * view[10] - s * view[9]
    for v in range(0, depth_m.shape[0], _STRIDE_PX):
        up, left = -(v + 0.5 - view[15]) / view[13], -(u0 + 0.5 - view[14]) / view[12]
        x, y = view[0] + view[1] * left + view[2] * up, view[3] + view[4] * left + view[5] * up
        row_along, row_across = c * x + s * y, c * y - s * x
        row_up, step_up = view[6] + view[7] * left + view[8] * up, view[7] * step
        for k in range((u1 - u0) // _STRIDE_PX):
            d = depth_m[v, u0 + k * _STRIDE_PX]
            if not (DEPTH_FROM_M <= d <= DEPTH_TO_M):
                continue
            z = view[11] + d * (row_up + k * step_up)
            if z < OBSTACLE_FROM_M or z > OBSTACLE_TO_M:
                continue
            across = at_across + d * (row_across + k * step_across)
            if across > half_width_m or across < -half_width_m:
                continue
            along = at_along + d * (row_along + k * step_along)
            if along <= 0.0:
                continue
            if seen.shape[0] > 0:
                i = int((c * along - s * across) / resolution_m + half)
                j = int((s * along + c * across) / resolution_m + half)
                on_tread = 0 <= i < seen.shape[0] and 0 <= j < seen.shape[1] and seen[i, j] & STAIR != 0
                if on_tread and z < (ground[i, j] - feet_bins + TREAD_TOP_BIN - GROUND_BIN) * HEIGHT_BIN_M:
                    continue
            counts[min(int(along * (1.0 / _BIN_M)), _BINS - 1)] += 1
    samples = 0
    for nearest in range(_BINS):
        samples += counts[nearest]
        if samples >= _MIN_SAMPLES:
            return nearest
    return _BINS


@numba.njit(cache=True)
def map_distance_cells(
    solid: NDArray[np.uint8], start_i: float, start_j: float, c: float, s: float, half_width: float, first: float, reach: float
) -> float:  # pragma: no cover - compiled
    """Nearest obstacle cell in the body's way [cells]; inf when there is none within reach."""
    best = np.inf
    for i in range(solid.shape[0]):
        for j in range(solid.shape[1]):
            if solid[i, j] != 0:
                x, y = i + 0.5 - start_i, j + 0.5 - start_j
                along, across = c * x + s * y, c * y - s * x
                if first <= along <= reach and abs(across) <= half_width and along < best:
                    best = along
    return best
