"""Contact shadows: darker floor around what stands on it, so that things do not seem to hover."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import accumulate

import numpy as np

from spacevln.environments.houses.furniture.mesh import Array, Triangles, part_triangles
from spacevln.environments.houses.layout.structure import slabs
from spacevln.environments.houses.materials import material
from spacevln.environments.houses.plan import House, Item, Part, Rect
from spacevln.environments.houses.scene.pieces import Piece, flat_uv

_SHARES = (0.87, 0.74, 0.62)
"""How much of the floor's colour is left, from the outer to the inner ring."""
_RISE_M = 0.0006
"""Every ring lies this much over the one around it; the innermost is 1.8 mm over the floor."""
_TOUCHING: tuple[float, ...] = (0.12, 0.06, 0.02)
_LOW: tuple[float, ...] = (0.07, -0.01)
_HIGH: tuple[float, ...] = (0.02, -0.06)
"""How far the rings reach over the outline of what touches the floor, hangs low over it, or high [m]."""
_TOUCHING_M, _LOW_M, _HIGH_M = 0.03, 0.25, 1.0
_ROUND = ("disc", "turned", "column", "pot", "bucket", "vase")
_CORNER = tuple((math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in range(3))
_UNDER_M, _FOOT_M = 0.01, 0.07
"""How far a ring reaches under what hides the floor inside it; half the breadth under which a part is a foot."""

Outline = tuple[float, float, float, float, float, float]
"""Centre x and y, half width and depth, radius of the corners, breadth of the ring (0 = filled), in the item's frame [m]."""


def shadow_pieces(house: House) -> list[Piece]:
    """One piece per room and ring, of the floor's material in a darker tint."""
    ground: dict[int, list[Rect]] = defaultdict(list)
    for slab in slabs(house):
        if slab.part == "floor":
            ground[slab.room].append(slab.rect)
    rings: dict[tuple[int, int], list[Array]] = defaultdict(list)
    for item in house.items:
        if item.solid and abs(item.z - house.floors[house.rooms[item.room].floor].z_m) < _TOUCHING_M:
            for level, polygons in _rings(item.parts):
                rings[item.room, level] += _on_ground(polygons.placed(item), ground[item.room])
    return [
        _ring(polygons, house.floors[house.rooms[room].floor].z_m, house.styles[room][0], level, room)
        for (room, level), polygons in sorted(rings.items())
        if polygons
    ]


@dataclass(frozen=True, slots=True)
class _Polygons:
    """Convex polygons, counter-clockwise: all corners (N, 2), and where each polygon but the first begins."""

    corners: Array
    begins: tuple[int, ...]

    def placed(self, item: Item) -> _Polygons:
        """From an item's frame to the scene."""
        c, s = math.cos(item.yaw_rad), math.sin(item.yaw_rad)
        return _Polygons(self.corners @ np.array([[c, s], [-s, c]]) + (item.x, item.y), self.begins)

    def each(self) -> list[Array]:
        return [self.corners[i:j] for i, j in zip((0, *self.begins), (*self.begins, len(self.corners)), strict=True)]


@lru_cache(maxsize=2048)
def _rings(parts: tuple[Part, ...]) -> tuple[tuple[int, _Polygons], ...]:
    """What fills an item's outlines and their rings, by level, in the item's frame."""
    found: dict[int, list[Array]] = defaultdict(list)
    for level, outline in _outlines(parts):
        found[level] += _polygons(outline)
    return tuple(
        (level, _Polygons(np.concatenate(those), tuple(accumulate(len(one) for one in those[:-1]))))
        for level, those in found.items()
    )


def _outlines(parts: tuple[Part, ...]) -> tuple[tuple[int, Outline], ...]:
    """The rings of an item's parts by level, without those that lie within another of their level."""
    found: dict[int, list[Outline]] = defaultdict(list)
    for part in parts:
        points = part_triangles(part).points
        low, high = points.min(axis=0), points.max(axis=0)
        (x, y), (hx, hy) = (low[:2] + high[:2]) / 2, (high[:2] - low[:2]) / 2
        if low[2] < _TOUCHING_M and min(hx, hy) < _FOOT_M:
            # legs are many: two plain rectangles each keep drawing cheap
            found[0].append((float(x), float(y), float(hx) + 0.04, float(hy) + 0.04, 0.0, 0.0))
            found[1].append((float(x), float(y), float(hx) + 0.015, float(hy) + 0.015, 0.0, 0.0))
            continue
        if low[2] < _TOUCHING_M:
            reaches, most = _TOUCHING, min(1.0, max(0.3, min(hx, hy) / 0.12))
        elif low[2] < _LOW_M:
            reaches, most = _LOW, min(1.0, min(hx, hy) / 0.12)
        elif low[2] < _HIGH_M and min(hx, hy) > 0.15:
            reaches, most = _HIGH, 1.0
        else:
            continue
        for level, reach in enumerate(reaches):
            grown = reach * most
            a, b = float(hx) + grown, float(hy) + grown
            if min(a, b) > 0:
                upright = part.euler_rad == (0.0, 0.0, 0.0) and abs(hx - hy) < 0.03 * hx
                rounded = min(a, b) if upright and (part.shape == "cylinder" or part.mesh in _ROUND) else max(grown, 0.0)
                hidden = low[2] < _TOUCHING_M and part.shape in ("box", "cylinder") and not any(part.euler_rad)
                inner = reaches[level + 1] * most if level + 1 < len(reaches) else -_UNDER_M if hidden else grown
                found[level].append((float(x), float(y), a, b, rounded, grown - inner))
    return tuple((level, one) for level in sorted(found) for one in _largest(found[level]))


def _largest(outlines: list[Outline]) -> list[Outline]:
    """Those that no other one covers (round corners aside)."""
    kept: list[Outline] = []
    for one in sorted(set(outlines), key=lambda o: (-o[2] * o[3], o)):
        if not any(abs(one[0] - k[0]) + one[2] <= k[2] + 1e-6 and abs(one[1] - k[1]) + one[3] <= k[3] + 1e-6 for k in kept):
            kept.append(one)
    return kept


def _polygons(outline: Outline) -> list[Array]:
    """Convex polygons (N, 2) in the item's frame, counter-clockwise, that fill an outline or its ring."""
    x, y, a, b, radius, breadth = outline
    outer = _corners(x, y, a, b, radius, radius > 0.0)
    if breadth == 0.0 or min(a, b) - breadth < _UNDER_M:
        return [outer]
    inner = _corners(x, y, a - breadth, b - breadth, max(radius - breadth, 0.0), radius > 0.0)
    ends = [(k, (k + 1) % len(outer)) for k in range(len(outer))]
    return [np.stack([outer[k], outer[m], inner[m], inner[k]]) for k, m in ends]


def _corners(x: float, y: float, a: float, b: float, radius: float, rounded: bool) -> Array:
    """Corners (N, 2) of a rectangle, rounded or not, counter-clockwise."""
    corners = []
    for quarter, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for c, s in _CORNER if rounded else _CORNER[:1]:
            for _ in range(quarter):
                c, s = -s, c
            corners.append((x + sx * (a - radius) + c * radius, y + sy * (b - radius) + s * radius))
    return np.array(corners)


def _on_ground(polygons: _Polygons, ground: list[Rect]) -> list[Array]:
    """The parts of convex polygons on a room's floor: not in the next room, not over a stairwell."""
    (x0, y0), (x1, y1) = polygons.corners.min(axis=0), polygons.corners.max(axis=0)
    if any(rect.x0 <= x0 and x1 <= rect.x1 and rect.y0 <= y0 and y1 <= rect.y1 for rect in ground):
        return polygons.each()
    return [part for polygon in polygons.each() for part in _parts_on_ground(polygon, ground)]


def _parts_on_ground(polygon: Array, ground: list[Rect]) -> list[Array]:
    (x0, y0), (x1, y1) = polygon.min(axis=0).tolist(), polygon.max(axis=0).tolist()
    found = []
    for rect in ground:
        if rect.x0 <= x0 and x1 <= rect.x1 and rect.y0 <= y0 and y1 <= rect.y1:
            return [polygon]
        if x0 < rect.x1 and rect.x0 < x1 and y0 < rect.y1 and rect.y0 < y1:
            cut: list[list[float]] = polygon.tolist()  # numbers of Python: arrays this small are slower
            for axis, sign, limit, reach in (
                (0, -1, -rect.x0, -x0),
                (0, 1, rect.x1, x1),
                (1, -1, -rect.y0, -y0),
                (1, 1, rect.y1, y1),
            ):
                if reach > limit:
                    cut = _cut(cut, axis, sign, limit)
            if len(cut) >= 3:
                found.append(np.array(cut))
    return found


def _cut(polygon: list[list[float]], axis: int, sign: int, limit: float) -> list[list[float]]:
    """The part of a convex polygon where ``sign * coordinate <= limit``."""
    kept = []
    for k, q in enumerate(polygon):
        p = polygon[k - 1]
        over_p, over_q = sign * p[axis] - limit, sign * q[axis] - limit
        if (over_p < 0 < over_q) or (over_q < 0 < over_p):
            share = over_p / (over_p - over_q)
            kept.append([p[0] + (q[0] - p[0]) * share, p[1] + (q[1] - p[1]) * share])
        if over_q <= 0:
            kept.append(q)
    return kept


def _ring(polygons: list[Array], z_m: float, key: str, level: int, room: int) -> Piece:
    floor = material(key)
    red, green, blue = floor.rgb
    share = _SHARES[level]
    name = f"{key} shadow {level}"
    stuff = replace(floor, key=name, draw=name, rgb=(red * share, green * share, blue * share), specular=0.0)
    flat = np.concatenate(polygons)
    points = np.column_stack([flat, np.full(len(flat), z_m + (level + 1) * _RISE_M)])
    normals = np.tile((0.0, 0.0, 1.0), (len(points), 1))
    faces, first = [], 0
    for polygon in polygons:
        faces += [(first, first + k, first + k + 1) for k in range(1, len(polygon) - 1)]
        first += len(polygon)
    return Piece(Triangles(points, normals, flat_uv(points, normals, floor), np.array(faces, np.int32)), stuff, 0, room)
