"""Where the agent may stand: exact ground truth from the house's geometry, per storey, stairs as a ramp."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from spacevln.core.errors import UsageError
from spacevln.environments.houses.ground.footprints import clearance, item_shapes, lower_clearance, wall_shapes
from spacevln.environments.houses.layout.structure import direction, hole, portion
from spacevln.environments.houses.plan import House, Rect, Stairs

AGENT_RADIUS_M = 0.1
RESOLUTION_M = 0.05
CAP_M = 0.6
"""Clearances are known up to this distance."""
_MARGIN_M = 0.4
_OFF_GROUND_M = 0.6
_SMALLEST_STANDING_M2 = 0.15

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class FloorSpace:
    """The ground truth of one storey; the half of a flight next to it belongs to it.

    Args:
        index: storey.
        origin_m: (x, y) of the grid's corner; cell (i, j) covers x from origin + i * RESOLUTION_M, y likewise with j.
        clearance_m: (nx, ny) float32, distance of every cell's centre to the nearest obstacle, at most CAP_M; 0 outdoors.
        boxes: (N, 6) obstacles: centre x, y, cos, sin of the orientation, half extents.
        discs: (M, 3) obstacles: centre x, y, radius.
    """

    index: int
    origin_m: tuple[float, float]
    clearance_m: NDArray[np.float32]
    boxes: Float
    discs: Float

    def free(self, radius_m: float = AGENT_RADIUS_M) -> Bool:
        """Cells (nx, ny) on whose centre a disc of this radius may stand."""
        return np.asarray(self.clearance_m >= radius_m, np.bool_)

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """The cell of a point; may lie outside the grid."""
        return math.floor((x - self.origin_m[0]) / RESOLUTION_M), math.floor((y - self.origin_m[1]) / RESOLUTION_M)

    def centre(self, i: int, j: int) -> tuple[float, float]:
        """Centre (x, y) of a cell [m]."""
        return self.origin_m[0] + (i + 0.5) * RESOLUTION_M, self.origin_m[1] + (j + 0.5) * RESOLUTION_M

    def cells_of(self, rect: Rect) -> tuple[slice, slice]:
        """Slices of the cells whose centre lies in a rectangle."""
        i0, j0 = ((v - o) / RESOLUTION_M - 0.5 for v, o in zip((rect.x0, rect.y0), self.origin_m, strict=True))
        i1, j1 = ((v - o) / RESOLUTION_M - 0.5 for v, o in zip((rect.x1, rect.y1), self.origin_m, strict=True))
        nx, ny = self.clearance_m.shape
        return (
            slice(min(max(0, math.ceil(i0 - 1e-9)), nx), min(max(0, math.floor(i1 + 1e-9) + 1), nx)),
            slice(min(max(0, math.ceil(j0 - 1e-9)), ny), min(max(0, math.floor(j1 + 1e-9) + 1), ny)),
        )


class Walkable:
    """Exact walkable space of a house for a disc that moves on its floors and stairs.

    Args:
        house: with or without furniture. An item's parts block where they lie between 0.05 and 0.95 m above the floor.
    """

    def __init__(self, house: House) -> None:
        self.house = house
        self._regions = tuple(self._regions_of(floor.index) for floor in house.floors)
        self.floors = tuple(self._floor(floor.index) for floor in house.floors)

    def _floor(self, index: int) -> FloorSpace:
        house = self.house
        rects = [rect for room in house.rooms for rect in room.rects]
        x0, y0 = min(r.x0 for r in rects) - _MARGIN_M, min(r.y0 for r in rects) - _MARGIN_M
        nx = math.ceil((max(r.x1 for r in rects) + _MARGIN_M - x0) / RESOLUTION_M)
        ny = math.ceil((max(r.y1 for r in rects) + _MARGIN_M - y0) / RESOLUTION_M)
        items = [item for item in house.items if item.floor == index]
        boxes, discs = item_shapes(items, house.floors[index].z_m)
        boxes = np.concatenate([wall_shapes(house, index), boxes])
        space = FloorSpace(index, (x0, y0), np.zeros((nx, ny), np.float32), boxes, discs)
        for region in self._regions[index]:
            space.clearance_m[space.cells_of(region)] = CAP_M
        for stairs in house.stairs:
            for share in self._foreign(stairs, index):
                space.clearance_m[space.cells_of(share)] = 0.0
        lower_clearance(space.clearance_m, x0, y0, RESOLUTION_M, boxes, discs, CAP_M)
        return space

    def _regions_of(self, floor: int) -> list[Rect]:
        """Rectangles that together are the storey's floor, door sills included."""
        rooms = [rect for room in self.house.rooms if room.floor == floor for rect in room.rects]
        sills = [opening for opening in self.house.openings if opening.floor == floor and opening.kind != "window"]
        return rooms + [_through(hole(self.house, opening), opening.along) for opening in sills]

    @staticmethod
    def _foreign(stairs: Stairs, floor: int) -> list[Rect]:
        """The half of a flight that belongs to the other storey."""
        if floor == stairs.lower_floor:
            return [portion(stairs, 0.5, 1.0)]
        return [portion(stairs, 0.0, 0.5)] if floor == stairs.lower_floor + 1 else []

    def stairs_at(self, x: float, y: float, z: float) -> Stairs | None:
        """The flight whose steps a point lies on."""
        for stairs in self.house.stairs:
            low, high = (self.house.floors[stairs.lower_floor + k].z_m for k in (0, 1))
            if stairs.rect.contains(x, y) and low - 0.5 <= z <= high + 0.5:
                return stairs
        return None

    def climb(self, stairs: Stairs, x: float, y: float) -> float:
        """Share of the flight climbed at a point, 0 at the foot, 1 at the head."""
        ux, uy = direction(stairs)
        r = stairs.rect
        if ux:
            return (x - r.x0) / r.width if ux > 0 else (r.x1 - x) / r.width
        return (y - r.y0) / r.depth if uy > 0 else (r.y1 - y) / r.depth

    def floor_index(self, x: float, y: float, floor_hint_z: float) -> int:
        """The storey that a point belongs to; a flight is shared half and half."""
        stairs = self.stairs_at(x, y, floor_hint_z)
        if stairs is not None:
            return stairs.lower_floor + int(self.climb(stairs, x, y) >= 0.5)
        return min(self.house.floors, key=lambda floor: abs(floor.z_m - floor_hint_z)).index

    def floor_height_m(self, x: float, y: float, floor_hint_z: float) -> float:
        """Height of the ground at a point, scene frame [m]: the nearest storey's floor, on stairs the ramp through the steps."""
        stairs = self.stairs_at(x, y, floor_hint_z)
        if stairs is None:
            return self.house.floors[self.floor_index(x, y, floor_hint_z)].z_m
        low, high = (self.house.floors[stairs.lower_floor + k].z_m for k in (0, 1))
        return low + (high - low) * min(1.0, max(0.0, self.climb(stairs, x, y)))

    def space_at(self, x: float, y: float, z: float) -> FloorSpace:
        """The storey's space for a point at feet height ``z``."""
        return self.floors[self.floor_index(x, y, z)]

    def clearance_m(self, x: float, y: float, z: float) -> float:
        """Exact distance to the nearest obstacle, at most CAP_M; 0 outdoors and in the air over stairs."""
        space = self.space_at(x, y, z)
        if self.stairs_at(x, y, z) is not None:
            if abs(self.floor_height_m(x, y, z) - z) > _OFF_GROUND_M:
                return 0.0
        elif not any(rect.contains(x, y) for rect in self._regions[space.index]):
            return 0.0
        return float(clearance(x, y, space.boxes, space.discs, CAP_M))

    def is_walkable(self, x: float, y: float, z: float, radius: float = AGENT_RADIUS_M) -> bool:
        """Whether a disc of this radius may stand with its centre here.

        Raises:
            UsageError: the radius is larger than CAP_M.
        """
        if not 0.0 <= radius <= CAP_M:
            raise UsageError(f"A radius of {radius} m cannot be checked: give one from 0 to {CAP_M} m.")
        return self.clearance_m(x, y, z) >= max(radius - 1e-9, 1e-9)

    def components(self, radius_m: float) -> list[NDArray[np.int32]]:
        """Per storey the number (from 1) of the connected free region of every cell; flights join regions of two storeys."""
        labelled, offset = [], 0
        for space in self.floors:
            labels, count = ndimage.label(space.free(radius_m), np.ones((3, 3)))
            labelled.append(np.where(labels > 0, labels + offset, 0).astype(np.int32))
            offset += int(count)
        for stairs in self.house.stairs:
            low, high = (labelled[stairs.lower_floor + k] for k in (0, 1))
            middle = portion(stairs, 0.5, 0.5).centre
            ux, uy = direction(stairs)
            ends = [self.floors[0].cell(middle[0] + side * 0.06 * ux, middle[1] + side * 0.06 * uy) for side in (-1, 1)]
            a, b = int(low[ends[0]]), int(high[ends[1]])
            if a and b:
                high[high == b] = a
        return labelled

    def unreachable_rooms(self, clearance_m: float = 0.25) -> tuple[int, ...]:
        """Ids of the rooms in which the house's main region leaves no standing room (0.15 m2) for a disc of this radius."""
        labels = self.components(clearance_m)
        sizes = np.bincount(np.concatenate([grid.ravel() for grid in labels]))
        sizes[0] = 0
        main = int(sizes.argmax())
        enough = _SMALLEST_STANDING_M2 / RESOLUTION_M**2
        found = []
        for room in self.house.rooms:
            cells = sum(int((labels[room.floor][self.floors[room.floor].cells_of(rect)] == main).sum()) for rect in room.rects)
            if sizes[main] == 0 or cells < enough:
                found.append(room.id)
        return tuple(found)


def _through(sill: Rect, along: str) -> Rect:
    """A hole's footprint a little longer through the wall, so that it overlaps both rooms."""
    dx, dy = (0.01, 0.0) if along == "y" else (0.0, 0.01)
    return Rect(sill.x0 - dx, sill.y0 - dy, sill.x1 + dx, sill.y1 + dy)


def clearance_connected(house: House, clearance_m: float = 0.25) -> bool:
    """Whether every room is reached from every other with this much clearance around the agent's centre."""
    return not Walkable(house).unreachable_rooms(clearance_m)
