"""Kernels that settle one frame's heights into the cells of the current floor: obstacles, floor, treads of stairs."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from spacevln.mapping.cells import (
    BODY,
    CLIMB_BINS,
    FLOOR,
    FLOOR_BINS,
    GROUND_BIN,
    HEIGHT_BIN_M,
    HIT,
    LOWEST_BIN_M,
    OBSTACLE_BIN,
    STAIR,
    STEEPEST,
    SWEPT,
    UNDER,
)

_STAIR_JOIN_CELLS = 6  # treads over eye level are not seen: risers are joined over a tread
_STAIR_MIN_CELLS = 80
_FLATTEST = 0.5
_FLIGHT_REST_BINS = 1.35
_SOLID_BINS = 24  # 8 bits of 3 bins
_LANDING_BINS = 2
_OVER_FLOOR_BINS = 12  # a tread this high over a cell whose floor is seen is no tread of this storey
_FLIGHT_WIDTH_CELLS = 12
TREAD_TOP_BIN = GROUND_BIN + 6  # over a tread, the riser of the next one may share its cell


@numba.njit(cache=True)
def _span(bits: int) -> tuple[int, int]:  # pragma: no cover - compiled
    """Index of the lowest and the highest set bit."""
    low, high = 0, 31
    while bits & (1 << low) == 0:
        low += 1
    while bits & (1 << high) == 0:
        high -= 1
    return low, high


@numba.njit(cache=True)
def count_flat(heights: NDArray[np.uint32]) -> int:  # pragma: no cover - compiled
    """Number of cells in which this frame shows floor at the height of the feet and nothing on it."""
    count = 0
    for i in range(heights.shape[0]):
        for j in range(heights.shape[1]):
            bits = np.int64(heights[i, j])
            if bits & FLOOR_BINS != 0 and bits >> OBSTACLE_BIN == 0:
                count += 1
    return count


@numba.njit(cache=True)
def fill_lying(
    heights: NDArray[np.uint32], camera: tuple[float, float, float], fy_px: float, resolution_m: float
) -> None:  # pragma: no cover - compiled
    """Join the rows of pixels that fell on one lying surface (table top, bed), which lie cells apart when it is seen flat.

    From every cell the ray is followed away from the camera for as far as the next row of pixels lies on a level surface; a cell
    with the same height there makes those between part of the surface.

    Args:
        camera: i, j in cells and height over the feet [m].
    """
    for i in range(heights.shape[0]):
        for j in range(heights.shape[1]):
            bits = np.int64(heights[i, j])
            if bits >> OBSTACLE_BIN == 0:
                continue
            _, high = _span(bits)
            drop_m = camera[2] - (LOWEST_BIN_M + (high + 0.5) * HEIGHT_BIN_M)
            di, dj = i + 0.5 - camera[0], j + 0.5 - camera[1]
            far = np.hypot(di, dj)
            if drop_m < 0.03 or far < 1.0:
                continue
            rows_apart = far * far * resolution_m / (fy_px * drop_m)
            if rows_apart < 0.7:
                continue
            for step in range(2, min(10, int(2.0 + 1.3 * rows_apart)) + 1):
                a, b = int(i + 0.5 + di / far * step), int(j + 0.5 + dj / far * step)
                if not (0 <= a < heights.shape[0] and 0 <= b < heights.shape[1]):
                    break
                if heights[a, b] & np.uint32(1 << high) != 0:
                    for between in range(1, step):
                        p, q = int(i + 0.5 + di / far * between), int(j + 0.5 + dj / far * between)
                        heights[p, q] |= np.uint32(1 << high)
                    break


@numba.njit(cache=True)
def find_stairs(
    heights: NDArray[np.uint32],
    seen: NDArray[np.uint8],
    ground: NDArray[np.int8],
    feet_bins: int,
    on_stairs: bool,
    camera_ij: tuple[float, float],
    radius_cells: float,
    blind_cells: float,
) -> int:  # pragma: no cover - compiled
    """Flag treads and risers that steps of at most 0.2 m connect with the floor; returns how many cells are new.

    A tread or riser is a cell whose heights span at most a step. The sides of most furniture span more; what is left must rise
    by 0.6 m in all, evenly in one direction, as wide as a flight.

    Args:
        heights: of this frame, relative to the feet.
        ground: tread heights over the floor [bins of 5 cm], written for the new ones.
        feet_bins: height of the feet over the floor [bins].
        on_stairs: the agent already stands on them: a single step on is enough.
        camera_ij, radius_cells: only cells this near are looked at.
        blind_cells: nearer than this, the foot of a flight lies below the image.
    """
    n_i, n_j = heights.shape
    level = np.full((n_i, n_j), -1, np.int8)
    rise_bins = 3 if on_stairs else 12
    queue = np.empty((n_i * n_j, 2), np.int32)
    for i in range(n_i):
        for j in range(n_j):
            bits = np.int64(heights[i, j])
            near = (i + 0.5 - camera_ij[0]) ** 2 + (j + 0.5 - camera_ij[1]) ** 2 <= radius_cells * radius_cells
            if bits >> OBSTACLE_BIN != 0 and near:
                low, high = _span(bits)
                if high - low <= CLIMB_BINS:
                    level[i, j] = high
    new = 0
    for i in range(2, n_i - 2):
        for j in range(2, n_j - 2):
            blind = (i + 0.5 - camera_ij[0]) ** 2 + (j + 0.5 - camera_ij[1]) ** 2 <= blind_cells * blind_cells
            hidden_foot = blind and not on_stairs and 0 <= level[i, j] <= GROUND_BIN + rise_bins
            if level[i, j] < 0 or not (hidden_foot or _reached(heights, seen, ground, feet_bins, level[i, j], i, j)):
                continue
            end, highest = _climb(level, queue, i, j)
            enough = end >= (2 if hidden_foot else 1) * _STAIR_MIN_CELLS
            even = on_stairs or (enough and _is_flight(level, queue, end))
            if even and highest >= GROUND_BIN + rise_bins:
                for k in range(end):
                    a, b = queue[k, 0], queue[k, 1]
                    height = -level[a, b] - 2 - GROUND_BIN + feet_bins
                    if seen[a, b] & FLOOR != 0 and abs(height) >= _OVER_FLOOR_BINS:
                        continue  # the landing of the next storey over this one's floor
                    if seen[a, b] & STAIR == 0:
                        new += 1
                    ground[a, b] = max(height, ground[a, b]) if seen[a, b] & STAIR != 0 else height
                    seen[a, b] |= STAIR
    return new


@numba.njit(cache=True)
def _reached(
    heights: NDArray[np.uint32],
    seen: NDArray[np.uint8],
    ground: NDArray[np.int8],
    feet_bins: int,
    level: int,
    i: int,
    j: int,
) -> bool:  # pragma: no cover - compiled
    """Whether a step leads to this level from floor at the height of the feet or from a known tread, within two cells."""
    for a in range(i - 2, i + 3):
        for b in range(j - 2, j + 3):
            if seen[a, b] & STAIR != 0:
                if abs(ground[a, b] - feet_bins + GROUND_BIN - level) <= CLIMB_BINS:
                    return True
            elif level <= GROUND_BIN + CLIMB_BINS:
                bits = np.int64(heights[a, b])
                if (bits & FLOOR_BINS != 0 and bits >> OBSTACLE_BIN == 0) or seen[a, b] & (FLOOR | SWEPT | BODY) != 0:
                    return True
    return False


@numba.njit(cache=True)
def _is_flight(level: NDArray[np.int8], queue: NDArray[np.int32], count: int) -> bool:  # pragma: no cover - compiled
    """Whether a group of treads rises like one flight: a plane fits its heights, of a stair's slope and at least 0.5 m wide."""
    mean = np.zeros(3)
    for k in range(count):
        i, j = queue[k, 0], queue[k, 1]
        mean += np.array([i, j, -level[i, j] - 2.0])
    mean /= count
    s_ii, s_ij, s_jj, s_ih, s_jh, s_hh = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        i, j = queue[k, 0], queue[k, 1]
        a, b, h = i - mean[0], j - mean[1], -level[i, j] - 2.0 - mean[2]
        s_ii, s_ij, s_jj = s_ii + a * a, s_ij + a * b, s_jj + b * b
        s_ih, s_jh, s_hh = s_ih + a * h, s_jh + b * h, s_hh + h * h
    determinant = s_ii * s_jj - s_ij * s_ij
    if determinant < 1e-6:
        return False
    g_i, g_j = (s_jj * s_ih - s_ij * s_jh) / determinant, (s_ii * s_jh - s_ij * s_ih) / determinant
    slope = np.hypot(g_i, g_j)  # bins of 5 cm per cell
    rest = (s_hh - g_i * s_ih - g_j * s_jh) / count
    if not (_FLATTEST <= slope <= STEEPEST) or rest > _FLIGHT_REST_BINS**2:
        return False
    low, high, off = np.inf, -np.inf, 0
    for k in range(count):
        i, j = queue[k, 0], queue[k, 1]
        off += abs(-level[i, j] - 2.0 - mean[2] - g_i * (i - mean[0]) - g_j * (j - mean[1])) > 3.0
        across = (queue[k, 1] * g_i - queue[k, 0] * g_j) / slope
        low, high = min(low, across), max(high, across)
    return bool(high - low >= _FLIGHT_WIDTH_CELLS and off <= 0.03 * count)


@numba.njit(cache=True)
def _climb(level: NDArray[np.int8], queue: NDArray[np.int32], i: int, j: int) -> tuple[int, int]:  # pragma: no cover - compiled
    """Collect a group of treads step by step into ``queue``; visited levels are stored as ``-level - 2``."""
    n_i, n_j = level.shape
    queue[0, 0], queue[0, 1] = i, j
    highest = int(level[i, j])
    level[i, j] = -level[i, j] - 2
    start, end = 0, 1
    while start < end:
        a, b = queue[start, 0], queue[start, 1]
        start += 1
        here = -int(level[a, b]) - 2
        for c in range(max(0, a - _STAIR_JOIN_CELLS), min(n_i, a + _STAIR_JOIN_CELLS + 1)):
            for d in range(max(0, b - _STAIR_JOIN_CELLS), min(n_j, b + _STAIR_JOIN_CELLS + 1)):
                there = int(level[c, d])
                if there < 0 or abs(there - here) > CLIMB_BINS:
                    continue
                highest = max(highest, there)
                level[c, d] = -there - 2
                queue[end, 0], queue[end, 1] = c, d
                end += 1
    return end, highest


@numba.njit(cache=True)
def settle(
    heights: NDArray[np.uint32],
    seen: NDArray[np.uint8],
    solid: NDArray[np.uint8],
    ground: NDArray[np.int8],
    feet_bins: int,
    camera_ij: tuple[float, float],
    radius_cells: float,
) -> None:  # pragma: no cover - compiled
    """Write one frame's heights into the cells within ``radius_cells`` of the camera."""
    reach = radius_cells * radius_cells
    for i in range(heights.shape[0]):
        for j in range(heights.shape[1]):
            bits = np.int64(heights[i, j])
            if bits == 0 or (i + 0.5 - camera_ij[0]) ** 2 + (j + 0.5 - camera_ij[1]) ** 2 > reach:
                continue
            # Heights count from the cell's own ground: a tread, the storey's floor where it was seen, else the feet.
            first = OBSTACLE_BIN
            if seen[i, j] & STAIR != 0:
                first = TREAD_TOP_BIN + ground[i, j] - feet_bins
                solid[i, j] = 0
            elif seen[i, j] & FLOOR != 0:
                first = OBSTACLE_BIN - feet_bins
            standing = np.int64(0)
            if 0 <= first < 32:
                standing = bits >> first
            elif -_SOLID_BINS < first < 0:
                standing = (bits << -first) & ((1 << _SOLID_BINS) - 1)
            if standing != 0:
                seen[i, j] |= HIT
                for b in range(8):
                    if (standing >> (3 * b)) & 7 != 0:
                        solid[i, j] |= 1 << b
            elif bits & FLOOR_BINS != 0:
                seen[i, j] |= UNDER


@numba.njit(cache=True)
def drop_treads_over_floor(seen: NDArray[np.uint8], ground: NDArray[np.int8]) -> None:  # pragma: no cover - compiled
    """Where the storey's own floor is seen, what was taken for a high tread lies on another storey."""
    for i in range(seen.shape[0]):
        for j in range(seen.shape[1]):
            over_floor = seen[i, j] & (STAIR | FLOOR | BODY) == STAIR | FLOOR
            if over_floor and abs(ground[i, j]) >= _OVER_FLOOR_BINS:
                seen[i, j] &= ~np.uint8(STAIR)


@numba.njit(cache=True)
def drop_landing(seen: NDArray[np.uint8], ground: NDArray[np.int8], level_bins: int) -> None:  # pragma: no cover - compiled
    """Take the treads at the height of the storey that was reached out of the one that was left."""
    for i in range(seen.shape[0]):
        for j in range(seen.shape[1]):
            if seen[i, j] & STAIR != 0 and abs(ground[i, j] - level_bins) <= _LANDING_BINS:
                seen[i, j] &= ~np.uint8(STAIR)
                if seen[i, j] & FLOOR == 0:
                    seen[i, j] &= ~np.uint8(BODY)


@numba.njit(cache=True)
def stamp_body(
    seen: NDArray[np.uint8],
    solid: NDArray[np.uint8],
    ground: NDArray[np.int8],
    feet_bins: int,
    a_ij: tuple[float, float],
    b_ij: tuple[float, float],
    radius_cells: float,
) -> None:  # pragma: no cover - compiled
    """Free the cells that the body covered on its way from a to b; where it stood off the floor's height it stood on treads."""
    along_i, along_j = b_ij[0] - a_ij[0], b_ij[1] - a_ij[1]
    length2 = along_i * along_i + along_j * along_j
    for i in range(
        max(0, int(min(a_ij[0], b_ij[0]) - radius_cells) - 1), min(seen.shape[0], int(max(a_ij[0], b_ij[0]) + radius_cells) + 2)
    ):
        for j in range(
            max(0, int(min(a_ij[1], b_ij[1]) - radius_cells) - 1),
            min(seen.shape[1], int(max(a_ij[1], b_ij[1]) + radius_cells) + 2),
        ):
            di, dj = i + 0.5 - a_ij[0], j + 0.5 - a_ij[1]
            t = 0.0 if length2 == 0.0 else min(1.0, max(0.0, (di * along_i + dj * along_j) / length2))
            if (di - t * along_i) ** 2 + (dj - t * along_j) ** 2 <= radius_cells * radius_cells:
                if feet_bins != 0 and seen[i, j] & STAIR == 0:
                    seen[i, j] |= STAIR
                    ground[i, j] = feet_bins
                seen[i, j] |= BODY
                solid[i, j] = 0
