"""Homes of four and five rooms, which the other kinds of plans never give."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spacevln.environments.houses.layout.bands import fill_row, strip
from spacevln.environments.houses.layout.draft import Draft, snapped
from spacevln.environments.houses.layout.schemes import Scheme, metres


def flat(rng: np.random.Generator) -> Draft | None:
    """Four rooms and no hallway: one lives in the middle; kitchen, bedroom and its bathroom lie along one side."""
    draft = Draft()
    width, south, north = metres(rng, 7.0, 8.4), metres(rng, 4.1, 4.8), metres(rng, 3.1, 3.8)
    draft.add("living room", snapped(0.0, 0.0, width, south))
    types = ["kitchen", "bedroom", "bathroom"] if rng.random() < 0.5 else ["kitchen", "bathroom", "bedroom"]
    if not fill_row(rng, draft, strip(0.0, south, width, south + north, "south"), 0, types):
        return None
    bathroom, bedroom = draft.index_of("bathroom"), draft.index_of("bedroom")
    draft.cells[bathroom] = replace(draft.cells[bathroom], owner=bedroom)
    return draft


def lodge(rng: np.random.Generator) -> Draft | None:
    """Five rooms: living room and kitchen at one end, bedroom and bathroom across a stub of a hallway at the other."""
    draft = Draft()
    south, hall, north = metres(rng, 3.4, 4.2), metres(rng, 1.3, 1.5), metres(rng, 2.6, 3.0)
    length, width, total = metres(rng, 2.95, 3.1), metres(rng, 4.2, 5.6), south + hall + north
    split = metres(rng, total * 0.5, total * 0.62)
    draft.add("living room", snapped(-width, 0.0, 0.0, split))
    draft.add("kitchen", snapped(-width, split, 0.0, total))
    draft.add("hallway", snapped(0.0, south, length, south + hall))
    ok = fill_row(rng, draft, strip(0.0, 0.0, length, south, "north"), 0, ["bedroom"])
    return draft if ok and fill_row(rng, draft, strip(0.0, south + hall, length, total, "south"), 0, ["bathroom"]) else None


def longhouse(rng: np.random.Generator) -> Draft | None:
    """Five rooms in a row: kitchen, living room, a hallway past the bathroom, bedroom."""
    draft = Draft()
    height, hall = metres(rng, 4.2, 4.8), metres(rng, 1.3, 1.5)
    kitchen, living, bathroom, bedroom = (metres(rng, *span) for span in ((2.8, 3.6), (4.3, 5.8), (1.9, 2.8), (3.0, 4.2)))
    start, end = living, round(living + bathroom, 2)
    draft.add("living room", snapped(0.0, 0.0, start, height))
    draft.add("kitchen", snapped(-kitchen, 0.0, 0.0, height))
    draft.add("hallway", snapped(start, 0.0, end, hall))
    draft.add("bathroom", snapped(start, hall, end, height))
    draft.add("bedroom", snapped(end, 0.0, end + bedroom, height))
    return draft


MOST_SMALL_ROOMS = 5
SMALL: tuple[tuple[Scheme, float], ...] = ((flat, 0.4), (lodge, 0.25), (longhouse, 0.35))
