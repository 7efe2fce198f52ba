"""From a seed or a scene name to a house."""

from __future__ import annotations

import re
from functools import lru_cache

from spacevln.core.errors import UsageError
from spacevln.environments.houses.furniture import furnish
from spacevln.environments.houses.layout import generate_layout
from spacevln.environments.houses.plan import House

_NAME = re.compile(r"house-(\d{6,12})")


@lru_cache(maxsize=32)
def build_house(seed: int) -> House:
    """The furnished house of a seed; the same object for the same seed while it is among the last 32.

    Raises:
        UsageError: the seed is negative.
    """
    if seed < 0:
        raise UsageError(f"House seed {seed} is negative: give a whole number from 0 on.")
    return furnish(generate_layout(seed))


def parse_scene_name(name: str) -> int:
    """The seed of a scene name.

    >>> parse_scene_name("house-000017")
    17

    Raises:
        UsageError: it is not the name of a house.
    """
    match = _NAME.fullmatch(name)
    if match is None or f"house-{int(match[1]):06d}" != name:
        raise UsageError(
            f'Scene {name!r} is not a house: give "house-" and the seed in at least six digits, e.g. "house-000017".'
        )
    return int(match[1])
