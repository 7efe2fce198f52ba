"""Shortest ways over the pixels of an occupancy map, by GN-Bench's rules: 8 neighbours, no cutting of corners.

A pixel is (column, row). Among equal ways GN-Bench's search finds a certain one, and what it is smoothed to depends on which; so
ties are broken as there: the queue is ordered by estimate, then column, then row.
"""

from __future__ import annotations

import heapq
import math

import numba
import numpy as np
from numpy.typing import NDArray

Grid = NDArray[np.bool_]
Pixels = NDArray[np.int64]

_SIDES = np.array([(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)], np.int64)


@numba.njit(cache=True)
def _open(free: Grid, x: int, y: int, dx: int, dy: int) -> bool:
    """Whether a step from (x, y) stays on free pixels, the start aside."""
    height, width = free.shape
    u, v = x + dx, y + dy
    if u < 0 or v < 0 or u >= width or v >= height or not free[v, u]:
        return False
    return dx == 0 or dy == 0 or (free[y, u] and free[v, x])


@numba.njit(cache=True)
def shortest(free: Grid, start: tuple[int, int], goal: tuple[int, int]) -> Pixels:
    """Pixels (N, 2) of the shortest way, both ends included; (0, 2) when there is none. The start need not be free (A*)."""
    height, width = free.shape
    cost = np.full((height, width), np.inf)
    before = np.full((height, width), -1, np.int64)
    cost[start[1], start[0]] = 0.0
    waiting = [(math.hypot(start[0] - goal[0], start[1] - goal[1]), start[0], start[1])]
    while waiting:
        _, x, y = heapq.heappop(waiting)
        if x == goal[0] and y == goal[1]:
            found: Pixels = _walked_back(before, x, y)
            return found
        for k in range(8):
            dx, dy = _SIDES[k, 0], _SIDES[k, 1]
            if not _open(free, x, y, dx, dy):
                continue
            longer = cost[y, x] + (1.0 if dx == 0 or dy == 0 else math.sqrt(2.0))
            u, v = x + dx, y + dy
            if longer < cost[v, u]:
                cost[v, u] = longer
                before[v, u] = k
                heapq.heappush(waiting, (longer + math.sqrt(float((u - goal[0]) ** 2 + (v - goal[1]) ** 2)), u, v))
    return np.zeros((0, 2), np.int64)


@numba.njit(cache=True)
def _walked_back(before: Pixels, x: int, y: int) -> Pixels:
    found = [(x, y)]
    while before[y, x] >= 0:
        k = before[y, x]
        x, y = x - _SIDES[k, 0], y - _SIDES[k, 1]
        found.append((x, y))
    way = np.empty((len(found), 2), np.int64)
    for i in range(len(found)):
        way[len(found) - 1 - i, 0], way[len(found) - 1 - i, 1] = found[i]
    return way


@numba.njit(cache=True)
def field(free: Grid, goals: Pixels) -> NDArray[np.float64]:
    """Length in pixels of the shortest way from every pixel to the nearest goal, (H, W); inf where there is none (Dijkstra)."""
    height, width = free.shape
    cost = np.full((height, width), np.inf)
    waiting = [(0.0, goals[0, 0], goals[0, 1])]
    for i in range(len(goals)):
        cost[goals[i, 1], goals[i, 0]] = 0.0
        heapq.heappush(waiting, (0.0, goals[i, 0], goals[i, 1]))
    while waiting:
        length, x, y = heapq.heappop(waiting)
        if length > cost[y, x]:
            continue
        for k in range(8):
            dx, dy = _SIDES[k, 0], _SIDES[k, 1]
            if not _open(free, x, y, dx, dy):
                continue
            longer = length + (1.0 if dx == 0 or dy == 0 else math.sqrt(2.0))
            if longer < cost[y + dy, x + dx]:
                cost[y + dy, x + dx] = longer
                heapq.heappush(waiting, (longer, x + dx, y + dy))
    return cost


@numba.njit(cache=True)
def line(start: tuple[int, int], end: tuple[int, int]) -> Pixels:
    """Pixels (N, 2) of a straight line, both ends included (Bresenham)."""
    (x, y), (u, v) = start, end
    dx, dy = abs(u - x), abs(v - y)
    long, short = max(dx, dy), min(dx, dy)
    found = np.empty((long + 1, 2), np.int64)
    rest = long // 2
    for i in range(long + 1):
        found[i, 0], found[i, 1] = x, y
        rest -= short
        aside = rest < 0
        rest += long if aside else 0
        if dx >= dy or aside:
            x += 1 if u >= start[0] else -1
        if dx < dy or aside:
            y += 1 if v >= start[1] else -1
    return found


@numba.njit(cache=True)
def reach(free: Grid, start: tuple[int, int], end: tuple[int, int]) -> tuple[int, int]:
    """The last pixel that can be reached on the straight line to an end; the start where the first one is blocked."""
    pixels = line(start, end)
    last = start
    for i in range(len(pixels)):
        if not free[pixels[i, 1], pixels[i, 0]]:
            break
        last = (pixels[i, 0], pixels[i, 1])
    return last


@numba.njit(cache=True)
def smoothed(free: Grid, way: Pixels) -> Pixels:
    """A way's bends (M, 2): from each on to the farthest pixel in sight, or else to the next."""
    if len(way) <= 2:
        return way
    kept = [0]
    while kept[-1] < len(way) - 1:
        here = (way[kept[-1], 0], way[kept[-1], 1])
        ahead = len(way) - 1
        while ahead > kept[-1] + 1 and reach(free, here, (way[ahead, 0], way[ahead, 1])) != (way[ahead, 0], way[ahead, 1]):
            ahead -= 1
        kept.append(ahead)
    bends: Pixels = way[np.array(kept)]
    return bends
