"""One dictionary of all known terms, matched longest first."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from enum import StrEnum

from spacevln.language import nouns_lexicon as nouns
from spacevln.language.regions_lexicon import REGION_ALIASES

_WORD = re.compile(r"[a-z0-9]+(?:[-'][a-z0-9]+)*|[.;,!?:]")


class NounKind(StrEnum):
    """What sort of thing a noun names."""

    OBJECT = "object"
    OPENING = "opening"
    STAIRS = "stairs"
    REGION = "region"
    GENERIC = "generic"  # "room", "area": a space without a type
    PART = "part"  # "end", "top": of something


@dataclass(frozen=True, slots=True)
class Term:
    """A known noun: canonical name and kind."""

    name: str
    kind: NounKind


def words_of(text: str) -> list[str]:
    """Lower-case ASCII words and punctuation marks of any text; anything else is dropped."""
    plain = unicodedata.normalize("NFKD", text.lower().replace("\u2019", "'")).encode("ascii", "ignore").decode()
    return _WORD.findall(plain)


def _terms() -> dict[tuple[str, ...], Term]:
    terms: dict[tuple[str, ...], Term] = {}

    def add(phrase: str, name: str, kind: NounKind) -> None:
        terms.setdefault(tuple(phrase.replace("-", " ").split()), Term(name, kind))
        terms.setdefault(tuple(phrase.split()), Term(name, kind))

    for part in nouns.PARTS:
        add(part, part, NounKind.PART)
    for groups, kind in ((nouns.STAIRS, NounKind.STAIRS), (nouns.OPENINGS, NounKind.OPENING)):
        for name, aliases in groups.items():
            for phrase in (name, *aliases):
                add(phrase, name, kind)
    for region, aliases in REGION_ALIASES.items():
        for phrase in (region, *aliases):
            add(phrase, region, NounKind.REGION)
            add(phrase + "s", region, NounKind.REGION)
    for name, aliases in nouns.OBJECTS.items():
        for phrase in (name, *aliases):
            add(phrase, name, NounKind.OBJECT)
    for name in nouns.OBJECTS:
        add(name + ("es" if name.endswith(("s", "x", "ch", "sh")) else "s"), name, NounKind.OBJECT)
    for phrase in nouns.GENERIC_SPACES:
        add(phrase, "room" if phrase.endswith("room") or phrase == "rooms" else phrase, NounKind.GENERIC)
    return terms


TERMS = _terms()
_LONGEST = max(len(key) for key in TERMS)


def match(words: list[str], start: int) -> tuple[Term, int] | None:
    """The longest known term that begins at ``start`` and the index after it."""
    for length in range(min(_LONGEST, len(words) - start), 0, -1):
        term = TERMS.get(tuple(words[start : start + length]))
        if term is not None:
            return term, start + length
    return None


ATTRIBUTES = frozenset((*nouns.COLOURS, *nouns.MATERIALS, *nouns.SIZES, *nouns.SHAPES))
ADJECTIVES = ATTRIBUTES | frozenset(nouns.STATES)
