"""The data of a house: what the generator makes and everything else reads. Pure geometry, scene frame (metres, z up)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Axis = Literal["x", "y"]


@dataclass(frozen=True, slots=True)
class Rect:
    """An axis-aligned rectangle [m]."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Extent along x [m]."""
        return self.x1 - self.x0

    @property
    def depth(self) -> float:
        """Extent along y [m]."""
        return self.y1 - self.y0

    @property
    def area(self) -> float:
        """Area [m2]."""
        return self.width * self.depth

    @property
    def centre(self) -> tuple[float, float]:
        """Centre (x, y) [m]."""
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    def contains(self, x: float, y: float, margin: float = 0.0) -> bool:
        """Whether the point lies inside, ``margin`` [m] from the border."""
        return self.x0 + margin <= x <= self.x1 - margin and self.y0 + margin <= y <= self.y1 - margin


@dataclass(frozen=True, slots=True)
class Floor:
    """A storey.

    Args:
        index: 0 is the ground floor.
        z_m: height of its floor surface.
        ceiling_m: clear height of its rooms.
    """

    index: int
    z_m: float
    ceiling_m: float


@dataclass(frozen=True, slots=True)
class Room:
    """A room: a union of rectangles that touch (mostly one; an L-shaped hallway has two)."""

    id: int
    type: str
    floor: int
    rects: tuple[Rect, ...]

    @property
    def area(self) -> float:
        """Floor area [m2]."""
        return sum(rect.area for rect in self.rects)

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the largest rectangle [m]."""
        return max(self.rects, key=lambda rect: rect.area).centre

    def contains(self, x: float, y: float, margin: float = 0.0) -> bool:
        """Whether the point lies inside one of the rectangles."""
        return any(rect.contains(x, y, margin) for rect in self.rects)


OpeningKind = Literal["doorway", "opening", "window"]


@dataclass(frozen=True, slots=True)
class Opening:
    """A hole in a wall: a doorway with a frame, an open-plan opening, or a window.

    Args:
        id: unique in the house, shared numbering with items and stairs (instance ids are derived from it).
        kind: doorways and openings can be walked through.
        floor: storey.
        rooms: ids of the two rooms; the second is None for a window.
        x, y: centre of the hole on the wall's middle line.
        along: axis of the wall that it is cut into.
        width_m: clear width.
        sill_m, head_m: lower and upper edge over the floor; sill 0 where one walks.
        leaf: a door leaf stands open against the wall beside it (decoration; never narrows the way).
        attributes: e.g. ("white", "glass", "arched"), of the frame.
    """

    id: int
    kind: OpeningKind
    floor: int
    rooms: tuple[int, int | None]
    x: float
    y: float
    along: Axis
    width_m: float
    sill_m: float = 0.0
    head_m: float = 2.05
    leaf: bool = False
    attributes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Stairs:
    """A straight flight between two storeys.

    Args:
        id: unique in the house.
        lower_floor: storey at its foot; it leads to the next one.
        rect: footprint of the steps, identical on both storeys (a well in the upper one, with railings).
        up_yaw_rad: direction in which it climbs, a multiple of pi/2.
        steps: number of risers; rise of each is at most 0.2 m.
    """

    id: int
    lower_floor: int
    rect: Rect
    up_yaw_rad: float
    steps: int


PartShape = Literal["box", "cylinder", "ellipsoid", "capsule", "mesh"]


@dataclass(frozen=True, slots=True)
class Part:
    """A primitive of an item, in the item's frame (x right along its width, y forward out of its front, z up from its base).

    Args:
        shape: ``mesh`` names a self-made mesh in ``mesh``.
        size: half extents for box and ellipsoid; (radius, half height, 0) for cylinder and capsule; scale for mesh.
        position: centre.
        euler_rad: intrinsic xyz rotation.
        material: key into the material catalogue.
        mesh: name of a mesh of the mesh catalogue.
    """

    shape: PartShape
    size: tuple[float, float, float]
    position: tuple[float, float, float]
    material: str
    euler_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mesh: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """A piece of furniture or an object.

    Args:
        id: unique in the house.
        category: e.g. ``"sofa"``.
        attributes: words that tell it apart, e.g. ``("white", "leather")``: colour first, then material, then shape.
        room: id of its room.
        floor: storey.
        x, y, z: position of its base centre, scene frame.
        yaw_rad: direction that its front faces... its local +y axis points to yaw + pi/2.
        size: width (local x), depth (local y), height.
        parts: primitives.
        solid: blocks the agent (a rug or a ceiling lamp does not).
        support: id of the item it stands on, or None.
    """

    id: int
    category: str
    attributes: tuple[str, ...]
    room: int
    floor: int
    x: float
    y: float
    z: float
    yaw_rad: float
    size: tuple[float, float, float]
    parts: tuple[Part, ...]
    solid: bool = True
    support: int | None = None

    @property
    def front_yaw_rad(self) -> float:
        """Direction in which the front faces, scene frame."""
        return self.yaw_rad + math.pi / 2


@dataclass(frozen=True, slots=True)
class House:
    """A whole furnished house.

    Args:
        seed: that made it.
        floors, rooms, openings, stairs, items: contents.
        wall_thickness_m: of every wall; openings lie on the walls' middle lines, rooms end at the walls' faces.
        styles: per room id, keys into the material catalogue: (floor, wall).
    """

    seed: int
    floors: tuple[Floor, ...]
    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...]
    stairs: tuple[Stairs, ...]
    items: tuple[Item, ...] = ()
    wall_thickness_m: float = 0.12
    styles: tuple[tuple[str, str], ...] = ()

    @property
    def name(self) -> str:
        """Scene name, e.g. ``"house-000017"``."""
        return f"house-{self.seed:06d}"

    def room_at(self, x: float, y: float, floor: int) -> Room | None:
        """The room that contains a point."""
        return next((room for room in self.rooms if room.floor == floor and room.contains(x, y)), None)
