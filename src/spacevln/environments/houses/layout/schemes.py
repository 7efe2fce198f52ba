"""Kinds of plans of six rooms and more: a spine hallway, one between public and private rooms, a bent one, a ring, two floors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spacevln.environments.houses.layout.bands import Strip, fill, fill_row, strip
from spacevln.environments.houses.layout.draft import MAX_ROOMS, WALL_M, Draft, Flight, snapped, width_range
from spacevln.environments.houses.plan import Rect

Scheme = Callable[[np.random.Generator], Draft | None]

STAIR_WIDTH_M = 1.1
TREAD_M = 0.28
STORY_M = 2.8
STEPS = 15
RAIL_M = 0.05
EXTRA_TYPES = ("office", "laundry room", "garage", "gym", "library", "playroom")


def metres(rng: np.random.Generator, low: float, high: float) -> float:
    """A random length on a 5 cm raster."""
    return round(float(rng.uniform(low, high)) * 20) / 20


def spine(rng: np.random.Generator) -> Draft | None:
    """A public block at one end, a hallway from it between two strips of private rooms."""
    draft = Draft()
    south, hall, north = metres(rng, 3.3, 4.5), metres(rng, 1.3, 1.65), metres(rng, 3.3, 4.5)
    length = metres(rng, 6.2, 10.5)
    total = south + hall + north
    low = metres(rng, -1.6, 0.0) if rng.random() < 0.5 else 0.0
    high = total + (metres(rng, 0.0, 1.6) if rng.random() < 0.5 else 0.0)
    if not _public_block(rng, draft, snapped(-metres(rng, 4.6, 6.4), low, 0.0, high)):
        return None
    end = length
    if rng.random() < 0.4:
        end = length - metres(rng, 3.4, 4.4)
        _suite(rng, draft, snapped(end, 0.0, length, south + hall))
    draft.add("hallway", snapped(0.0, south, end, south + hall))
    wanted = ("bedroom",) if end > 5 else ()
    ok = fill(rng, draft, strip(0.0, 0.0, end, south, "north"), 0, wanted)
    return draft if ok and fill(rng, draft, strip(0.0, south + hall, end, total, "south"), 0, ("bathroom", *wanted)) else None


def _suite(rng: np.random.Generator, draft: Draft, block: Rect) -> None:
    """A bedroom at a hallway's end with its own bathroom and closet side by side behind it."""
    bedroom = draft.add("bedroom", block)
    depth, split = metres(rng, 2.3, 2.8), block.x1 - metres(rng, 1.6, 2.0)
    draft.add("bathroom", snapped(block.x0, block.y1, split, block.y1 + depth), owner=bedroom)
    draft.add("closet", snapped(split, block.y1, block.x1, block.y1 + depth), owner=bedroom)


def cottage(rng: np.random.Generator) -> Draft | None:
    """A small house: living room and kitchen at one end, a short hallway with a few rooms at the other."""
    draft = Draft()
    south, hall, north = metres(rng, 3.2, 4.2), metres(rng, 1.3, 1.6), metres(rng, 3.0, 4.0)
    length = metres(rng, 3.4, 6.0)
    total = south + hall + north
    width = metres(rng, 4.2, 5.6)
    split = metres(rng, total * 0.5, total * 0.62)
    draft.add("living room", snapped(-width, 0.0, 0.0, split))
    draft.add("kitchen", snapped(-width, split, 0.0, total))
    draft.add("hallway", snapped(0.0, south, length, south + hall))
    ok = fill(rng, draft, strip(0.0, 0.0, length, south, "north"), 0, ("bedroom",))
    return draft if ok and fill(rng, draft, strip(0.0, south + hall, length, total, "south"), 0, ("bathroom",)) else None


def central(rng: np.random.Generator) -> Draft | None:
    """A hallway along the whole house: the public rooms on one side, open to each other, the private ones on the other."""
    draft = Draft()
    south, hall, north = metres(rng, 4.0, 5.2), metres(rng, 1.35, 1.75), metres(rng, 3.3, 4.6)
    length = metres(rng, 10.5, 14.5)
    draft.add("hallway", snapped(0.0, south, length, south + hall))
    if not _public_row(rng, draft, 0, snapped(0.0, 0.0, length, south)):
        return None
    if rng.random() < 0.3:
        _suite(rng, draft, snapped(length, metres(rng, 0.0, 0.6), length + metres(rng, 3.5, 4.4), south + hall))
    where = strip(0.0, south + hall, length, south + hall + north, "south")
    return draft if fill(rng, draft, where, 0, ("bedroom", "bathroom", "bedroom")) else None


def bent(rng: np.random.Generator) -> Draft | None:
    """Two wings at a right angle and a bent hallway that joins them."""
    draft = Draft()
    south, hall, east, inner = metres(rng, 4.0, 5.0), metres(rng, 1.35, 1.65), metres(rng, 3.3, 4.3), metres(rng, 3.2, 4.0)
    corner, top = metres(rng, 7.5, 10.5), south + metres(rng, 6.2, 9.0)
    low = round(south + hall, 2)
    draft.add("hallway", snapped(0.0, south, corner, low), snapped(corner - hall, low, corner, top))
    if not _public_row(rng, draft, 0, snapped(0.0, 0.0, corner + metres(rng, -hall, east), south)):
        return None
    if not fill(rng, draft, strip(corner, south, corner + east, top, "west"), 0, ("bedroom",)):
        return None
    west = round(corner - hall - inner, 2)
    if not fill(rng, draft, strip(west, low, corner - hall, top, "east"), 0, ("bathroom",)):
        return None
    if rng.random() < 0.5 and not fill(rng, draft, strip(0.0, low, west, low + metres(rng, 3.0, 3.8), "south"), 0):
        return None
    return draft


def ring(rng: np.random.Generator) -> Draft | None:
    """A hallway around a core of small rooms: one can walk in a circle."""
    draft = Draft()
    south, hall, north = metres(rng, 4.0, 4.8), metres(rng, 1.3, 1.5), metres(rng, 3.3, 4.2)
    core_x, core_y, east = metres(rng, 3.9, 6.4), metres(rng, 2.2, 2.7), metres(rng, 3.2, 4.2)
    length = round(core_x + 2 * hall, 2)
    y1, y2, y3 = round(south + hall, 2), round(south + hall + core_y, 2), round(south + 2 * hall + core_y, 2)
    draft.add(
        "hallway",
        snapped(0.0, south, length, y1),
        snapped(0.0, y2, length, y3),
        snapped(0.0, y1, hall, y2),
        snapped(length - hall, y1, length, y2),
    )
    core = ["bathroom", "laundry room", "closet", "bathroom"][: 2 if core_x < 4.9 else 3]
    if not fill_row(rng, draft, strip(hall, y1, length - hall, y2, "south"), 0, core):
        return None
    if not _public_row(rng, draft, 0, snapped(-metres(rng, 0.0, 2.0), 0.0, length + metres(rng, 0.0, east), south)):
        return None
    if not fill(rng, draft, strip(0.0, y3, length, y3 + north, "south"), 0, ("bedroom",)):
        return None
    return (
        draft
        if fill_row(rng, draft, strip(length, south, length + east, y3, "west"), 0, _single(rng, draft, y3 - south, east))
        else None
    )


def two_floors(rng: np.random.Generator) -> Draft | None:
    """A hallway with a straight flight beside it on both floors; public rooms below, private ones above."""
    draft = Draft()
    south, hall, north = metres(rng, 3.9, 4.6), metres(rng, 1.45, 1.75), metres(rng, 3.3, 4.3)
    run, landing, gallery = STEPS * TREAD_M, metres(rng, 1.25, 1.5), STAIR_WIDTH_M + RAIL_M
    beside = (True, False) if rng.random() < 0.5 else (False, False) if rng.random() < 0.5 else (True, True)
    y1 = round(south + hall, 2)
    y2, y3 = round(y1 + gallery, 2), round(y1 + north, 2)
    y4 = round(y2 + metres(rng, 3.2, 4.0), 2)
    x2 = round(run + 2 * landing, 2)
    length = round(x2 + (metres(rng, 2.1, 2.8) if rng.random() < 0.3 else metres(rng, 4.2, 5.6)), 2)
    for floor in (0, 1):
        draft.add("hallway", snapped(0.0, south, length, y1), snapped(0.0, y1, x2, y2), floor=floor)
        if floor == 0 and not _public_row(rng, draft, 0, snapped(0.0, 0.0, length, south), extra=False):
            return None
        if floor == 1 and not fill(rng, draft, strip(0.0, 0.0, length, south, "north"), 1, ("bedroom",)):
            return None
        if beside[floor] and not _beside_stairs(rng, draft, strip(0.0, y2, x2, y4, "south"), floor):
            return None
        if not fill(rng, draft, strip(x2, y1, length, y3, "south"), floor, ("bathroom",)):
            return None
    if len(draft.cells) > MAX_ROOMS:
        return None
    x0 = round(landing + WALL_M / 2, 2)
    foot_first = rng.random() < 0.5
    face = y2 - WALL_M / 2
    draft.flight = Flight(snapped(x0, face - STAIR_WIDTH_M, min(x0 + run, x2), face), (1, 0) if foot_first else (-1, 0), STEPS)
    return draft


def _beside_stairs(rng: np.random.Generator, draft: Draft, where: Strip, floor: int) -> bool:
    """Exactly two rooms along the flight: each has its door at one of the landings."""
    if rng.random() < 0.25 and floor == 0:
        pair = ["garage", "laundry room"]
    else:
        names = (
            ["bedroom", "office", "bedroom", "library", "playroom", "gym"]
            if floor
            else ["office", "gym", "library", "playroom", "bedroom"]
        )
        taken = {cell.type for cell in draft.cells} - {"bedroom", "office"}
        names = [name for name in names if name not in taken]
        pair = [names[int(k)] for k in rng.permutation(len(names))[:2]]
    return fill_row(rng, draft, where, floor, pair)


def _single(rng: np.random.Generator, draft: Draft, length: float, depth: float) -> list[str]:
    """One or two rooms for a short strip."""
    taken = {cell.type for cell in draft.cells} - {"bedroom", "office"}
    one = [name for name in ("bedroom", "office", "gym", "library") if name not in taken and _fits(name, length, depth)]
    return [one[int(rng.integers(len(one)))]] if one else ["bedroom", "bathroom"]


def _fits(name: str, length: float, depth: float) -> bool:
    span = width_range(name, depth)
    return span is not None and span[0] <= length <= span[1]


def _public_block(rng: np.random.Generator, draft: Draft, block: Rect) -> bool:
    """Living room, kitchen and dining room stacked, or the last two side by side behind the first."""
    height = block.depth
    if block.width >= 5.8:
        split, middle = metres(rng, height * 0.5, height * 0.6), block.x0 + metres(rng, block.width * 0.46, block.width * 0.54)
        draft.add("living room", snapped(block.x0, block.y0, block.x1, block.y0 + split))
        first, second = ("kitchen", "dining room") if rng.random() < 0.5 else ("dining room", "kitchen")
        draft.add(first, snapped(block.x0, block.y0 + split, middle, block.y1))
        draft.add(second, snapped(middle, block.y0 + split, block.x1, block.y1))
        return True
    if height >= 9.0:
        return fill_row(
            rng, draft, strip(block.x0, block.y0, block.x1, block.y1, "east"), 0, ["living room", "dining room", "kitchen"]
        )
    return fill_row(rng, draft, strip(block.x0, block.y0, block.x1, block.y1, "east"), 0, ["living room", "kitchen"])


def _public_row(rng: np.random.Generator, draft: Draft, floor: int, block: Rect, extra: bool = True) -> bool:
    """Living, dining room and kitchen side by side, perhaps with one room more."""
    types = ["living room", "dining room", "kitchen"]
    if rng.random() < 0.15:
        types = ["dining room", "living room", "kitchen"]
    if extra and block.width > 11.5 and rng.random() < 0.75:
        name = EXTRA_TYPES[int(rng.integers(len(EXTRA_TYPES)))]
        if name not in {cell.type for cell in draft.cells}:
            types.append(name)
    if rng.random() < 0.5:
        types.reverse()
    return fill_row(rng, draft, strip(block.x0, block.y0, block.x1, block.y1, "north"), floor, types)


SINGLE_FLOOR: tuple[tuple[Scheme, float], ...] = ((spine, 0.36), (central, 0.2), (bent, 0.2), (ring, 0.14), (cottage, 0.1))
