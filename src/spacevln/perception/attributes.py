"""Whether the attributes of what was seen agree with those of a phrase such as "the white sofa".

Words belong to families (colours, materials, sizes, shapes). A word of the phrase is *contradicted* only by another word of
its own family: a "black" sofa contradicts "white", a "leather" one does not. Near words (beige and cream, oak and wooden)
count as the same.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from spacevln.language.nouns_lexicon import COLOURS, MATERIALS, SHAPES, SIZES

_FAMILIES = tuple(frozenset(family) for family in (COLOURS, MATERIALS, SIZES, SHAPES))
_NEAR = tuple(
    frozenset(group.split())
    for group in (
        "white cream ivory light",
        "beige cream tan ivory",
        "brown tan wooden wood oak walnut",
        "brown dark walnut",
        "black dark charcoal",
        "grey gray silver metal steel stainless chrome",
        "grey gray charcoal",
        "blue navy teal turquoise",
        "green teal olive mint",
        "red maroon burgundy",
        "yellow gold golden",
        "wooden wood oak walnut pine hardwood",
        "metal steel stainless chrome iron brass copper",
        "fabric velvet linen",
        "wicker rattan",
        "stone marble granite concrete brick",
        "tiled tile ceramic",
        "round circular oval",
        "square rectangular",
        "large big huge giant long wide tall",
        "small little tiny short low",
    )
)


class Agreement(Enum):
    """How the attributes of a phrase fit what was seen; the value is the highest confidence that fit allows."""

    AGREED = 1.0
    UNKNOWN = 0.8  # the phrase says more than the detector knows
    CONTRADICTED = 0.35  # kept as weak evidence; never arrived at


def _same(a: str, b: str) -> bool:
    return a == b or any(a in group and b in group for group in _NEAR)


def agreement(wanted: Iterable[str], seen: Iterable[str]) -> Agreement:
    """Compare the attribute words of a phrase with those of an instance.

    ``Agreement.value`` caps a confidence instead of scaling it, so that applying it twice (in a detector and again in Local
    Landmark Memory) changes nothing.
    """
    seen_words = frozenset(word for attribute in seen for word in attribute.split())
    verdict = Agreement.AGREED
    for word in wanted:
        if any(_same(word, other) for other in seen_words):
            continue
        if any(word in family and family & seen_words for family in _FAMILIES):
            return Agreement.CONTRADICTED
        verdict = Agreement.UNKNOWN
    return verdict
