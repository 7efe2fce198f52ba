"""Kernels of geodesic distance on a grid: inflation, fast marching, descent, straightening, line of sight.

Distances solve the eikonal equation on the triangles between a cell and its eight neighbours (Sethian 1996; Kimmel and
Sethian 1998), so they are not bound to the grid's directions. The queue is a ring of buckets and values may be corrected after
expansion, which gives the fast-marching solution without a
heap. Cells count in units of one cell; ``(i + 0.5, j + 0.5)`` is the centre of a cell.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from spacevln.mapping.cells import CLIMB_BINS, FREE_EVIDENCE, STAIR, STEEPEST

_BUCKETS = 8
_BUCKET_CELLS = 0.6
_STEPS = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))
_EXACT_CELLS = 10  # around the start, straight distances replace the grid's


@numba.njit(cache=True)
def passable(
    seen: NDArray[np.uint8], solid: NDArray[np.uint8], ground: NDArray[np.int8], radius_cells: float
) -> Any:  # pragma: no cover - compiled
    """1 where the centre of the body may be: known free, no obstacle's cell centre nearer than the radius. The rim is 0.

    A tread that stands higher over the cell than stairs climb on the way to it is an obstacle too: nobody steps on a flight
    from its side, or from its head down to the floor below.
    """
    n_i, n_j = seen.shape
    out = np.zeros((n_i, n_j), np.uint8)
    for i in range(1, n_i - 1):
        for j in range(1, n_j - 1):
            if seen[i, j] & FREE_EVIDENCE != 0 and solid[i, j] == 0:
                out[i, j] = 1
    reach, radius2 = int(radius_cells), radius_cells * radius_cells - 1e-6
    for i in range(n_i):
        for j in range(n_j):
            if solid[i, j] != 0:
                for a in range(max(0, i - reach), min(n_i, i + reach + 1)):
                    for b in range(max(0, j - reach), min(n_j, j + reach + 1)):
                        if (a - i) ** 2 + (b - j) ** 2 < radius2:
                            out[a, b] = 0
            elif seen[i, j] & STAIR != 0:
                _block_beside(out, seen, ground, i, j, max(1, reach), max(1.5, radius2))
    return out


@numba.njit(cache=True)
def _block_beside(
    out: NDArray[np.uint8],
    seen: NDArray[np.uint8],
    ground: NDArray[np.int8],
    i: int,
    j: int,
    reach: int,
    radius2: float,
) -> None:  # pragma: no cover - compiled
    """Close the lower one of a tread and each cell near it when no flight could lead from one to the other."""
    for a in range(max(0, i - reach), min(out.shape[0], i + reach + 1)):
        for b in range(max(0, j - reach), min(out.shape[1], j + reach + 1)):
            away2 = (a - i) ** 2 + (b - j) ** 2
            if away2 < radius2 and seen[a, b] != 0:
                other = ground[a, b] if seen[a, b] & STAIR != 0 else 0
                rise = ground[i, j] - other
                limit = CLIMB_BINS + 1 + STEEPEST * np.sqrt(away2)
                if rise > limit:
                    out[a, b] = 0
                elif -rise > limit:
                    out[i, j] = 0


@numba.njit(cache=True)
def clear_line(grid: NDArray[np.uint8], a_i: float, a_j: float, b_i: float, b_j: float) -> bool:  # pragma: no cover - compiled
    """Whether every cell that the segment crosses is 1 in ``grid``."""
    i, j = int(np.floor(a_i)), int(np.floor(a_j))
    end_i, end_j = int(np.floor(b_i)), int(np.floor(b_j))
    n_i, n_j = grid.shape
    if min(i, j, end_i, end_j) < 0 or max(i, end_i) >= n_i or max(j, end_j) >= n_j:
        return False
    d_i, d_j = b_i - a_i, b_j - a_j
    step_i, step_j = (1 if d_i > 0 else -1), (1 if d_j > 0 else -1)
    per_i = 1.0 / abs(d_i) if d_i != 0 else np.inf
    per_j = 1.0 / abs(d_j) if d_j != 0 else np.inf
    next_i = ((i + 1 - a_i) if d_i > 0 else (a_i - i)) * per_i if d_i != 0 else np.inf
    next_j = ((j + 1 - a_j) if d_j > 0 else (a_j - j)) * per_j if d_j != 0 else np.inf
    for _ in range(abs(end_i - i) + abs(end_j - j) + 1):
        if grid[i, j] == 0:
            return False
        if i == end_i and j == end_j:
            return True
        if next_i < next_j:
            i += step_i
            next_i += per_i
        else:
            j += step_j
            next_j += per_j
        if i < 0 or j < 0 or i >= n_i or j >= n_j:
            return False
    return True


@numba.njit(cache=True)
def nearest_open(
    grid: NDArray[np.uint8], a_i: float, a_j: float, reach_cells: float
) -> tuple[int, int]:  # pragma: no cover - compiled
    """The cell of ``grid`` that is 1 and whose centre is nearest to a point, within reach; (-1, -1) when there is none."""
    n_i, n_j = grid.shape
    best, found_i, found_j = reach_cells * reach_cells + 1e-9, -1, -1
    i0, j0 = int(np.floor(a_i)), int(np.floor(a_j))
    if 0 <= i0 < n_i and 0 <= j0 < n_j and grid[i0, j0] != 0:
        return i0, j0
    span = int(reach_cells) + 1
    for i in range(max(0, i0 - span), min(n_i, i0 + span + 1)):
        for j in range(max(0, j0 - span), min(n_j, j0 + span + 1)):
            d = (i + 0.5 - a_i) ** 2 + (j + 0.5 - a_j) ** 2
            if grid[i, j] != 0 and d < best:
                best, found_i, found_j = d, i, j
    return found_i, found_j


@numba.njit(cache=True)
def _over_edge(straight: np.float32, diagonal: np.float32) -> Any:  # pragma: no cover - compiled
    """Shortest way [cells] to a cell over the edge between a neighbour and the diagonal one beside it, values linear between."""
    gap = straight - diagonal
    if gap <= 0:
        return straight + np.float32(1)
    if gap >= np.float32(0.70710678):
        return diagonal + np.float32(1.41421356)
    return straight + np.sqrt(np.float32(1) - gap * gap)


@numba.njit(cache=True)
def march(grid: NDArray[np.uint8], start_i: float, start_j: float) -> Any:  # pragma: no cover - compiled
    """Distance [cells] of every passable cell from a start inside a passable cell; inf where none leads.

    ``grid`` must be 0 on its rim.
    """
    n_i, n_j = grid.shape
    size = n_i * n_j
    cells = grid.ravel()
    time = np.full(size, np.inf, np.float32)
    following = np.empty(size, np.int32)
    queued = np.zeros(size, np.uint8)
    heads = np.full(_BUCKETS, -1, np.int32)
    waiting = 0
    for i in range(max(1, int(start_i) - _EXACT_CELLS), min(n_i - 1, int(start_i) + _EXACT_CELLS + 1)):
        for j in range(max(1, int(start_j) - _EXACT_CELLS), min(n_j - 1, int(start_j) + _EXACT_CELLS + 1)):
            if grid[i, j] != 0 and clear_line(grid, start_i, start_j, i + 0.5, j + 0.5):
                c = i * n_j + j
                time[c] = np.sqrt((i + 0.5 - start_i) ** 2 + (j + 0.5 - start_j) ** 2)
                following[c] = heads[0]
                heads[0] = c
                queued[c] = 1
                waiting += 1
    bucket = 0
    while waiting > 0:
        slot = bucket % _BUCKETS
        c = heads[slot]
        if c < 0:
            bucket += 1
            continue
        heads[slot] = following[c]
        queued[c] = 0
        waiting -= 1
        for side in range(8):
            step_i, step_j = _STEPS[side]
            n = c + step_i * n_j + step_j
            if cells[n] == 0:
                continue
            if side < 4:  # straight: between c and the nearer one of its two neighbours across
                value = _over_edge(time[c], min(time[c + step_j * n_j + step_i], time[c - step_j * n_j - step_i]))
            else:
                beside, before = c + step_i * n_j, c + step_j
                if cells[beside] == 0 and cells[before] == 0:
                    continue  # no body passes between two closed cells
                value = _over_edge(min(time[beside], time[before]), time[c])
            if value < time[n] - np.float32(1e-3):
                time[n] = value
                if queued[n] == 0:
                    at = min(max(bucket, int(value / _BUCKET_CELLS)), bucket + _BUCKETS - 1) % _BUCKETS
                    following[n] = heads[at]
                    heads[at] = n
                    queued[n] = 1
                    waiting += 1
    return time.reshape(n_i, n_j)


@numba.njit(cache=True)
def sample(
    time: NDArray[np.float32],
    grid: NDArray[np.uint8],
    points: NDArray[np.float64],
    start_i: float,
    start_j: float,
    reach_cells: float,
) -> Any:  # pragma: no cover - compiled
    """Distance [cells] at points (N, 2); a point off the passable cells takes the nearest one's within reach."""
    out = np.full(len(points), np.inf)
    for k in range(len(points)):
        i, j = nearest_open(grid, points[k, 0], points[k, 1], reach_cells)
        if i >= 0 and time[i, j] < np.inf:
            straight = np.hypot(points[k, 0] - start_i, points[k, 1] - start_j)
            inside = int(np.floor(points[k, 0])) == i and int(np.floor(points[k, 1])) == j
            value = _between(time, points[k, 0], points[k, 1]) if inside else np.float64(time[i, j])
            if not inside:
                value += np.hypot(points[k, 0] - i - 0.5, points[k, 1] - j - 0.5)
            out[k] = max(value, straight)
    return out


@numba.njit(cache=True)
def _between(time: NDArray[np.float32], p_i: float, p_j: float) -> float:  # pragma: no cover - compiled
    """Bilinear interpolation between cell centres; the cell's own value where a neighbour is not reached."""
    i, j = int(np.floor(p_i - 0.5)), int(np.floor(p_j - 0.5))
    s, t = p_i - 0.5 - i, p_j - 0.5 - j
    value = (
        (1 - s) * (1 - t) * time[i, j] + s * (1 - t) * time[i + 1, j] + (1 - s) * t * time[i, j + 1] + s * t * time[i + 1, j + 1]
    )
    if value < np.inf:
        return float(value)
    return float(time[int(np.floor(p_i)), int(np.floor(p_j))])


@numba.njit(cache=True)
def descend(
    time: NDArray[np.float32], grid: NDArray[np.uint8], start_i: float, start_j: float, end_i: int, end_j: int
) -> Any:  # pragma: no cover - compiled
    """Straightened way from the start to a reached cell, (N, 2) points in cells, both ends included."""
    n_i, n_j = grid.shape
    way = np.empty((n_i * n_j // 2 + 2, 2))
    way[0, 0], way[0, 1] = end_i + 0.5, end_j + 0.5
    count = 1
    i, j = end_i, end_j
    while count < len(way) - 1:
        best, best_i, best_j = time[i, j], -1, -1
        for a in range(i - 1, i + 2):
            for b in range(j - 1, j + 2):
                if grid[a, b] != 0 and time[a, b] < best and (a == i or b == j or (grid[a, j] != 0 and grid[i, b] != 0)):
                    best, best_i, best_j = time[a, b], a, b
        if best_i < 0:
            break
        i, j = best_i, best_j
        way[count, 0], way[count, 1] = i + 0.5, j + 0.5
        count += 1
    way[count, 0], way[count, 1] = start_i, start_j
    return _straighten(grid, way[: count + 1][::-1].copy())


@numba.njit(cache=True)
def _straighten(grid: NDArray[np.uint8], way: NDArray[np.float64]) -> Any:  # pragma: no cover - compiled
    """Drop the points between which one sees."""
    out = np.empty_like(way)
    out[0] = way[0]
    count, at, last = 1, 0, len(way) - 1
    while at < last:
        ahead = at + 1
        for k in range(at + 2, last + 1):
            if clear_line(grid, way[at, 0], way[at, 1], way[k, 0], way[k, 1]):
                ahead = k
        at = ahead
        out[count] = way[at]
        count += 1
    return out[:count].copy()
