"""Doorways and open-plan openings: which rooms are joined, and where on their common wall."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.layout.draft import Draft
from spacevln.environments.houses.layout.stretches import common_walls
from spacevln.environments.houses.plan import Opening, OpeningKind

DOOR_HEAD_M = 2.05
OPENING_HEAD_M = 2.2
PUBLIC = ("living room", "dining room", "kitchen")


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
        hub = draft.hub(floor)
        public = [index for index in here if cells[index].type in PUBLIC]
        joined = _public_links(rng, draft, public)
        links += joined
        doors = set(_hall_doors(rng, draft, hub, public)) if cells[hub].type == "hallway" else set()
        for index in here:
            if index == hub or cells[index].owner is not None:
                continue
            if index in public:
                if index in doors:
                    links.append((hub, index, _hall_kind(rng, cells[index].type), True))
            else:
                links.append((hub, index, "doorway", True))
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
    width = max(0.9, round(width, 2))
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
