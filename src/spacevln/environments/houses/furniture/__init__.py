"""The object catalogue and the furnishing of houses."""

from __future__ import annotations

from spacevln.environments.houses.furniture import (
    bathroom,
    beds,
    decor,
    electronics,
    garage,
    hangings,
    kitchen,
    leisure,
    seating,
    shapes,
    storage,
    tables,
)
from spacevln.environments.houses.furniture.kit import CATALOGUE, Design, Kind, Look, design

# isort: split
# the recipes look categories up, so the builders above come first
from spacevln.environments.houses.furniture.furnish import RECIPES, furnish

_BUILDERS = (bathroom, beds, decor, electronics, garage, hangings, kitchen, leisure, seating, shapes, storage, tables)
"""Imported for what they register."""

__all__ = ["CATALOGUE", "RECIPES", "Design", "Kind", "Look", "design", "furnish"]
