"""Strips of rooms beside a hallway: which rooms, in which order, how wide."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from spacevln.environments.houses.layout.draft import WALL_M, Draft, snapped, width_range
from spacevln.environments.houses.plan import Rect


@dataclass(frozen=True, slots=True)
class Column:
    """One slot of a strip: a room, or a small one at the hallway with another behind it that belongs to the next bedroom."""

    front: str
    back: str | None = None


SPLIT_COLUMNS = (
    Column("bathroom", "closet"),
    Column("closet", "bathroom"),
    Column("laundry room", "closet"),
    Column("bathroom", "bathroom"),
    Column("laundry room", "bathroom"),
)

PRIVATE_POOL: dict[Column, float] = {
    Column("bedroom"): 5.0,
    Column("bathroom"): 1.2,
    Column("office"): 1.2,
    Column("laundry room"): 0.5,
    Column("gym"): 0.5,
    Column("library"): 0.5,
    Column("playroom"): 0.6,
    SPLIT_COLUMNS[0]: 2.4,
    SPLIT_COLUMNS[1]: 1.8,
    SPLIT_COLUMNS[2]: 0.6,
    SPLIT_COLUMNS[3]: 0.8,
    SPLIT_COLUMNS[4]: 0.6,
}
"""Weights of what stands beside a hallway of the private part."""

LIMITS = {"bathroom": 3, "closet": 3, "office": 2, "laundry room": 1, "gym": 1, "library": 1, "playroom": 1, "garage": 1}
"""Largest number of rooms of a type in a house; bedrooms are limited to five."""


@dataclass(frozen=True, slots=True)
class Strip:
    """Where a strip lies: local u runs along the hallway, local v away from it.

    Args:
        length_m, depth_m: extents along u and v.
        place: maps a local (u0, v0, u1, v1) to the plan.
    """

    length_m: float
    depth_m: float
    place: Callable[[float, float, float, float], Rect]


def strip(x0: float, y0: float, x1: float, y1: float, hall: str) -> Strip:
    """The strip over a rectangle whose hallway lies to the ``hall``: "north", "south", "east" or "west"."""
    if hall == "south":
        return Strip(x1 - x0, y1 - y0, lambda a, b, c, d: snapped(x0 + a, y0 + b, x0 + c, y0 + d))
    if hall == "north":
        return Strip(x1 - x0, y1 - y0, lambda a, b, c, d: snapped(x0 + a, y1 - d, x0 + c, y1 - b))
    if hall == "west":
        return Strip(y1 - y0, x1 - x0, lambda a, b, c, d: snapped(x0 + b, y0 + a, x0 + d, y0 + c))
    return Strip(y1 - y0, x1 - x0, lambda a, b, c, d: snapped(x1 - d, y0 + a, x1 - b, y0 + c))


def fill(rng: np.random.Generator, draft: Draft, where: Strip, floor: int, wanted: Sequence[str] = ()) -> bool:
    """Fill a strip with ``wanted`` rooms and random private ones; False when nothing fitted."""
    for _ in range(12):
        columns = _draw(rng, draft, where, wanted)
        if columns is None or not _owned(columns):
            continue
        widths = _widths(rng, columns, where)
        if widths is not None and _put(rng, draft, where, floor, columns, widths):
            return True
    return False


def fill_row(rng: np.random.Generator, draft: Draft, where: Strip, floor: int, types: Sequence[str]) -> bool:
    """Fill a strip with exactly these rooms in this order; False when they do not fit."""
    columns = [Column(type_) for type_ in types]
    widths = _widths(rng, columns, where)
    return widths is not None and _put(rng, draft, where, floor, columns, widths)


def _column_range(column: Column, depth_m: float) -> tuple[float, float] | None:
    if column.back is None:
        return width_range(column.front, depth_m)
    return (1.75 + WALL_M, 2.6 + WALL_M) if 3.4 <= depth_m <= 5.0 else None


def _draw(rng: np.random.Generator, draft: Draft, where: Strip, wanted: Sequence[str]) -> list[Column] | None:
    """A random multiset of columns, in random order, whose width ranges cover the strip's length."""
    counts = {name: sum(cell.type == name for cell in draft.cells) for name in (*LIMITS, "bedroom")}
    columns = [Column(name) for name in wanted]
    low, high = 0.0, 0.0
    pool = list(PRIVATE_POOL)
    weights = np.array([PRIVATE_POOL[column] for column in pool])
    for column in columns:
        span = _column_range(column, where.depth_m)
        if span is None:
            return None
        low, high = low + span[0], high + span[1]
    target = where.length_m * rng.uniform(0.85, 1.05)
    while (low + high) / 2 < target:
        column = pool[int(rng.choice(len(pool), p=weights / weights.sum()))]
        span = _column_range(column, where.depth_m)
        rooms = [name for name in (column.front, column.back) if name]
        placed = [name for other in columns for name in (other.front, other.back) if name]
        if span is None or any(counts[n] + placed.count(n) + rooms.count(n) > LIMITS.get(n, 5) for n in rooms):
            weights[pool.index(column)] = 0.0
            if not weights.any():
                return None
            continue
        if low + span[0] > where.length_m:
            break
        columns.append(column)
        low, high = low + span[0], high + span[1]
    if not low <= where.length_m <= high:
        return None
    return [columns[index] for index in rng.permutation(len(columns))]


def _owned(columns: Sequence[Column]) -> bool:
    """Whether every room at the back has a whole bedroom beside it, and no two bathrooms off the hallway are neighbours."""
    if any(a.front == b.front == "bathroom" for a, b in itertools.pairwise(columns)):
        return False
    return all(column.back is None or _owner(columns, index) is not None for index, column in enumerate(columns))


def _owner(columns: Sequence[Column], index: int) -> int | None:
    sides = [side for side in (index - 1, index + 1) if 0 <= side < len(columns) and columns[side] == Column("bedroom")]
    return sides[0] if sides else None


def _widths(rng: np.random.Generator, columns: Sequence[Column], where: Strip) -> list[float] | None:
    spans = [_column_range(column, where.depth_m) for column in columns]
    if any(span is None for span in spans):
        return None
    low = np.array([span[0] for span in spans if span])
    high = np.array([span[1] for span in spans if span])
    if not low.sum() <= where.length_m <= high.sum():
        return None
    width = low + rng.uniform(0.2, 0.7, len(spans)) * (high - low)
    bound = low if width.sum() > where.length_m else high
    share = (where.length_m - width.sum()) / max(abs((bound - width).sum()), 1e-9)
    return [float(value) for value in width + abs(share) * (bound - width)]


def _put(
    rng: np.random.Generator, draft: Draft, where: Strip, floor: int, columns: Sequence[Column], widths: Sequence[float]
) -> bool:
    edges = [0.0, *np.cumsum(widths)[:-1].tolist(), where.length_m]
    front_depth = [_front_depth(rng, column, where.depth_m) for column in columns]
    index_of: dict[int, int] = {}
    for k, column in enumerate(columns):
        index_of[k] = draft.add(column.front, where.place(edges[k], 0.0, edges[k + 1], front_depth[k]), floor=floor)
    for k, column in enumerate(columns):
        if column.back is not None:
            owner = _owner(columns, k)
            assert owner is not None  # noqa: S101 - _owned has been asked
            rect = where.place(edges[k], front_depth[k], edges[k + 1], where.depth_m)
            draft.add(column.back, rect, floor=floor, owner=index_of[owner])
    return True


def _front_depth(rng: np.random.Generator, column: Column, depth_m: float) -> float:
    if column.back is None:
        return depth_m
    share = 0.42 if column.front == "closet" else 0.58 if column.back == "closet" else 0.5
    return round(depth_m * (share + rng.uniform(-0.03, 0.03)), 2)
