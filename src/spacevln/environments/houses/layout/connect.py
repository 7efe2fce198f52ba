"""Doorways, open-plan openings and windows: which rooms are joined, and where on their common wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacevln.environments.houses.layout.draft import WALL_M, Draft
from spacevln.environments.houses.plan import Axis, Opening, OpeningKind, Rect

JAMB_M = 0.1
"""Wall kept between a hole and the next corner, for the frame."""
DOOR_HEAD_M = 2.05
OPENING_HEAD_M = 2.2
PUBLIC = ("living room", "dining room", "kitchen")
UNGLAZED = ("closet", "hallway", "garage", "balcony")


@dataclass(frozen=True, slots=True)
class Stretch:
    """A piece of wall: ``axis`` it runs along, its middle line at ``across``, from ``low`` to ``high``."""

    axis: Axis
    across: float
    low: float
    high: float

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.high - self.low


def common_walls(draft: Draft, a: int, b: int) -> list[Stretch]:
    """Stretches between two rooms that are free of stairs on both sides, clear of corners."""
    first, second = draft.cells[a], draft.cells[b]
    if first.floor != second.floor:
        return []
    found = [stretch for p in first.rects for q in second.rects for stretch in _contact(p, q)]
    return [piece for stretch in found for piece in _without_flight(draft, stretch)]


def _contact(p: Rect, q: Rect) -> list[Stretch]:
    found: list[Stretch] = []
    margin = WALL_M / 2 + JAMB_M
    for across, facing in ((p.x1, q.x0), (p.x0, q.x1)):
        if abs(across - facing) < 1e-6:
            found.append(Stretch("y", across, max(p.y0, q.y0) + margin, min(p.y1, q.y1) - margin))
    for across, facing in ((p.y1, q.y0), (p.y0, q.y1)):
        if abs(across - facing) < 1e-6:
            found.append(Stretch("x", across, max(p.x0, q.x0) + margin, min(p.x1, q.x1) - margin))
    return [stretch for stretch in found if stretch.length > 0.5]


def _without_flight(draft: Draft, stretch: Stretch) -> list[Stretch]:
    """The parts of a stretch that are not beside the steps."""
    if draft.flight is None:
        return [stretch]
    rect = draft.flight.rect
    along, side = ((rect.x0, rect.x1), (rect.y0, rect.y1)) if stretch.axis == "x" else ((rect.y0, rect.y1), (rect.x0, rect.x1))
    if not side[0] - 0.5 < stretch.across < side[1] + 0.5:
        return [stretch]
    pieces = [
        Stretch(stretch.axis, stretch.across, stretch.low, min(stretch.high, along[0] - 0.1)),
        Stretch(stretch.axis, stretch.across, max(stretch.low, along[1] + 0.1), stretch.high),
    ]
    return [piece for piece in pieces if piece.length > 0.5]


def connect(rng: np.random.Generator, draft: Draft) -> list[Opening] | None:
    """All holes one walks through, or None when some room cannot be joined as it should be."""
    openings: list[Opening] = []
    for a, b, kind, needed in _links(rng, draft):
        opening = _cut(rng, draft, a, b, kind, len(openings) + 1)
        if opening is not None:
            openings.append(opening)
        elif needed:
            return None
    return openings


def _links(rng: np.random.Generator, draft: Draft) -> list[tuple[int, int, OpeningKind, bool]]:
    """Pairs of rooms to join, how, and whether the plan is worthless without."""
    links: list[tuple[int, int, OpeningKind, bool]] = []
    cells = draft.cells
    for index, cell in enumerate(cells):
        if cell.owner is not None:
            links.append((cell.owner, index, "doorway", True))
    for floor in {cell.floor for cell in cells}:
        here = draft.on_floor(floor)
        hall = next(index for index in here if cells[index].type == "hallway")
        public = [index for index in here if cells[index].type in PUBLIC]
        joined = _public_links(rng, draft, public)
        links += joined
        doors = set(_hall_doors(rng, draft, hall, public))
        for index in here:
            if index == hall or cells[index].owner is not None:
                continue
            if index in public:
                if index in doors:
                    links.append((hall, index, _hall_kind(rng, cells[index].type), True))
            else:
                links.append((hall, index, "doorway", True))
    return links


def _public_links(rng: np.random.Generator, draft: Draft, public: list[int]) -> list[tuple[int, int, OpeningKind, bool]]:
    return [
        (a, b, "opening" if rng.random() < 0.72 else "doorway", False)
        for k, a in enumerate(public)
        for b in public[k + 1 :]
        if any(stretch.length > 0.9 for stretch in common_walls(draft, a, b))
    ]


def _hall_doors(rng: np.random.Generator, draft: Draft, hall: int, public: list[int]) -> list[int]:
    """Public rooms that open to the hallway: one at least, often two (a loop)."""
    touching = [index for index in public if any(s.length > 0.95 for s in common_walls(draft, hall, index))]
    if not touching:
        return []
    order = [touching[int(k)] for k in rng.permutation(len(touching))]
    order.sort(key=lambda index: draft.cells[index].type != "living room")
    return order[: 1 + int(rng.random() < 0.75) + int(rng.random() < 0.25)]


def _hall_kind(rng: np.random.Generator, type_: str) -> OpeningKind:
    return "opening" if rng.random() < (0.65 if type_ == "living room" else 0.3) else "doorway"


def _cut(rng: np.random.Generator, draft: Draft, a: int, b: int, kind: OpeningKind, number: int) -> Opening | None:
    stretches = [stretch for stretch in common_walls(draft, a, b) if stretch.length >= 0.95]
    if not stretches:
        return None
    stretch = (
        max(stretches, key=lambda piece: piece.length) if kind == "opening" else stretches[int(rng.integers(len(stretches)))]
    )
    if kind == "opening" and stretch.length < 1.2 and "hallway" not in (draft.cells[a].type, draft.cells[b].type):
        kind = "doorway"
    if kind == "opening":
        width = min(stretch.length, float(rng.uniform(1.4, 3.0)))
    else:
        width = min(stretch.length, float(rng.choice([0.9, 0.95, 1.0])))
    width = round(width - 0.005, 2) if width < 0.9 + 1e-9 else round(width, 2)
    width = max(width, 0.9)
    slack = stretch.length - width
    share = 0.5 if kind == "opening" and rng.random() < 0.5 else float(rng.choice([0.0, 0.15, 0.5, 0.85, 1.0]))
    centre = round(stretch.low + width / 2 + slack * share, 3)
    x, y = (centre, stretch.across) if stretch.axis == "x" else (stretch.across, centre)
    glass = "balcony" in (draft.cells[a].type, draft.cells[b].type)
    return Opening(
        id=number,
        kind=kind,
        floor=draft.cells[a].floor,
        rooms=(a, b),
        x=x,
        y=y,
        along=stretch.axis,
        width_m=width,
        head_m=OPENING_HEAD_M if kind == "opening" else DOOR_HEAD_M,
        leaf=kind == "doorway" and not glass and bool(rng.random() < 0.6),
        attributes=_frame(rng, kind, glass),
    )


def _frame(rng: np.random.Generator, kind: OpeningKind, glass: bool) -> tuple[str, ...]:
    if glass:
        return ("white", "glass", "sliding")
    if kind == "opening":
        return ("arched",) if rng.random() < 0.15 else ()
    return (str(rng.choice(["white", "white", "white", "brown", "gray", "dark"])),)


def windows(rng: np.random.Generator, draft: Draft, first_id: int) -> list[Opening]:
    """Windows in the outer walls of the rooms that have them."""
    found: list[Opening] = []
    for index, cell in enumerate(draft.cells):
        if cell.type in UNGLAZED and not (cell.type == "hallway" and rng.random() < 0.6):
            continue
        for stretch in outer_walls(draft, index)[:3]:
            small = cell.type in ("bathroom", "laundry room")
            width, sill = (0.6, 1.35) if small else (round(float(rng.uniform(0.9, 1.8)), 1), 0.9)
            width = min(width, round(stretch.length - 0.4, 1))
            if width < 0.5:
                continue
            count = 2 if stretch.length > 4.2 and not small else 1
            for k in range(count):
                centre = round(stretch.low + stretch.length * (k + 0.5) / count, 3)
                x, y = (centre, stretch.across) if stretch.axis == "x" else (stretch.across, centre)
                found.append(
                    Opening(
                        id=first_id + len(found), kind="window", floor=cell.floor, rooms=(index, None), x=x, y=y,
                        along=stretch.axis, width_m=width, sill_m=sill, head_m=2.1,
                    )
                )  # fmt: skip
    return found


def outer_walls(draft: Draft, index: int) -> list[Stretch]:
    """Stretches of a room's walls that face the open, longest first, clear of corners and of stairs."""
    cell = draft.cells[index]
    others = [r for k in draft.on_floor(cell.floor) for r in draft.cells[k].rects]
    found: list[Stretch] = []
    for rect in cell.rects:
        sides = (("x", rect.y0, -1), ("x", rect.y1, 1), ("y", rect.x0, -1), ("y", rect.x1, 1))
        for axis, across, _ in sides:
            low, high = (rect.x0, rect.x1) if axis == "x" else (rect.y0, rect.y1)
            taken = sorted(
                _covers(other, axis, across) for other in others if other is not rect and _touches(other, axis, across)
            )
            cursor = low
            for a, b in [*taken, (high, high)]:
                if a > cursor:
                    found.append(Stretch("x" if axis == "x" else "y", across, cursor + 0.16, min(a, high) - 0.16))
                cursor = max(cursor, b)
                if cursor >= high:
                    break
    free = [piece for stretch in found if stretch.length > 0.5 for piece in _without_flight(draft, stretch)]
    return sorted(free, key=lambda stretch: -stretch.length)


def _touches(rect: Rect, axis: str, across: float) -> bool:
    edges = (rect.y0, rect.y1) if axis == "x" else (rect.x0, rect.x1)
    return any(abs(edge - across) < 1e-6 for edge in edges)


def _covers(rect: Rect, axis: str, across: float) -> tuple[float, float]:  # noqa: ARG001
    return (rect.x0, rect.x1) if axis == "x" else (rect.y0, rect.y1)
