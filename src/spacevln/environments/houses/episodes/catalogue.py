"""Which categories may be asked for."""

from __future__ import annotations

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.furniture import CATALOGUE

_NOT_LOOKED_FOR = frozenset(("curtain", "curtains", "light switch", "railing", "pillow"))


def goal_categories() -> tuple[str, ...]:
    """Every category that an object goal may name, in words: what stands, lies or hangs in reach, nothing under the ceiling."""
    return tuple(sorted(name for name, kind in CATALOGUE.items() if kind.stand != "ceiling" and name not in _NOT_LOOKED_FOR))


def checked_goal(name: str) -> str:
    """A goal as the catalogue spells it.

    Raises:
        UnknownNameError: no house contains such a thing; the message names the nearest category.
    """
    words = " ".join(name.lower().replace("_", " ").split())
    if words not in goal_categories():
        raise UnknownNameError("goal category", name, goal_categories())
    return words
