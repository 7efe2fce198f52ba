"""Kernels that turn one depth image into what its cells show.

``scatter_heights`` goes from pixels to cells (obstacles must not be missed); ``see_floor``, ``sweep_below`` and
``clear_seen_through`` go from cells to pixels (a cell is asked whether the ray towards it reached it), which is ray casting at
the price of one look-up per cell.

A camera is passed as ``view``, 16 float64: ``[0:9]`` rotation world from camera by rows, ``[9:12]`` optical centre relative to
the window's corner (metres) with z relative to the feet, ``[12:16]`` fx, fy, cx, cy.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from spacevln.core import Observation
from spacevln.mapping.cells import DEPTH_FROM_M, DEPTH_TO_M, FLOOR, FLOOR_BINS, HEIGHT_BIN_M, LOWEST_BIN_M, SWEPT, UNDER

_ROWS_ABOVE = 4
_BLIND_ROWS = 24  # rows over which the lowest visible surface is told upright or lying
_SEE_THROUGH_M = 0.12  # a ray must end this far behind an obstacle to remove it


def camera_view(observation: Observation, x_m: float, y_m: float) -> NDArray[np.float64]:
    """The camera as kernels take it (see the module), relative to a point and to the height of the feet."""
    camera, T_world_camera = observation.camera, observation.T_world_camera
    view = np.empty(16)
    view[:9] = T_world_camera[:3, :3].ravel()
    view[9:12] = T_world_camera[:3, 3] - (x_m, y_m, observation.pose.z_m)
    view[12:] = camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px
    return view


@numba.njit(cache=True)
def scatter_heights(
    depth_m: NDArray[np.float32], view: NDArray[np.float64], resolution_m: float, heights: NDArray[np.uint32]
) -> None:  # pragma: no cover - compiled
    """Set the height bin of every valid pixel in the cell that it falls into."""
    rows, columns = depth_m.shape
    n_i, n_j = heights.shape
    to_cell, to_bin = 1.0 / resolution_m, 1.0 / HEIGHT_BIN_M
    fx, fy, cx, cy = view[12], view[13], view[14], view[15]
    x0, y0 = np.float32(view[9] * to_cell), np.float32(view[10] * to_cell)
    z0 = np.float32((view[11] - LOWEST_BIN_M) * to_bin)
    step_x, step_y = np.float32(-view[1] / fx * to_cell), np.float32(-view[4] / fx * to_cell)
    step_z = np.float32(-view[7] / fx * to_bin)
    near, far = np.float32(DEPTH_FROM_M), np.float32(DEPTH_TO_M)
    zero, top, end_i, end_j = np.float32(0), np.float32(32), np.float32(n_i), np.float32(n_j)
    for v in range(rows):
        left, up = -(0.5 - cx) / fx, -(v + 0.5 - cy) / fy
        base_x = np.float32((view[0] + view[1] * left + view[2] * up) * to_cell)
        base_y = np.float32((view[3] + view[4] * left + view[5] * up) * to_cell)
        base_z = np.float32((view[6] + view[7] * left + view[8] * up) * to_bin)
        for u in range(columns):
            d = depth_m[v, u]
            if not (near <= d <= far):
                continue
            column = np.float32(u)
            z = z0 + d * (base_z + column * step_z)
            if not (zero <= z < top):
                continue
            x = x0 + d * (base_x + column * step_x)
            y = y0 + d * (base_y + column * step_y)
            if zero <= x < end_i and zero <= y < end_j:
                heights[np.int32(x), np.int32(y)] |= np.uint32(1) << np.uint32(z)


@numba.njit(cache=True)
def see_floor(
    depth_m: NDArray[np.float32],
    view: NDArray[np.float64],
    resolution_m: float,
    heights: NDArray[np.uint32],
    seen: NDArray[np.uint8],
) -> None:  # pragma: no cover - compiled
    """Flag the cells whose floor the image shows, and those below the image over which its lowest rays pass."""
    rows, columns = depth_m.shape
    fx, fy, cx, cy = view[12], view[13], view[14], view[15]
    reach_m = _reach_below(depth_m, view)
    for i in range(seen.shape[0]):
        dx = (i + 0.5) * resolution_m - view[9]
        for j in range(seen.shape[1]):
            if seen[i, j] & FLOOR != 0:
                continue
            dy = (j + 0.5) * resolution_m - view[10]
            forward = view[0] * dx + view[3] * dy - view[6] * view[11]
            if forward < 0.02 or forward > DEPTH_TO_M:
                continue
            left = view[1] * dx + view[4] * dy - view[7] * view[11]
            if fx * left > cx * forward or fx * left <= (cx - columns) * forward:
                continue
            u = cx - fx * left / forward
            v = cy - fy * (view[2] * dx + view[5] * dy - view[8] * view[11]) / forward
            if v >= rows:
                if forward <= reach_m[np.int64(u)]:
                    seen[i, j] |= SWEPT
            elif v >= 0.0 and forward >= DEPTH_FROM_M:
                hit = heights[i, j] & np.uint32(FLOOR_BINS) != 0
                if hit or _floor_at(depth_m, view, np.int64(u), np.int64(v), forward):
                    seen[i, j] |= FLOOR if _room_above(depth_m, view, dx, dy) else UNDER


@numba.njit(cache=True)
def _floor_at(
    depth_m: NDArray[np.float32], view: NDArray[np.float64], u: int, v: int, forward_m: float
) -> Any:  # pragma: no cover - compiled
    """Whether the pixel's ray ends on the floor plane.

    Clearly off is no floor. Slightly off may be a noisy sensor, a rug or the foot of a wall: the rows above tell, because a wall
    departs from the floor plane there.
    """
    off_m = _off_floor_m(depth_m, view, u, v)
    if off_m <= 0.005 + 0.002 * forward_m:
        return True
    loose_m = 0.02 + 0.01 * forward_m
    return off_m <= loose_m and _off_floor_m(depth_m, view, u, max(0, v - _ROWS_ABOVE)) <= loose_m


@numba.njit(cache=True)
def _room_above(
    depth_m: NDArray[np.float32], view: NDArray[np.float64], dx: float, dy: float
) -> bool:  # pragma: no cover - compiled
    """Whether a ray reaches the space 0.35 or 0.70 m over a cell, or it lies outside the image."""
    for z in (0.35, 0.7):
        dz = z - view[11]
        forward = view[0] * dx + view[3] * dy + view[6] * dz
        u = np.int64(view[14] - view[12] * (view[1] * dx + view[4] * dy + view[7] * dz) / forward)
        v = np.int64(view[15] - view[13] * (view[2] * dx + view[5] * dy + view[8] * dz) / forward)
        if u < 0 or v < 0 or u >= depth_m.shape[1] or v >= depth_m.shape[0]:
            return True
        d = depth_m[v, u]
        if not (DEPTH_FROM_M <= d <= DEPTH_TO_M) or d >= forward - 0.05:
            return True
    return False


@numba.njit(cache=True)
def _off_floor_m(depth_m: NDArray[np.float32], view: NDArray[np.float64], u: int, v: int) -> Any:  # pragma: no cover - compiled
    """How far a measured depth differs from the floor plane's [m]; inf when the ray does not descend."""
    slope = view[6] - view[7] * (u + 0.5 - view[14]) / view[12] - view[8] * (v + 0.5 - view[15]) / view[13]
    if slope > -1e-3:
        return np.inf
    return abs(depth_m[v, u] + view[11] / slope)


@numba.njit(cache=True)
def _reach_below(depth_m: NDArray[np.float32], view: NDArray[np.float64]) -> Any:  # pragma: no cover - compiled
    """Per column: how far forward the floor below the image may be taken as free [m].

    To the floor when the lowest ray ends there, to an upright surface when it ends on one (wall, cupboard); nowhere when it ends
    on something lying (a bed whose front edge is out of sight) or on no surface in range.
    """
    rows, columns = depth_m.shape
    reach_m = np.zeros(columns)
    low, high = rows - 1, max(0, rows - 1 - _BLIND_ROWS)
    for u in range(columns):
        d, above = depth_m[low, u], depth_m[high, u]
        if not (DEPTH_FROM_M <= d <= DEPTH_TO_M):
            continue
        side = -(u + 0.5 - view[14]) / view[12]
        z = view[11] + d * (view[6] + view[7] * side - view[8] * (low + 0.5 - view[15]) / view[13])
        if -0.03 <= z < 0.03:
            reach_m[u] = d
        elif z > 0.0 and abs(above - d) < 0.3 * d * (low - high) / view[13]:
            reach_m[u] = d - 0.05
    return reach_m


@numba.njit(cache=True)
def clear_seen_through(
    depth_m: NDArray[np.float32],
    view: NDArray[np.float64],
    resolution_m: float,
    heights: NDArray[np.uint32],
    seen: NDArray[np.uint8],
    solid: NDArray[np.uint8],
) -> int:  # pragma: no cover - compiled
    """Remove the height bins through which this image looks; returns the number of cells that became free.

    A bin goes when rays cross all of it and end well behind: one pixel that ends in or before it keeps it.
    """
    cleared = 0
    n_i, n_j = solid.shape
    for i in range(n_i):
        for j in range(n_j):
            if solid[i, j] == 0:
                continue
            dx, dy = (i + 0.5) * resolution_m - view[9], (j + 0.5) * resolution_m - view[10]
            forward = view[0] * dx + view[3] * dy
            if forward < DEPTH_FROM_M or abs(view[1] * dx + view[4] * dy) * view[12] > depth_m.shape[1] * forward:
                continue
            left_over = solid[i, j]
            for b in range(8):
                if left_over & (1 << b) == 0 or (heights[i, j] >> np.uint32(9 + 3 * b)) & np.uint32(7) != 0:
                    continue
                if _looks_through(
                    depth_m, view, (i + 0.5) * resolution_m, (j + 0.5) * resolution_m, 0.225 + 0.15 * b, resolution_m
                ):
                    left_over = left_over & ~np.uint8(1 << b)
            if left_over != solid[i, j]:
                solid[i, j] = left_over
                if left_over == 0:
                    seen[i, j] |= SWEPT
                    cleared += 1
    return cleared


@numba.njit(cache=True)
def _looks_through(
    depth_m: NDArray[np.float32], view: NDArray[np.float64], x: float, y: float, z: float, resolution_m: float
) -> Any:  # pragma: no cover - compiled
    """Whether every valid pixel over one height bin of one cell, and at least half of them, ends behind it."""
    dx, dy, dz = x - view[9], y - view[10], z - view[11]
    forward = view[0] * dx + view[3] * dy + view[6] * dz
    if forward < DEPTH_FROM_M + 0.1 or forward > DEPTH_TO_M - 0.2:
        return False
    u = view[14] - view[12] * (view[1] * dx + view[4] * dy + view[7] * dz) / forward
    v = view[15] - view[13] * (view[2] * dx + view[5] * dy + view[8] * dz) / forward
    half_u = view[12] * (0.71 * resolution_m + 0.01) / forward
    half_v = view[13] * (0.075 + 0.02) / forward
    u0, u1, v0, v1 = np.int64(u - half_u), np.int64(u + half_u), np.int64(v - half_v), np.int64(v + half_v)
    if u0 < 0 or v0 < 0 or u1 >= depth_m.shape[1] or v1 >= depth_m.shape[0]:
        return False
    behind = forward + _SEE_THROUGH_M
    if not through_pixel(depth_m[np.int64(v), np.int64(u)], behind):
        return False
    valid = 0
    for row in range(v0, v1 + 1):
        for column in range(u0, u1 + 1):
            d = depth_m[row, column]
            if DEPTH_FROM_M <= d <= DEPTH_TO_M:
                if d <= behind:
                    return False
                valid += 1
    return 2 * valid >= (v1 + 1 - v0) * (u1 + 1 - u0)


@numba.njit(cache=True)
def through_pixel(d: float, behind_m: float) -> Any:  # pragma: no cover - compiled
    """Whether a measured depth ends behind a distance."""
    return behind_m < d <= DEPTH_TO_M
