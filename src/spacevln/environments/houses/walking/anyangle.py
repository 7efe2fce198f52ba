"""Kernels of the any-angle search behind :mod:`.geodesics`: paths bend only at cells and are straight between them."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Float = NDArray[np.float64]
Ints = NDArray[np.int64]
Bool = NDArray[np.bool_]
Bytes = NDArray[np.int8]
Slack = NDArray[np.float32]

_SHORTEST_STEP = 0.4


@njit(cache=True)
def _length(dx: float, dy: float, zone: int, stretch: float) -> float:
    """Length of a horizontal displacement; on stairs (zone 1 along x, 2 along y) along the slope."""
    if zone == 1:
        dx *= stretch
    elif zone == 2:
        dy *= stretch
    return math.sqrt(dx * dx + dy * dy)


@njit(cache=True)
def sees(free: Bool, slack: Slack, f: int, ax: float, ay: float, bx: float, by: float, skip: float) -> bool:
    """Whether the straight line between two points (cell units) keeps to free cells, but for its last ``skip`` cells."""
    length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
    if length <= skip:
        return True
    ux, uy = (bx - ax) / length, (by - ay) / length
    at = 0.0
    while at < length - skip:
        i, j = int(ax + at * ux), int(ay + at * uy)
        if not free[f, i, j]:
            return False
        at += max(_SHORTEST_STEP, slack[f, i, j])
    return True


@njit(cache=True)
def _up(heap: Ints, place: Ints, key: Float, k: int) -> None:
    node = heap[k]
    while k > 0:
        parent = (k - 1) >> 1
        if key[heap[parent]] <= key[node]:
            break
        heap[k] = heap[parent]
        place[heap[k]] = k
        k = parent
    heap[k] = node
    place[node] = k


@njit(cache=True)
def _down(heap: Ints, place: Ints, key: Float, size: int) -> None:
    node = heap[0]
    k = 0
    while True:
        child = 2 * k + 1
        if child >= size:
            break
        if child + 1 < size and key[heap[child + 1]] < key[heap[child]]:
            child += 1
        if key[heap[child]] >= key[node]:
            break
        heap[k] = heap[child]
        place[heap[k]] = k
        k = child
    heap[k] = node
    place[node] = k


@njit(cache=True)
def spread(
    free: Bool, slack: Slack, zone: Bytes, link: Ints, stretch: float, seeds: Ints, seed_xy: Float, target: int
) -> tuple[Float, Float, Float, Float, Ints]:
    """Distances from seeds to all nodes (all lengths in cells).

    Args:
        seeds, seed_xy: nodes (K,) and the exact points (K, 2) in them.
        target: node at which the search may end, or -1.

    Returns:
        Per node: distance; the last bend's x, y, distance; the bend's node (-1 - k for seed k).
    """
    nf, nx, ny = free.shape
    count = nf * nx * ny
    dist = np.full(count, np.inf)
    bx, by, bd = np.zeros(count), np.zeros(count), np.zeros(count)
    bend = np.full(count, -1, np.int64)
    heap, place = np.empty(count, np.int64), np.full(count, -1, np.int64)
    flat_zone = zone.ravel()
    done = np.zeros(count, np.bool_)
    size = 0
    for k in range(seeds.shape[0]):
        v = seeds[k]
        j, i = v % ny, (v // ny) % nx
        d = _length(i + 0.5 - seed_xy[k, 0], j + 0.5 - seed_xy[k, 1], flat_zone[v], stretch)
        if d < dist[v]:
            dist[v], bx[v], by[v], bd[v], bend[v] = d, seed_xy[k, 0], seed_xy[k, 1], 0.0, -1 - k
            if place[v] < 0:
                place[v] = size
                heap[size] = v
                size += 1
            _up(heap, place, dist, place[v])
    while size > 0:
        u = heap[0]
        size -= 1
        if size > 0:
            heap[0] = heap[size]
            _down(heap, place, dist, size)
        done[u] = True
        if u == target:
            break
        j, i, f = u % ny, (u // ny) % nx, u // (nx * ny)
        z = flat_zone[u]
        # A bend on another storey or on the other side of a flight's end is seen only by the cell next to it.
        keeps = bend[u] < 0 or (flat_zone[bend[u]] == z and bend[u] // (nx * ny) == f)
        for di in range(-1, 2):
            for dj in range(-1, 2):
                if di == 0 and dj == 0:
                    if link[u] < 0:
                        continue
                    v = link[u]
                else:
                    a, b = i + di, j + dj
                    if a < 0 or b < 0 or a >= nx or b >= ny or not free[f, a, b]:
                        continue
                    if di != 0 and dj != 0 and not (free[f, a, j] or free[f, i, b]):
                        continue
                    v = u + di * ny + dj
                if done[v]:
                    continue
                linked = di == 0 and dj == 0
                vj, vi = v % ny, (v // ny) % nx
                x, y = vi + 0.5, vj + 0.5
                if keeps and not linked and flat_zone[v] == z:
                    d = bd[u] + _length(x - bx[u], y - by[u], z, stretch)
                    if d >= dist[v] - 1e-9:
                        continue
                    if sees(free, slack, f, bx[u], by[u], x, y, 0.0):
                        dist[v], bx[v], by[v], bd[v], bend[v] = d, bx[u], by[u], bd[u], bend[u]
                        if place[v] < 0:
                            place[v] = size
                            heap[size] = v
                            size += 1
                        _up(heap, place, dist, place[v])
                        continue
                d = dist[u] + _length(x - i - 0.5, y - j - 0.5, max(z, flat_zone[v]), stretch)
                if d < dist[v] - 1e-9:
                    dist[v], bx[v], by[v], bd[v], bend[v] = d, i + 0.5, j + 0.5, dist[u], u
                    if place[v] < 0:
                        place[v] = size
                        heap[size] = v
                        size += 1
                    _up(heap, place, dist, place[v])
    return dist, bx, by, bd, bend


@njit(cache=True)
def look_up(
    free: Bool,
    slack: Slack,
    zone: Bytes,
    stretch: float,
    dist: Float,
    bx: Float,
    by: Float,
    bd: Float,
    bend: Ints,
    f: int,
    x: float,
    y: float,
    snap: int,
) -> tuple[float, int, bool]:
    """Distance from a point (cell units) on storey ``f``, the node it goes by, and whether straight to that node's bend."""
    _, nx, ny = free.shape
    best, best_node, best_direct = np.inf, -1, False
    ci, cj = math.floor(x), math.floor(y)
    for reach in range(1, snap + 1):
        for i in range(max(0, ci - reach), min(nx, ci + reach + 1)):
            for j in range(max(0, cj - reach), min(ny, cj + reach + 1)):
                v = (f * nx + i) * ny + j
                if not free[f, i, j] or not np.isfinite(dist[v]):
                    continue
                z = zone[f, i, j]
                near = _length(x - i - 0.5, y - j - 0.5, z, stretch)
                if dist[v] + near < best:
                    best, best_node, best_direct = dist[v] + near, v, False
                same = bend[v] < 0 or (bend[v] // (nx * ny) == f and zone[f, (bend[v] // ny) % nx, bend[v] % ny] == z)
                d = bd[v] + _length(x - bx[v], y - by[v], z, stretch)
                if same and d < best and sees(free, slack, f, bx[v], by[v], x, y, 1.5):
                    best, best_node, best_direct = d, v, True
        if best_node >= 0:
            break
    return best, best_node, best_direct
