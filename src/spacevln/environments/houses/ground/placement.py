"""Keeping a house walkable while it is furnished: every candidate is checked before it is put."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from spacevln.environments.houses.ground.footprints import box, lower_clearance
from spacevln.environments.houses.ground.walkable import RESOLUTION_M, FloorSpace, Walkable
from spacevln.environments.houses.layout.structure import hole, portion
from spacevln.environments.houses.plan import House, Opening, Rect, Room

DOOR_DEPTH_M = 0.7
OPENING_DEPTH_M = 0.5
LANDING_DEPTH_M = 0.9
_REACHED_SHARE = 0.7
_SMALLEST_M2 = 0.3
_TOUCH_M = 0.02

Footprint = Rect | NDArray[np.float64]
"""An axis-aligned rectangle, or the corners (4, 2) of an oriented one, in order around it."""


class PlacementGuard:
    """Accepts solid footprints as long as every room stays usable.

    A room stays usable when all its doors, openings and stair ends are joined inside it for a disc of ``clearance_m``, nothing
    solid stands before them, and the joined space holds at least 0.3 m2 and 70 % of the standing room that is left (no
    pocket is fenced off). As this holds for every room, the whole house stays connected.

    Args:
        house: the items that it already has are respected.
        clearance_m: radius of the disc, at least the agent's.
    """

    def __init__(self, house: House, clearance_m: float = 0.25) -> None:
        self._house = house
        self._clearance_m = clearance_m
        self._spaces = Walkable(house).floors
        self._keep: dict[int, list[Rect]] = {room.id: [] for room in house.rooms}
        self._gates: dict[int, list[tuple[int, int]]] = {room.id: [] for room in house.rooms}
        for opening in house.openings:
            if opening.kind != "window":
                for room_id in opening.rooms:
                    if room_id is not None:
                        self._add_gate(house.rooms[room_id], opening)
        for stairs in house.stairs:
            length = max(stairs.rect.width, stairs.rect.depth)
            share = LANDING_DEPTH_M / length
            for floor, ends in ((stairs.lower_floor, (-share, 0.0)), (stairs.lower_floor + 1, (1.0, 1.0 + share))):
                landing = portion(stairs, *ends)
                room = house.room_at(*landing.centre, floor)
                if room is not None:
                    self._keep[room.id] += [landing, stairs.rect]
                    self._gates[room.id].append(self._spaces[floor].cell(*landing.centre))

    def kept_free(self, room_id: int) -> tuple[Rect, ...]:
        """Where nothing solid may stand in a room: before its doors and openings, on stairs and landings."""
        return tuple(self._keep[room_id])

    def try_add(self, footprints: Footprint | Sequence[Footprint], room_id: int) -> bool:
        """Put solid things down together if they lie in the room and it stays usable; else nothing changes.

        Args:
            footprints: of one thing or of several that belong together (a table and its chairs).
            room_id: where they stand.
        """
        group = [footprints] if isinstance(footprints, (Rect, np.ndarray)) else list(footprints)
        shapes = np.array([_oriented(shape) for shape in group], np.float64).reshape(-1, 6)
        keep = np.array([box(rect) for rect in self._keep[room_id]], np.float64).reshape(-1, 6)
        if _overlap(shapes, keep):
            return False
        room = self._house.rooms[room_id]
        if not all(room.contains(x, y, -_TOUCH_M) for shape in shapes for x, y in _corners(shape)):
            return False
        space = self._spaces[room.floor]
        i0, j0, window = self._window(space, room)
        trial = window.copy()
        x0, y0 = space.origin_m[0] + i0 * RESOLUTION_M, space.origin_m[1] + j0 * RESOLUTION_M
        lower_clearance(trial, x0, y0, RESOLUTION_M, shapes, np.zeros((0, 3)), self._clearance_m + 0.05)
        if not self._usable(space, room, trial, i0, j0):
            return False
        window[...] = trial
        return True

    def _usable(self, space: FloorSpace, room: Room, trial: NDArray[np.float32], i0: int, j0: int) -> bool:
        own = np.zeros(trial.shape, np.bool_)
        for rect in room.rects:
            rows, columns = space.cells_of(rect)
            own[rows.start - i0 : rows.stop - i0, columns.start - j0 : columns.stop - j0] = True
        free = own & (trial >= self._clearance_m)
        gates = np.array([(i - i0, j - j0) for i, j in self._gates[room.id]], np.int64).reshape(-1, 2)
        if len(gates) == 0:
            return True
        reached, joined = _flood(free, gates)
        total = int(free.sum())
        return bool(
            joined and reached * RESOLUTION_M**2 >= min(_SMALLEST_M2, room.area / 8) and reached >= _REACHED_SHARE * total
        )

    def _window(self, space: FloorSpace, room: Room) -> tuple[int, int, NDArray[np.float32]]:
        """The part of the storey's clearance grid (a view) around a room."""
        i0, j0 = space.cell(min(r.x0 for r in room.rects), min(r.y0 for r in room.rects))
        i1, j1 = space.cell(max(r.x1 for r in room.rects), max(r.y1 for r in room.rects))
        return i0 - 1, j0 - 1, space.clearance_m[i0 - 1 : i1 + 2, j0 - 1 : j1 + 2]

    def _add_gate(self, room: Room, opening: Opening) -> None:
        """The zone before a hole on the room's side, and the cell in its middle just inside the room."""
        depth = DOOR_DEPTH_M if opening.kind == "doorway" else OPENING_DEPTH_M
        rect, half = hole(self._house, opening), self._house.wall_thickness_m / 2
        for sign in (-1, 1):
            x = opening.x + (sign * (half + 0.1) if opening.along == "y" else 0.0)
            y = opening.y + (sign * (half + 0.1) if opening.along == "x" else 0.0)
            if not room.contains(x, y):
                continue
            low, high = (-depth, 0.0) if sign < 0 else (0.0, depth)
            if opening.along == "x":
                edge = opening.y + sign * half
                self._keep[room.id].append(Rect(rect.x0, edge + low, rect.x1, edge + high))
            else:
                edge = opening.x + sign * half
                self._keep[room.id].append(Rect(edge + low, rect.y0, edge + high, rect.y1))
            self._gates[room.id].append(self._spaces[room.floor].cell(x, y))
            return


def _oriented(shape: Footprint) -> tuple[float, float, float, float, float, float]:
    if isinstance(shape, Rect):
        return box(shape)
    a, b, c = shape[0], shape[1], shape[2]
    width, depth = math.dist(a, b), math.dist(b, c)
    x, y = (a + c) / 2
    return float(x), float(y), float(b[0] - a[0]) / width, float(b[1] - a[1]) / width, width / 2, depth / 2


def _corners(shape: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Corners of an oriented box."""
    x, y, c, s, hx, hy = shape.tolist()
    return [(x + c * u - s * v, y + s * u + c * v) for u in (-hx, hx) for v in (-hy, hy)]


@njit(cache=True)
def _overlap(shapes: NDArray[np.float64], zones: NDArray[np.float64]) -> bool:
    """Whether any of some oriented boxes overlaps any of others (separating axes)."""
    for i in range(len(shapes)):
        for j in range(len(zones)):
            a, b, apart = shapes[i], zones[j], False
            for c, s in ((a[2], a[3]), (-a[3], a[2]), (b[2], b[3]), (-b[3], b[2])):
                reach = abs(a[2] * c + a[3] * s) * a[4] + abs(a[2] * s - a[3] * c) * a[5]
                reach += abs(b[2] * c + b[3] * s) * b[4] + abs(b[2] * s - b[3] * c) * b[5]
                apart = apart or abs((b[0] - a[0]) * c + (b[1] - a[1]) * s) >= reach - 1e-6
            if not apart:
                return True
    return False


@njit(cache=True)
def _flood(free: NDArray[np.bool_], gates: NDArray[np.int64]) -> tuple[int, bool]:
    """Number of free cells joined (4 neighbours) to the first gate, and whether that includes all gates."""
    nx, ny = free.shape
    seen = np.zeros((nx, ny), np.bool_)
    stack = np.empty((nx * ny, 2), np.int64)
    i, j = gates[0]
    if not (0 <= i < nx and 0 <= j < ny and free[i, j]):
        return 0, False
    seen[i, j] = True
    stack[0, 0], stack[0, 1] = i, j
    top, count = 1, 0
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        count += 1
        for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            a, b = i + di, j + dj
            if 0 <= a < nx and 0 <= b < ny and free[a, b] and not seen[a, b]:
                seen[a, b] = True
                stack[top, 0], stack[top, 1] = a, b
                top += 1
    for k in range(gates.shape[0]):
        i, j = gates[k]
        if not (0 <= i < nx and 0 <= j < ny and seen[i, j]):
            return count, False
    return count, True
