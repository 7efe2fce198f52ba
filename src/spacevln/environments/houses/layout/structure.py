"""The solid geometry of a house, the same for drawing and for walking: walls with their holes, slabs, steps, railings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from spacevln.environments.houses.plan import Floor, House, Opening, Rect, Room, Stairs

RAIL_M = 0.05
"""Thickness of a railing, outside the footprint of the steps."""
RAIL_HEIGHT_M = 0.95
PARAPET_M = 1.0
_SLAB_M = 0.05

WallPart = Literal["wall", "header", "sill", "parapet"]


@dataclass(frozen=True, slots=True)
class WallBox:
    """A solid box of a wall: one half of its thickness, so that each face shows its own room's style.

    Args:
        floor: storey.
        rect: footprint [m].
        z0_m, z1_m: lower and upper end, scene frame.
        room: id of the room that sees it; None for the outer skin.
        part: a whole wall, above or below a hole, or the low wall of a balcony.
        opening: id of the hole above or below which it lies; None for a whole wall.
    """

    floor: int
    rect: Rect
    z0_m: float
    z1_m: float
    room: int | None
    part: WallPart
    opening: int | None = None


@dataclass(frozen=True, slots=True)
class SlabBox:
    """A box of a floor or ceiling; reaches to the middle lines of the walls, without the stairwell."""

    floor: int
    rect: Rect
    z0_m: float
    z1_m: float
    room: int
    part: Literal["floor", "ceiling"]


@dataclass(frozen=True, slots=True)
class StepBox:
    """A step, solid down to the lower floor."""

    stairs: int
    rect: Rect
    z0_m: float
    z1_m: float


@dataclass(frozen=True, slots=True)
class Railing:
    """A railing over the base line from ``a`` to ``b`` (x, y, z), ``height_m`` high, ``RAIL_M`` thick.

    Args:
        floor: storey on which it blocks the way.
        rect: footprint [m].
    """

    floor: int
    rect: Rect
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    height_m: float = RAIL_HEIGHT_M


def grown(rect: Rect, margin_m: float) -> Rect:
    """The rectangle grown on all sides."""
    return Rect(rect.x0 - margin_m, rect.y0 - margin_m, rect.x1 + margin_m, rect.y1 + margin_m)


def hole(house: House, opening: Opening) -> Rect:
    """Footprint of an opening through the whole thickness of its wall."""
    return _hole(opening, house.wall_thickness_m)


def _hole(opening: Opening, thickness_m: float) -> Rect:
    along, across = opening.width_m / 2, thickness_m / 2
    if opening.along == "x":
        return Rect(opening.x - along, opening.y - across, opening.x + along, opening.y + across)
    return Rect(opening.x - across, opening.y - along, opening.x + across, opening.y + along)


def walls(house: House) -> tuple[tuple[WallBox, ...], ...]:
    """Solid boxes of all walls per storey, holes cut out: beside, above and below every opening."""
    return tuple(walls_of(house, floor.index) for floor in house.floors)


def walls_of(house: House, floor: int) -> tuple[WallBox, ...]:
    """The walls of one storey, as in :func:`walls`."""
    rooms = tuple(room for room in house.rooms if room.floor == floor)
    openings = tuple(opening for opening in house.openings if opening.floor == floor)
    return _walls(house.floors[floor], rooms, openings, house.wall_thickness_m)


@lru_cache(maxsize=8)  # furnishing and drawing a house want the same
def _walls(storey: Floor, rooms: tuple[Room, ...], openings: tuple[Opening, ...], thickness_m: float) -> tuple[WallBox, ...]:
    z0, ceiling = storey.z_m, storey.ceiling_m
    raster = _Raster(rooms, [_hole(opening, thickness_m) for opening in openings], thickness_m)
    labels, low, holes = raster.labels, raster.low, raster.holes
    found = list[WallBox]()

    def fill(mask: NDArray[np.bool_], *parts: tuple[float, float, WallPart], opening: int | None = None) -> None:
        for rect, label in raster.boxes((labels != raster.EMPTY) & mask, labels):
            for low_m, high_m, part in parts:
                if high_m > low_m:
                    found.append(WallBox(storey.index, rect, z0 + low_m, z0 + high_m, raster.room(label), part, opening))

    fill((holes < 0) & ~low, (0.0, ceiling, "wall"))
    fill((holes < 0) & low, (0.0, PARAPET_M, "parapet"))
    for k, opening in enumerate(openings):
        fill(holes == k, (0.0, opening.sill_m, "sill"), (opening.head_m, ceiling, "header"), opening=opening.id)
    return tuple(found)


class _Raster:
    """A storey on the raster of all its edges: which wall half belongs to which room."""

    EMPTY = -2
    SKIN = -1

    def __init__(self, rooms: Sequence[Room], holes: list[Rect], thickness_m: float) -> None:
        half = thickness_m / 2
        rects = [rect for room in rooms for rect in room.rects]
        xs = {round(x + d, 3) for r in rects for x in (r.x0, r.x1) for d in (-2 * half, -half, 0.0, half, 2 * half)}
        ys = {round(y + d, 3) for r in rects for y in (r.y0, r.y1) for d in (-2 * half, -half, 0.0, half, 2 * half)}
        self.x = np.array(sorted(xs | {round(x, 3) for r in holes for x in (r.x0, r.x1)}))
        self.y = np.array(sorted(ys | {round(y, 3) for r in holes for y in (r.y0, r.y1)}))
        shape = (len(self.x) - 1, len(self.y) - 1)
        self.labels = np.full(shape, self.EMPTY, np.int64)
        self.holes = np.full(shape, -1, np.int64)
        indoor, outdoor = np.zeros(shape, bool), np.zeros(shape, bool)
        for rect in rects:
            self.labels[self._cells(grown(rect, 2 * half))] = self.SKIN
        for room in rooms:
            for rect in room.rects:
                self.labels[self._cells(grown(rect, half))] = room.id
                (outdoor if room.type == "balcony" else indoor)[self._cells(grown(rect, 2 * half))] = True
        for rect in rects:
            self.labels[self._cells(rect)] = self.EMPTY
        for k, rect in enumerate(holes):
            self.holes[self._cells(rect)] = k
        self.low = outdoor & ~indoor

    def _cells(self, rect: Rect) -> tuple[slice, slice]:
        i0, i1 = np.searchsorted(self.x, [rect.x0 - 5e-4, rect.x1 - 5e-4])
        j0, j1 = np.searchsorted(self.y, [rect.y0 - 5e-4, rect.y1 - 5e-4])
        return slice(int(i0), int(i1)), slice(int(j0), int(j1))

    def room(self, label: int) -> int | None:
        """Room id of a label; None for the outer skin."""
        return None if label == self.SKIN else label

    def boxes(self, mask: NDArray[np.bool_], labels: NDArray[np.int64]) -> Iterator[tuple[Rect, int]]:
        """Disjoint rectangles that cover the mask, each within one label."""
        left = mask.copy()
        for i, j in np.argwhere(mask).tolist():
            if not left[i, j]:
                continue
            label = labels[i, j]
            same = left & (labels == label)
            i1, j1 = i + 1, j + 1
            while j1 < left.shape[1] and same[i, j1]:
                j1 += 1
            while i1 < left.shape[0] and same[i1, j:j1].all():
                i1 += 1
            if i1 == i + 1 or (self.y[j1] - self.y[j]) < (self.x[i1] - self.x[i]):
                i1, j1 = _tall_first(same, i, j, (i1, j1), self.x, self.y)
            left[i:i1, j:j1] = False
            yield Rect(float(self.x[i]), float(self.y[j]), float(self.x[i1]), float(self.y[j1])), int(label)


def _tall_first(
    same: NDArray[np.bool_], i: int, j: int, other: tuple[int, int], x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[int, int]:
    """The larger one of a rectangle and the one that is grown along x first."""
    i1, j1 = i + 1, j + 1
    while i1 < same.shape[0] and same[i1, j]:
        i1 += 1
    while j1 < same.shape[1] and same[i:i1, j1].all():
        j1 += 1
    area = (x[i1] - x[i]) * (y[j1] - y[j])
    return (i1, j1) if area > (x[other[0]] - x[i]) * (y[other[1]] - y[j]) else other


def slabs(house: House) -> tuple[SlabBox, ...]:
    """Floors and ceilings of all rooms; balconies have no ceiling, stairs cut a well."""
    found: list[SlabBox] = []
    for room in house.rooms:
        floor = house.floors[room.floor]
        below = [stairs.rect for stairs in house.stairs if stairs.lower_floor + 1 == room.floor]
        above = [stairs.rect for stairs in house.stairs if stairs.lower_floor == room.floor]
        top = floor.z_m + floor.ceiling_m
        thick = (
            floor.z_m - house.floors[room.floor - 1].z_m - house.floors[room.floor - 1].ceiling_m - _SLAB_M if room.floor else 0.1
        )
        done: list[Rect] = []
        for rect in room.rects:
            whole = without([grown(rect, house.wall_thickness_m / 2)], done)
            done.append(grown(rect, house.wall_thickness_m / 2))
            found += [
                SlabBox(room.floor, piece, floor.z_m - thick, floor.z_m, room.id, "floor") for piece in without(whole, below)
            ]
            if room.type != "balcony":
                found += [SlabBox(room.floor, piece, top, top + _SLAB_M, room.id, "ceiling") for piece in without(whole, above)]
    return tuple(found)


def without(rects: list[Rect], cuts: list[Rect]) -> list[Rect]:
    """Disjoint rectangles that cover ``rects`` minus ``cuts``."""
    for cut in cuts:
        left: list[Rect] = []
        for r in rects:
            if cut.x0 >= r.x1 or cut.x1 <= r.x0 or cut.y0 >= r.y1 or cut.y1 <= r.y0:
                left.append(r)
                continue
            y0, y1 = max(r.y0, cut.y0), min(r.y1, cut.y1)
            left += [
                Rect(r.x0, r.y0, r.x1, y0),
                Rect(r.x0, y1, r.x1, r.y1),
                Rect(r.x0, y0, cut.x0, y1),
                Rect(cut.x1, y0, r.x1, y1),
            ]
        rects = [r for r in left if r.x1 - r.x0 > 1e-6 and r.y1 - r.y0 > 1e-6]
    return rects


def direction(stairs: Stairs) -> tuple[int, int]:
    """Unit vector of the climb."""
    return round(math.cos(stairs.up_yaw_rad)), round(math.sin(stairs.up_yaw_rad))


def portion(stairs: Stairs, start: float, end: float) -> Rect:
    """The part of the footprint between two shares of the climb (0 at the foot, 1 at the head)."""
    ux, uy = direction(stairs)
    r = stairs.rect
    if ux:
        a, b = (r.x0, r.width) if ux > 0 else (r.x1, -r.width)
        return Rect(min(a + start * b, a + end * b), r.y0, max(a + start * b, a + end * b), r.y1)
    a, b = (r.y0, r.depth) if uy > 0 else (r.y1, -r.depth)
    return Rect(r.x0, min(a + start * b, a + end * b), r.x1, max(a + start * b, a + end * b))


def steps(house: House, stairs: Stairs) -> tuple[StepBox, ...]:
    """The steps: as many equal treads as risers; the last one is flush with the upper floor."""
    low, high = house.floors[stairs.lower_floor].z_m, house.floors[stairs.lower_floor + 1].z_m
    n = stairs.steps
    return tuple(StepBox(stairs.id, portion(stairs, k / n, (k + 1) / n), low, low + (high - low) * (k + 1) / n) for k in range(n))


def railings(house: House) -> tuple[Railing, ...]:
    """Railings along the open sides of the steps (lower floor, sloping) and around the well (upper floor).

    The sides of the steps block the way from the lower floor, and at the head end the flight itself does; around the well
    only the head is open.
    """
    found: list[Railing] = []
    for stairs in house.stairs:
        low, high = house.floors[stairs.lower_floor].z_m, house.floors[stairs.lower_floor + 1].z_m
        for side in _sides(stairs):
            centre = side.centre
            if house.room_at(*centre, stairs.lower_floor) is None:
                continue
            a, b = _line(stairs, side)
            found.append(Railing(stairs.lower_floor, side, (*a, low), (*b, high)))
            found.append(Railing(stairs.lower_floor + 1, side, (*a, high), (*b, high)))
        foot = _edge(stairs, at_head=False)
        a, b = _ends(foot)
        found.append(Railing(stairs.lower_floor + 1, foot, (*a, high), (*b, high)))
    return tuple(found)


def head_block(stairs: Stairs) -> Rect:
    """The end face of the flight on the lower floor, as thick as a railing."""
    return _edge(stairs, at_head=True)


def _sides(stairs: Stairs) -> tuple[Rect, Rect]:
    r = stairs.rect
    if direction(stairs)[0]:
        return Rect(r.x0, r.y0 - RAIL_M, r.x1, r.y0), Rect(r.x0, r.y1, r.x1, r.y1 + RAIL_M)
    return Rect(r.x0 - RAIL_M, r.y0, r.x0, r.y1), Rect(r.x1, r.y0, r.x1 + RAIL_M, r.y1)


def _edge(stairs: Stairs, at_head: bool) -> Rect:
    """The strip just outside the foot or head end, railings' corners included."""
    length = stairs.rect.width if direction(stairs)[0] else stairs.rect.depth
    thin = RAIL_M / length
    strip = portion(stairs, 1.0, 1.0 + thin) if at_head else portion(stairs, -thin, 0.0)
    if direction(stairs)[0]:
        return Rect(strip.x0, strip.y0 - RAIL_M, strip.x1, strip.y1 + RAIL_M)
    return Rect(strip.x0 - RAIL_M, strip.y0, strip.x1 + RAIL_M, strip.y1)


def _line(stairs: Stairs, side: Rect) -> tuple[tuple[float, float], tuple[float, float]]:
    """Middle line of a side railing, from foot to head."""
    a, b = _ends(side)
    ux, uy = direction(stairs)
    return (a, b) if ux + uy > 0 else (b, a)


def _ends(rect: Rect) -> tuple[tuple[float, float], tuple[float, float]]:
    x, y = rect.centre
    return ((rect.x0, y), (rect.x1, y)) if rect.width >= rect.depth else ((x, rect.y0), (x, rect.y1))
