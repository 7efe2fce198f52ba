"""Furnishing a whole house."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.furniture import recipes, service
from spacevln.environments.houses.furniture.space import RoomSpace, Taste
from spacevln.environments.houses.furniture.styles import choose_styles
from spacevln.environments.houses.ground.placement import PlacementGuard
from spacevln.environments.houses.plan import House, Item

_STREAM = 2
RECIPES: dict[str, Callable[[RoomSpace], None]] = {
    "balcony": service.balcony,
    "bathroom": service.bathroom,
    "bedroom": recipes.bedroom,
    "closet": service.closet,
    "dining room": recipes.dining_room,
    "garage": service.garage,
    "gym": service.gym,
    "hallway": recipes.hallway,
    "kitchen": service.kitchen,
    "laundry room": service.laundry_room,
    "library": recipes.library,
    "living room": recipes.living_room,
    "office": recipes.office,
    "playroom": service.playroom,
}
"""Room type to the way it is furnished."""


def furnish(house: House) -> House:
    """Furnish every room by its type, and choose its floor and walls; the same house for the same seed.

    Args:
        house: a floor plan; items that it may have are replaced.

    Raises:
        UnknownNameError: a room is of a type without a recipe.
    """
    for room in house.rooms:
        if room.type not in RECIPES:
            raise UnknownNameError("room type", room.type, RECIPES)
    house = replace(house, items=())
    rng = np.random.default_rng([house.seed, _STREAM])
    styles = choose_styles(house.rooms, rng)
    guard, taste = PlacementGuard(house), Taste(rng)
    next_id = 1 + max([0, *(o.id for o in house.openings), *(s.id for s in house.stairs)])
    items: list[Item] = []
    for room in house.rooms:
        space = RoomSpace(house, room, guard, rng, taste, next_id)
        RECIPES[room.type](space)
        items += space.items
        next_id = space.next_id
    return replace(house, items=tuple(items), styles=styles)
