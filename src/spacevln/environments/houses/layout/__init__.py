"""Floor plans: :func:`generate_layout`, and the solid geometry (walls, slabs, steps, railings) of any house."""

from spacevln.environments.houses.layout.draft import ROOM_TYPES
from spacevln.environments.houses.layout.generate import generate_layout
from spacevln.environments.houses.layout.structure import (
    Railing,
    SlabBox,
    StepBox,
    WallBox,
    hole,
    railings,
    slabs,
    steps,
    walls,
)

__all__ = [
    "ROOM_TYPES",
    "Railing",
    "SlabBox",
    "StepBox",
    "WallBox",
    "generate_layout",
    "hole",
    "railings",
    "slabs",
    "steps",
    "walls",
]
