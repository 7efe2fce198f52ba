"""Floors and walls of rooms by type."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.plan import Room

_WOOD = ("planks-oak", "planks-walnut", "planks-maple", "planks-pine")
_LIVING = ("cream", "beige", "sage", "sky", "ivory", "tan")
FLOORS: dict[str, tuple[str, ...]] = {
    "balcony": ("deck-tan", "tile-terracotta", "deck-gray"),
    "bathroom": ("tile-sky", "mosaic-sky", "tile-white", "checker-white", "tile-sage"),
    "bedroom": ("carpet-beige", "carpet-gray", "carpet-sky", "planks-maple", "planks-oak", "carpet-lavender"),
    "closet": ("carpet-beige", "planks-oak"),
    "dining room": _WOOD,
    "garage": ("concrete-gray", "concrete-silver"),
    "gym": ("rubber-charcoal", "rubber-gray"),
    "hallway": ("planks-oak", "planks-walnut", "planks-maple", "tile-ivory"),
    "kitchen": ("tile-ivory", "checker-white", "tile-terracotta", "tile-silver"),
    "laundry room": ("tile-silver", "tile-sage", "checker-sky"),
    "library": ("planks-walnut", "carpet-burgundy", "planks-cherry"),
    "living room": _WOOD,
    "office": ("carpet-gray", "planks-oak", "carpet-navy"),
    "playroom": ("carpet-sky", "planks-maple", "carpet-yellow"),
}
"""Room type to floor materials."""

WALLS: dict[str, tuple[str, ...]] = {
    "balcony": ("wall-siding-cream", "wall-brick-terracotta", "wall-siding-white"),
    "bathroom": ("wall-tile-white", "wall-tile-sky", "wall-tile-mint", "wall-tile-ivory"),
    "bedroom": (
        "wall-paint-sky", "wall-paint-lavender", "wall-paint-cream", "wall-stripes-ivory", "wall-damask-sage", "wall-paint-mint",
        "wall-stripes-sky", "wall-paint-pink",
    ),
    "closet": ("wall-paint-ivory", "wall-paint-beige"),
    "dining room": ("wall-paint-cream", "wall-damask-beige", "wall-paint-terracotta", "wall-stripes-sage", "wall-paint-sage"),
    "garage": ("wall-concrete-silver", "wall-concrete-white", "wall-brick-silver"),
    "gym": ("wall-paint-white", "wall-paint-silver", "wall-paint-sky"),
    "hallway": ("wall-paint-ivory", "wall-paint-cream", "wall-paint-beige", "wall-stripes-cream"),
    "kitchen": ("wall-paint-cream", "wall-tile-ivory", "wall-paint-mint", "wall-paint-sky", "wall-paint-yellow"),
    "laundry room": ("wall-paint-sky", "wall-tile-mint", "wall-paint-mint", "wall-paint-yellow"),
    "library": ("wall-panel-oak", "wall-panel-walnut", "wall-damask-olive"),
    "living room": (*(f"wall-paint-{colour}" for colour in _LIVING), "wall-damask-ivory", "wall-stripes-beige"),
    "office": ("wall-paint-sage", "wall-paint-ivory", "wall-panel-maple", "wall-paint-silver"),
    "playroom": ("wall-paint-yellow", "wall-stripes-sky", "wall-paint-mint", "wall-paint-pink"),
}  # fmt: skip
"""Room type to wall materials."""


def choose_styles(rooms: tuple[Room, ...], rng: np.random.Generator) -> tuple[tuple[str, str], ...]:
    """Floor and wall material per room id; rooms of one type differ while there is choice, hallways of a house share theirs."""
    queues: dict[tuple[str, str], list[str]] = {}
    shared: dict[str, tuple[str, str]] = {}
    chosen = []
    for room in rooms:
        if room.type in shared:
            chosen.append(shared[room.type])
            continue
        style = (
            _next("floor", room.type, FLOORS[room.type], queues, rng),
            _next("wall", room.type, WALLS[room.type], queues, rng),
        )
        if room.type == "hallway":
            shared[room.type] = style
        chosen.append(style)
    return tuple(chosen)


def _next(
    part: str, kind: str, options: tuple[str, ...], queues: dict[tuple[str, str], list[str]], rng: np.random.Generator
) -> str:
    queue = queues.setdefault((part, kind), [])
    if not queue:
        queue.extend(options[int(k)] for k in rng.permutation(len(options)))
    return queue.pop()
