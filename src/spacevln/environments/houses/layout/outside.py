"""What faces the open: balconies and garages against the outer walls, and windows."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.layout.draft import MAX_ROOMS, Draft, snapped
from spacevln.environments.houses.layout.schemes import metres
from spacevln.environments.houses.layout.stretches import MARGIN_M, Stretch, outer_walls
from spacevln.environments.houses.plan import Opening, Rect

UNGLAZED = ("closet", "hallway", "garage", "balcony")
_GARAGE_DOOR_M = 1.4


def annex(rng: np.random.Generator, draft: Draft) -> None:
    """Perhaps a garage or a balcony against an outer wall."""
    types = {cell.type for cell in draft.cells}
    if rng.random() < 0.22 and "garage" not in types:
        _attach(rng, draft, ("hallway", "kitchen", "laundry room"), "garage", (3.2, 3.9), (5.2, 6.0))
    if rng.random() < 0.4:
        _attach(rng, draft, ("living room", "bedroom", "dining room"), "balcony", (2.8, 4.6), (1.5, 2.0))


def _attach(
    rng: np.random.Generator,
    draft: Draft,
    hosts: tuple[str, ...],
    type_: str,
    length: tuple[float, float],
    depth: tuple[float, float],
) -> None:
    """Put a room outside against a wall of one of the hosts, where there is space.

    A balcony lies within the host's wall; a garage begins at its corner and may be longer.
    """
    if len(draft.cells) >= MAX_ROOMS:
        return
    hosted = [index for index, cell in enumerate(draft.cells) if cell.type in hosts]
    balcony = type_ == "balcony"
    for index in (hosted[int(k)] for k in rng.permutation(len(hosted))):
        cell = draft.cells[index]
        if not balcony and cell.floor != 0:
            continue
        along, away = metres(rng, *length), metres(rng, *depth)
        for stretch in outer_walls(draft, index):
            if stretch.length < (length[0] if balcony else _GARAGE_DOOR_M):
                continue
            low = stretch.low if balcony else stretch.low - MARGIN_M
            rect = _outside(cell.rects, stretch, low, min(along, stretch.length) if balcony else along, away)
            if not any(_overlap(rect, other) for k in draft.on_floor(cell.floor) for other in draft.cells[k].rects):
                draft.add(type_, rect, floor=cell.floor, owner=index)
                return


def _outside(rects: tuple[Rect, ...], stretch: Stretch, low: float, span: float, away: float) -> Rect:
    """The rectangle in front of a stretch of the outer wall of ``rects``."""
    far_side = any((rect.y1 if stretch.axis == "x" else rect.x1) == stretch.across for rect in rects)
    a, b = sorted((stretch.across, stretch.across + (away if far_side else -away)))
    return snapped(low, a, low + span, b) if stretch.axis == "x" else snapped(a, low, b, low + span)


def _overlap(a: Rect, b: Rect) -> bool:
    return a.x0 < b.x1 - 1e-6 and b.x0 < a.x1 - 1e-6 and a.y0 < b.y1 - 1e-6 and b.y0 < a.y1 - 1e-6


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
