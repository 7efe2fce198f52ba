"""Norm (paper "Local Landmark Memory") and ParseRegion (paper "Spatial Waypoints and region topology")."""

from __future__ import annotations

import re
from collections.abc import Iterable

from spacevln.core.stages import Anchor, CueKind, SpaceKind
from spacevln.language import nouns_lexicon as nouns
from spacevln.language.regions_lexicon import REGION_ALIASES, REGION_CUES, kind_of
from spacevln.language.vocabulary import ADJECTIVES, ATTRIBUTES, TERMS, NounKind, Term, match, words_of

_ALL_GROUPS = {**nouns.OBJECTS, **nouns.OPENINGS, **nouns.STAIRS}
_OPENING_QUERIES = ("doorway", "door", "opening", "archway", "entrance")
_STOP_WORDS = frozenset({"the", "a", "an", "your", "this", "that", "of", "to", "with", "on", "in", "at", "by", "near", "some"})
_POST = frozenset({"of", "to", "with", "on", "in", "at", "by", "near", "leading", "that", "next", "behind", "under", "beside"})
_GREY = {"gray": "grey", "golden": "gold", "wood": "wooden", "big": "large", "little": "small", "tile": "tiled", "tub": "bathtub"}
MAX_CUES = 3


def _last_term(phrase: str) -> tuple[Term | None, list[str], int]:
    """The head of a noun phrase: its last known noun before any post-modifier, the words, and the noun's start."""
    words = [word for word in words_of(phrase) if word[0].isalnum()]
    cut = next((i for i, word in enumerate(words) if word in _POST and i > 0), len(words))
    words = [word for word in words[:cut] if word not in _STOP_WORDS]
    found: Term | None = None
    start = i = 0
    while i < len(words):
        hit = match(words, i)
        if hit is None:
            i += 1
            continue
        found, start = hit[0], i
        i = hit[1]
    return found, words, start


def head_noun(phrase: str) -> str:
    """Canonical head noun of a phrase: ``"the large white couch"`` gives ``"sofa"``; an unknown noun is kept as written."""
    term, words, _ = _last_term(phrase)
    if term is not None and term.kind is not NounKind.PART:
        return term.name
    rest = [word for word in words if word not in ADJECTIVES] or words
    return " ".join(rest)


def attributes_of(phrase: str) -> tuple[str, ...]:
    """Colour, material, size and shape words before the head noun, in one spelling: ``("large", "white")``."""
    return tuple(_GREY.get(word, word) for word in _attribute_words(phrase))


def _attribute_words(phrase: str) -> list[str]:
    term, words, start = _last_term(phrase)
    limit = start if term is not None else max(len(words) - 1, 0)
    return [word for word in words[:limit] if word in ATTRIBUTES]


def norm(phrase: str) -> tuple[str, ...]:
    """Norm: the grounding queries of a landmark phrase, canonical name first; empty for an empty phrase.

    ``"the white couch"`` gives ``("sofa", "couch", "loveseat", ...)``. All opening-like phrases share their queries.
    """
    head = head_noun(phrase)
    if not head:
        return ()
    if head in nouns.OPENINGS:
        return (head, *(query for query in _OPENING_QUERIES if query != head))
    group = _ALL_GROUPS.get(head)
    if group is None:
        return (head,)
    singular = [alias for alias in group if not (alias.endswith("s") and alias[:-1] in (head, *group))]
    return (head, *singular)


def grounding_terms(phrase: str) -> tuple[str, ...]:
    """What a detector is asked for a landmark phrase: its name with its attributes, as written, then Norm's names.

    ``"the white couch by the window"`` gives ``("white couch", "sofa", "couch", "loveseat", ...)``. A model that reads the
    attributes can tell the white one from others; the bare names find what it cannot tell apart.
    """
    _, words, start = _last_term(phrase)
    attributes, hit = _attribute_words(phrase), match(words, start)
    if not attributes:
        return norm(phrase)
    noun = " ".join(words[start : hit[1]]) if hit is not None and hit[0].kind is not NounKind.PART else head_noun(phrase)
    return (" ".join((*attributes, noun)), *norm(phrase))


def same_thing(category: str, phrase: str) -> bool:
    """Whether a detected category is what the phrase names, up to alias groups and singular or plural."""
    return head_noun(category) == head_noun(phrase) and head_noun(category) != ""


def normalise_region(text: str) -> str:
    """Canonical region type of a free text; unknown text is kept, lower-cased and stripped; ``""`` for none."""
    words = [word for word in words_of(text) if word[0].isalnum() and word not in ("the", "a", "an", "your")]
    if not words:
        return ""
    term = TERMS.get(tuple(words))
    if term is None and words[-1] in ("area", "space", "zone", "section"):
        term = TERMS.get(tuple(words[:-1]))
    if term is not None and term.kind is NounKind.STAIRS:
        return "stairs"
    if term is not None and (term.kind is NounKind.REGION or (term.kind is NounKind.OPENING and term.name == "doorway")):
        return "hallway" if term.kind is NounKind.OPENING else term.name
    return " ".join(words)


def region_kind(region: str) -> SpaceKind:
    """What sort of space a region text names."""
    return kind_of(normalise_region(region))


def cue_kind(phrase: str) -> CueKind:
    """What sort of cue a landmark phrase is; decides the arrival rule."""
    if not phrase.strip():
        return CueKind.NONE
    term, _, _ = _last_term(phrase)
    if term is None or term.kind is NounKind.OBJECT:
        return CueKind.SOLID
    if term.kind is NounKind.STAIRS:
        return CueKind.STAIRS
    return CueKind.OPENING if term.kind is NounKind.OPENING or term.name == "hallway" else CueKind.SOLID


def parse_region(anchor: Anchor | str) -> tuple[str, tuple[str, ...]]:
    """ParseRegion: normalised region type and at most three landmark cues of an anchor (or of its text, ``"space - a / b"``)."""
    if isinstance(anchor, Anchor):
        space, cues = anchor.space, anchor.cue
    else:
        space, _, cues = anchor.partition(" - ")
    listed = tuple(cue.strip() for cue in re.split(r"[/,;]", cues) if cue.strip())
    return normalise_region(space), listed[:MAX_CUES]


def region_scores(seen: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Evidence for each region type from seen ``(category, distance_m)``; near things count more, repeats less."""
    scores: dict[str, float] = {}
    counts: dict[str, int] = {}
    for category, distance_m in sorted(seen, key=lambda item: (item[1], item[0])):
        head = head_noun(category)
        counts[head] = counts.get(head, 0) + 1
        weight = 1.0 / (1.0 + (distance_m / 4.0) ** 2) / counts[head]
        for region, cues in REGION_CUES.items():
            if head in cues:
                scores[region] = scores.get(region, 0.0) + weight * cues[head]
    return scores


def infer_region(seen: Iterable[tuple[str, float]], least: float = 1.0) -> str:
    """The region type that the seen ``(category, distance_m)`` speak for; ``""`` when the evidence is under ``least``."""
    scores = region_scores(seen)
    best = max(scores, key=lambda region: (scores[region], region), default="")
    return best if best and scores[best] >= least else ""


def known_categories() -> tuple[str, ...]:
    """Canonical names of every landmark, opening and stairs category, sorted."""
    return tuple(sorted(_ALL_GROUPS))


def known_regions() -> tuple[str, ...]:
    """Canonical region types, in the paper's order."""
    return tuple(REGION_ALIASES)
