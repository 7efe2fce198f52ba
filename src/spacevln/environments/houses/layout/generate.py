"""Seeded, deterministic floor plans."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from spacevln.core.errors import ContractError
from spacevln.environments.houses.layout.connect import connect
from spacevln.environments.houses.layout.draft import MAX_ROOMS, MIN_ROOMS, WALL_M, Draft, is_plausible
from spacevln.environments.houses.layout.outside import annex, windows
from spacevln.environments.houses.layout.schemes import SINGLE_FLOOR, STORY_M, Scheme, cottage, two_floors
from spacevln.environments.houses.layout.small import MOST_SMALL_ROOMS, SMALL
from spacevln.environments.houses.plan import Floor, House, Opening, Rect, Room, Stairs

CEILING_M = 2.55
TWO_FLOOR_SHARE = 0.2
SMALL_SHARE = 0.4
"""Share of the cottages that have four or five rooms."""
_STREAM, _SMALL_STREAM = 1, 4
_ATTEMPTS = 2000
_PRIVATE_ENDS = frozenset(("bathroom", "closet", "balcony", "garage", "bedroom", "laundry room"))


def generate_layout(seed: int) -> House:
    """The bare house of a seed: rooms, doorways, openings, windows, stairs; no items, no styles.

    Args:
        seed: any non-negative integer; the same seed gives an equal house.

    Raises:
        ContractError: no plan was found, which no tested seed does.
    """
    rng = np.random.default_rng([seed, _STREAM])
    two = bool(rng.random() < TWO_FLOOR_SHARE)
    scheme = two_floors if two else _drawn(rng, SINGLE_FLOOR)
    small = scheme is cottage and bool(np.random.default_rng([seed, _SMALL_STREAM]).random() < SMALL_SHARE)
    scheme, most = (_drawn(rng, SMALL), MOST_SMALL_ROOMS) if small else (scheme, MAX_ROOMS)
    for _ in range(_ATTEMPTS):
        draft = scheme(rng)
        if draft is None:
            continue
        annex(rng, draft)
        draft = draft.mapped(*(bool(rng.random() < 0.5) for _ in range(3)))
        if not _is_sane(draft, most):
            continue
        openings = connect(rng, draft)
        if openings is not None and _is_joined(draft, openings):
            openings += windows(rng, draft, len(openings) + 1)
            return _house(seed, draft, openings)
    raise ContractError(f"No floor plan was found for house seed {seed} in {_ATTEMPTS} attempts; report the seed.")


def _drawn(rng: np.random.Generator, weighted: Sequence[tuple[Scheme, float]]) -> Scheme:
    schemes, weights = zip(*weighted, strict=True)
    scheme: Scheme = schemes[int(rng.choice(len(schemes), p=np.array(weights) / sum(weights)))]
    return scheme


def _is_sane(draft: Draft, most: int) -> bool:
    """Sizes, number of rooms, and the rooms that every house has."""
    types = [cell.type for cell in draft.cells]
    needed = all(name in types for name in ("living room", "kitchen", "bathroom", "bedroom"))
    return needed and MIN_ROOMS <= len(types) <= most and all(map(is_plausible, draft.cells))


def _is_joined(draft: Draft, openings: list[Opening]) -> bool:
    """Whether every room is reached, and none of the others only through a bedroom, a bathroom or the like."""
    start = draft.hub()
    reached, stack = {start}, [start]
    halls = [index for index, cell in enumerate(draft.cells) if cell.type == "hallway"]
    links = [(o.rooms[0], o.rooms[1]) for o in openings] + [(halls[k], halls[k + 1]) for k in range(len(halls) - 1)]
    while stack:
        room = stack.pop()
        for a, b in links:
            if room not in (a, b):
                continue
            other = b if room == a else a
            through = draft.cells[room].type in _PRIVATE_ENDS
            if other is None or other in reached or (through and draft.cells[other].owner != room):
                continue
            reached.add(other)
            stack.append(other)
    return len(reached) == len(draft.cells)


def _house(seed: int, draft: Draft, openings: list[Opening]) -> House:
    floors = tuple(Floor(index, index * STORY_M, CEILING_M) for index in sorted({cell.floor for cell in draft.cells}))
    rooms = tuple(Room(index, cell.type, cell.floor, _clear(cell.rects)) for index, cell in enumerate(draft.cells))
    stairs: tuple[Stairs, ...] = ()
    if draft.flight is not None:
        yaw = math.atan2(draft.flight.up[1], draft.flight.up[0])
        stairs = (Stairs(len(openings) + 1, 0, draft.flight.rect, yaw, draft.flight.steps),)
    return House(seed=seed, floors=floors, rooms=rooms, openings=tuple(openings), stairs=stairs, wall_thickness_m=WALL_M)


def _clear(rects: tuple[Rect, ...]) -> tuple[Rect, ...]:
    """The rectangles up to the walls' faces; pieces of one room touch each other where no wall stands between."""
    half = WALL_M / 2
    first = [Rect(r.x0 + half, r.y0 + half, r.x1 - half, r.y1 - half) for r in rects]
    for k, rect in enumerate(rects):
        for other in rects[:k]:
            a = first[k]
            if abs(rect.x0 - other.x1) < 1e-6:
                a = Rect(a.x0 - 2 * half, a.y0, a.x1, a.y1)
            if abs(rect.x1 - other.x0) < 1e-6:
                a = Rect(a.x0, a.y0, a.x1 + 2 * half, a.y1)
            if abs(rect.y0 - other.y1) < 1e-6:
                a = Rect(a.x0, a.y0 - 2 * half, a.x1, a.y1)
            if abs(rect.y1 - other.y0) < 1e-6:
                a = Rect(a.x0, a.y0, a.x1, a.y1 + 2 * half)
            first[k] = a
    return tuple(Rect(round(r.x0, 3), round(r.y0, 3), round(r.x1, 3), round(r.y1, 3)) for r in first)
