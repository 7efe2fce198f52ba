"""Whether a detected category is what a phrase asks for: c in Norm(l) (paper Sec. 3.2, "Local Landmark Memory")."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum
from functools import lru_cache

from spacevln.language import attributes_of, head_noun, norm
from spacevln.perception.attributes import Agreement, agreement


@lru_cache(maxsize=65536)
def names(phrase: str, category: str) -> bool:
    """Whether a category satisfies a phrase, up to synonyms; openings stand for each other.

    A kind satisfies its genus: "dining table" is a "table", but "table" is no "dining table" and no "coffee table" either.
    """
    head, found = head_noun(phrase), head_noun(category)
    if not head or not found:
        return False
    return found in norm(phrase) or found.split()[-1] == head


@lru_cache(maxsize=65536)
def fit(phrase: str, category: str, attributes: tuple[str, ...] = ()) -> Agreement | None:
    """How well a detection fits a phrase; None when its category does not.

    Attribute words may stand in ``attributes`` or, as open-vocabulary detectors give them, in the category itself.
    """
    if not names(phrase, category):
        return None
    return agreement(attributes_of(phrase), (*attributes_of(category), *attributes))


def best_fit(phrases: Iterable[str], category: str, attributes: tuple[str, ...] = ()) -> Agreement | None:
    """The best fit to any of several phrases."""
    fits = [verdict for phrase in phrases if (verdict := fit(phrase, category, attributes)) is not None]
    return max(fits, key=lambda verdict: verdict.value, default=None)


class Match(IntEnum):
    """How well a seen thing's name fits an object goal's."""

    KIND = 1  # of the same genus: "wall cabinet" for "cabinet"
    NAME = 2  # the very name or another name of the same


def match(goal: str, name: str, attributes: tuple[str, ...]) -> Match | None:
    """How well a thing of a name fits a goal; None when it does not.

    An object goal names a category, so that a qualifier on one side alone makes another kind: a "round table" is a kind of
    "table", and a "table" need not be round.
    """
    if fit(goal, name, attributes) is not Agreement.AGREED:
        return None
    wanted, found = _words(goal), _words(name)
    if wanted == found:
        return Match.NAME
    qualified = found[-len(wanted) :] == wanted or wanted[-len(found) :] == found
    return Match.NAME if head_noun(goal) == head_noun(name) and not qualified else Match.KIND


def _words(name: str) -> list[str]:
    return name.lower().replace("-", " ").split()
