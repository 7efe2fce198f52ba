"""The unfinished plan: cells on the walls' middle lines, and how large rooms of each type are."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from spacevln.environments.houses.plan import Rect

WALL_M = 0.12
"""Thickness of every wall."""
MIN_ROOMS, MAX_ROOMS = 4, 14

ROOM_TYPES = (
    "balcony",
    "bathroom",
    "bedroom",
    "closet",
    "dining room",
    "garage",
    "gym",
    "hallway",
    "kitchen",
    "laundry room",
    "library",
    "living room",
    "office",
    "playroom",
)
"""Every type that :func:`generate_layout` gives to a room."""


@dataclass(frozen=True, slots=True)
class SizeRule:
    """How large a room of a type may be, clear of walls.

    Args:
        side_m: smallest and largest shorter side.
        area_m2: smallest and largest area.
        aspect: largest ratio of the sides.
    """

    side_m: tuple[float, float]
    area_m2: tuple[float, float]
    aspect: float


SIZES = {
    "balcony": SizeRule((1.3, 2.2), (4.0, 11.0), 4.0),
    "bathroom": SizeRule((1.7, 3.0), (3.9, 9.5), 2.1),
    "bedroom": SizeRule((2.7, 4.8), (9.0, 22.0), 1.75),
    "closet": SizeRule((1.45, 2.4), (2.4, 5.5), 2.1),
    "dining room": SizeRule((2.8, 4.8), (9.5, 21.0), 1.8),
    "garage": SizeRule((3.0, 6.2), (16.0, 38.0), 2.0),
    "gym": SizeRule((2.8, 4.8), (9.5, 22.0), 1.8),
    "kitchen": SizeRule((2.6, 4.8), (8.5, 20.0), 2.0),
    "laundry room": SizeRule((1.7, 3.2), (3.6, 9.0), 2.1),
    "library": SizeRule((2.7, 4.8), (9.0, 22.0), 1.8),
    "living room": SizeRule((3.6, 6.5), (16.0, 38.0), 1.8),
    "office": SizeRule((2.5, 4.2), (7.5, 16.0), 1.8),
    "playroom": SizeRule((2.8, 4.8), (9.5, 22.0), 1.8),
}


@dataclass(frozen=True, slots=True)
class Cell:
    """A room to be: its rectangles reach to the middle lines of the walls.

    Args:
        type: room type.
        rects: more than one for a bent hallway.
        owner: index (in the draft) of the only room that it opens to; None for a room off a hallway or open plan.
    """

    type: str
    rects: tuple[Rect, ...]
    floor: int = 0
    owner: int | None = None


@dataclass(frozen=True, slots=True)
class Flight:
    """Stairs to be: footprint of the steps and the direction of the climb."""

    rect: Rect
    up: tuple[int, int]
    steps: int


@dataclass(slots=True)
class Draft:
    """Cells of all floors and the flight of stairs, if any."""

    cells: list[Cell] = field(default_factory=list)
    flight: Flight | None = None

    def add(self, type_: str, *rects: Rect, floor: int = 0, owner: int | None = None) -> int:
        """Append a cell and return its index."""
        self.cells.append(Cell(type_, tuple(rects), floor, owner))
        return len(self.cells) - 1

    def on_floor(self, floor: int) -> list[int]:
        """Indices of the cells of a storey."""
        return [index for index, cell in enumerate(self.cells) if cell.floor == floor]

    def index_of(self, type_: str, floor: int = 0) -> int:
        """Index of a storey's first cell of a type, which must be there."""
        return next(index for index in self.on_floor(floor) if self.cells[index].type == type_)

    def hub(self, floor: int = 0) -> int:
        """Index of the cell that the others of a storey open to: the hallway, in a home without one the living room."""
        halls = any(self.cells[index].type == "hallway" for index in self.on_floor(floor))
        return self.index_of("hallway" if halls else "living room", floor)

    def mapped(self, flip_x: bool, flip_y: bool, transpose: bool) -> Draft:
        """The draft mirrored, transposed, and moved so that it begins at (0, 0)."""
        x0 = min(rect.x0 for cell in self.cells for rect in cell.rects)
        y0 = min(rect.y0 for cell in self.cells for rect in cell.rects)
        x1 = max(rect.x1 for cell in self.cells for rect in cell.rects)
        y1 = max(rect.y1 for cell in self.cells for rect in cell.rects)

        def turn(rect: Rect) -> Rect:
            xs = (x1 - rect.x1, x1 - rect.x0) if flip_x else (rect.x0 - x0, rect.x1 - x0)
            ys = (y1 - rect.y1, y1 - rect.y0) if flip_y else (rect.y0 - y0, rect.y1 - y0)
            return snapped(ys[0], xs[0], ys[1], xs[1]) if transpose else snapped(xs[0], ys[0], xs[1], ys[1])

        flight = self.flight
        if flight is not None:
            ux, uy = flight.up[0] * (-1 if flip_x else 1), flight.up[1] * (-1 if flip_y else 1)
            flight = Flight(turn(flight.rect), (uy, ux) if transpose else (ux, uy), flight.steps)
        return Draft([replace(cell, rects=tuple(map(turn, cell.rects))) for cell in self.cells], flight)


def snapped(x0: float, y0: float, x1: float, y1: float) -> Rect:
    """A rectangle on whole centimetres, so that neighbours' borders compare equal."""
    return Rect(round(x0, 2), round(y0, 2), round(x1, 2), round(y1, 2))


def clear_size(rect: Rect) -> tuple[float, float]:
    """Shorter and longer clear side of a cell's rectangle [m]."""
    return min(rect.width, rect.depth) - WALL_M, max(rect.width, rect.depth) - WALL_M


def is_plausible(cell: Cell) -> bool:
    """Whether the cell keeps to the size rule of its type; hallways are made right by construction."""
    rule = SIZES.get(cell.type)
    if rule is None:
        return True
    short, long = clear_size(cell.rects[0])
    within = rule.side_m[0] <= short <= rule.side_m[1] and rule.area_m2[0] <= short * long <= rule.area_m2[1]
    return within and long <= rule.aspect * short


def width_range(type_: str, depth_m: float) -> tuple[float, float] | None:
    """Smallest and largest width (between middle lines) of a room of a type in a strip of this depth; None when none fits."""
    rule, depth = SIZES[type_], depth_m - WALL_M
    low = max(rule.side_m[0], rule.area_m2[0] / depth, depth / rule.aspect)
    high = min(rule.area_m2[1] / depth, depth * rule.aspect)
    if depth > rule.side_m[1]:
        high = min(high, rule.side_m[1])
    if depth < rule.side_m[0] or low > high:
        return None
    return low + WALL_M, high + WALL_M
