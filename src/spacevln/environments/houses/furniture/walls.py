"""Plane geometry of furnishing: the walls of a room, footprints, taken volumes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacevln.environments.houses.furniture.kit import Design
from spacevln.environments.houses.plan import Item, Opening, Rect, Room

TOUCH_M = 0.002
"""Things may come this close to overlapping."""


@dataclass(frozen=True, slots=True)
class Side:
    """A stretch of a room's walls.

    Args:
        along: axis along which it runs.
        at: coordinate of its face across.
        low, high: its ends along.
        inward: +1 or -1, sign of the direction across that leads into the room.
    """

    along: str
    at: float
    low: float
    high: float
    inward: int

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.high - self.low

    @property
    def yaw_rad(self) -> float:
        """Yaw of an item with its back to this wall (its front faces the room)."""
        if self.along == "x":
            return 0.0 if self.inward > 0 else math.pi
        return -math.pi / 2 if self.inward > 0 else math.pi / 2

    def point(self, t: float, away_m: float) -> tuple[float, float]:
        """The point at ``t`` along the wall and ``away_m`` into the room."""
        across = self.at + self.inward * away_m
        return (t, across) if self.along == "x" else (across, t)


@dataclass(frozen=True, slots=True)
class Block:
    """A taken volume, heights over the floor.

    ``opening`` is the id of the opening whose hole and casing it keeps free, ``hung_z0_m`` its lower end for hung things.
    """

    rect: Rect
    z0_m: float
    z1_m: float
    opening: int | None = None
    hung_z0_m: float | None = None

    def low_m(self, solid: bool) -> float:
        """Lower end: a window keeps more free of what hangs than of what stands before it."""
        return self.z0_m if solid or self.hung_z0_m is None else self.hung_z0_m


@dataclass(frozen=True, slots=True)
class Pose2:
    """Where an item would stand."""

    x: float
    y: float
    yaw_rad: float


def footprint(made: Design, at: Pose2) -> Rect:
    """Bounding rectangle of a placed design (exact for quarter turns)."""
    c, s = abs(math.cos(at.yaw_rad)), abs(math.sin(at.yaw_rad))
    w, d = made.size[0] * c + made.size[1] * s, made.size[0] * s + made.size[1] * c
    return Rect(at.x - w / 2, at.y - d / 2, at.x + w / 2, at.y + d / 2)


def overlap(a: Rect, b: Rect, slack: float = TOUCH_M) -> bool:
    """Whether two rectangles share more than ``slack``."""
    return a.x0 < b.x1 - slack and b.x0 < a.x1 - slack and a.y0 < b.y1 - slack and b.y0 < a.y1 - slack


def room_sides(room: Room) -> list[Side]:
    """The outline of a union of rectangles, without the edges where two of them touch."""
    found: list[Side] = []
    for rect in room.rects:
        others = [r for r in room.rects if r is not rect]
        for along, at, low, high, inward in (
            ("x", rect.y0, rect.x0, rect.x1, 1),
            ("x", rect.y1, rect.x0, rect.x1, -1),
            ("y", rect.x0, rect.y0, rect.y1, 1),
            ("y", rect.x1, rect.y0, rect.y1, -1),
        ):
            spans = [(low, high)]
            for other in others:
                a, b = (other.y0, other.y1) if along == "x" else (other.x0, other.x1)
                cut = (other.x0, other.x1) if along == "x" else (other.y0, other.y1)
                if a - 0.15 < at < b + 0.15:
                    spans = [
                        piece for span in spans for piece in ((span[0], min(span[1], cut[0])), (max(span[0], cut[1]), span[1]))
                    ]
            found += [Side(along, at, a, b, inward) for a, b in spans if b - a > 0.3]
    return found


def footprint_of(item: Item) -> Rect:
    """Bounding rectangle of an item."""
    return footprint(Design(item.category, item.attributes, item.size, item.parts), Pose2(item.x, item.y, item.yaw_rad))


def strip_before(opening: Opening, low: float, high: float, face: int, half: float, deep: float) -> Rect:
    """A strip before a wall: from ``low`` to ``high`` along it, relative to the opening, and ``deep`` into the room."""
    near, far = sorted((face * half, face * (half + deep)))
    if opening.along == "x":
        return Rect(opening.x + low, opening.y + near, opening.x + high, opening.y + far)
    return Rect(opening.x + near, opening.y + low, opening.x + far, opening.y + high)
