"""What stands in the agent's way, as exact planar shapes: oriented boxes and discs."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from spacevln.environments.houses.layout.structure import head_block, railings, walls_of
from spacevln.environments.houses.plan import House, Item, Part, Rect

STEP_M = 0.05
"""What is lower than this is walked over."""
CLEAR_M = 0.95
"""What hangs higher than this above the floor is walked under: the body is 0.88 m high."""

Float = NDArray[np.float64]


def box(rect: Rect) -> tuple[float, float, float, float, float, float]:
    """An axis-aligned rectangle as an oriented box (centre x, y, cos, sin, half extents)."""
    x, y = rect.centre
    return x, y, 1.0, 0.0, rect.width / 2, rect.depth / 2


def wall_shapes(house: House, floor: int) -> Float:
    """Oriented boxes (N, 6) of walls, railings and the flight's end on a storey, at the height of the body."""
    z = house.floors[floor].z_m
    rects = [part.rect for part in walls_of(house, floor) if part.z0_m < z + CLEAR_M and part.z1_m > z + STEP_M]
    rects += [railing.rect for railing in railings(house) if railing.floor == floor]
    rects += [head_block(stairs) for stairs in house.stairs if stairs.lower_floor == floor]
    return np.array([box(rect) for rect in rects], np.float64).reshape(-1, 6)


def item_shapes(items: Iterable[Item], floor_z_m: float) -> tuple[Float, Float]:
    """Oriented boxes (N, 6) and discs (M, 3: x, y, radius) of the solid parts at the height of the body."""
    boxes: list[tuple[float, ...]] = []
    discs: list[tuple[float, ...]] = []
    for item in items:
        if item.solid:
            c, s = math.cos(item.yaw_rad), math.sin(item.yaw_rad)
            rects, rounds = _local_shapes(item, floor_z_m)
            for x, y, hx, hy in rects:
                boxes.append((item.x + c * x - s * y, item.y + s * x + c * y, c, s, hx, hy))
            for x, y, r in rounds:
                discs.append((item.x + c * x - s * y, item.y + s * x + c * y, r))
    return np.array(boxes, np.float64).reshape(-1, 6), np.array(discs, np.float64).reshape(-1, 3)


def _local_shapes(item: Item, floor_z_m: float) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
    """Rectangles and discs in the item's frame; those that lie within another rectangle of the item are dropped."""
    rects: list[tuple[float, ...]] = []
    discs: list[tuple[float, ...]] = []
    base = item.z - floor_z_m
    for part in item.parts:
        (px, py, pz), (hx, hy, hz) = part.position, _half_extents(part)
        if base + pz - hz >= CLEAR_M or base + pz + hz <= STEP_M:
            continue
        upright = part.euler_rad[0] == 0.0 == part.euler_rad[1] and part.shape in ("cylinder", "ellipsoid", "capsule")
        fits = abs(px) + hx <= item.size[0] / 2 + 1e-9 and abs(py) + hy <= item.size[1] / 2 + 1e-9
        if upright and fits and abs(hx - hy) < 1e-9:
            discs.append((px, py, hx))
        else:
            rects += _clipped(px, py, hx, hy, item)
    kept = [r for k, r in enumerate(rects) if not any(_within(r, q, k > m) for m, q in enumerate(rects) if m != k)]
    round_kept = [d for d in discs if not any(_within((d[0], d[1], d[2], d[2]), q, True) for q in kept)]
    return kept, round_kept


def _within(a: tuple[float, ...], b: tuple[float, ...], ties: bool) -> bool:
    """Whether rectangle ``a`` lies in ``b``; of two equal ones only the later (``ties``) does."""
    inside = abs(a[0] - b[0]) + a[2] <= b[2] + 1e-9 and abs(a[1] - b[1]) + a[3] <= b[3] + 1e-9
    return inside and (ties or a != b)


def _clipped(x: float, y: float, hx: float, hy: float, item: Item) -> list[tuple[float, ...]]:
    """A rectangle cut to the item's footprint: a cushion that bulges over it by centimetres is soft."""
    w, d = item.size[0] / 2, item.size[1] / 2
    x0, x1, y0, y1 = max(x - hx, -w), min(x + hx, w), max(y - hy, -d), min(y + hy, d)
    return [((x0 + x1) / 2, (y0 + y1) / 2, (x1 - x0) / 2, (y1 - y0) / 2)] if x0 < x1 and y0 < y1 else []


def _half_extents(part: Part) -> tuple[float, float, float]:
    """Half extents of the part's bounding box along the item's axes; meshes lie within a unit box that ``size`` scales."""
    a, b, c = part.size
    half = np.array({"cylinder": (a, a, b), "capsule": (a, a, a + b)}.get(part.shape, (a, b, c)))
    if part.euler_rad != (0.0, 0.0, 0.0):
        half = np.abs(_rotation(part.euler_rad)) @ half
    return float(half[0]), float(half[1]), float(half[2])


def _rotation(euler_rad: tuple[float, float, float]) -> Float:
    (cx, cy, cz), (sx, sy, sz) = (tuple(map(f, euler_rad)) for f in (math.cos, math.sin))
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return np.asarray(x @ y @ z, np.float64)


@njit(cache=True)
def clearance(x: float, y: float, boxes: Float, discs: Float, cap_m: float) -> float:
    """Distance [m] from a point to the nearest shape, at most ``cap_m``; 0 inside one."""
    best = cap_m
    for k in range(boxes.shape[0]):
        dx, dy = x - boxes[k, 0], y - boxes[k, 1]
        u = abs(boxes[k, 2] * dx + boxes[k, 3] * dy) - boxes[k, 4]
        v = abs(boxes[k, 2] * dy - boxes[k, 3] * dx) - boxes[k, 5]
        u, v = max(u, 0.0), max(v, 0.0)
        best = min(best, math.sqrt(u * u + v * v))
    for k in range(discs.shape[0]):
        dx, dy = x - discs[k, 0], y - discs[k, 1]
        best = min(best, max(0.0, math.sqrt(dx * dx + dy * dy) - discs[k, 2]))
    return best


@njit(cache=True)
def lower_clearance(
    grid: NDArray[np.float32], x0: float, y0: float, step: float, boxes: Float, discs: Float, cap_m: float
) -> None:
    """Lower every cell of a clearance grid (nx, ny) to its centre's distance to the shapes, where that is under ``cap_m``."""
    nx, ny = grid.shape
    for k in range(boxes.shape[0] + discs.shape[0]):
        if k < boxes.shape[0]:
            cx, cy, c, s, hx, hy = boxes[k, 0], boxes[k, 1], boxes[k, 2], boxes[k, 3], boxes[k, 4], boxes[k, 5]
            ex, ey = abs(c) * hx + abs(s) * hy + cap_m, abs(s) * hx + abs(c) * hy + cap_m
        else:
            m = k - boxes.shape[0]
            cx, cy, c, s, hx, hy = discs[m, 0], discs[m, 1], 1.0, 0.0, discs[m, 2], 0.0
            ex, ey = hx + cap_m, hx + cap_m
        i0, i1 = max(0, int((cx - ex - x0) / step)), min(nx, int((cx + ex - x0) / step) + 1)
        j0, j1 = max(0, int((cy - ey - y0) / step)), min(ny, int((cy + ey - y0) / step) + 1)
        for i in range(i0, i1):
            dx = x0 + (i + 0.5) * step - cx
            for j in range(j0, j1):
                dy = y0 + (j + 0.5) * step - cy
                if k < boxes.shape[0]:
                    u = max(abs(c * dx + s * dy) - hx, 0.0)
                    v = max(abs(c * dy - s * dx) - hy, 0.0)
                    distance = math.sqrt(u * u + v * v)
                else:
                    distance = max(0.0, math.sqrt(dx * dx + dy * dy) - hx)
                if distance < grid[i, j]:
                    grid[i, j] = distance
