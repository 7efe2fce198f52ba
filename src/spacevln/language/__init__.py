"""Words and what they stand for: landmark normalisation (Norm), ParseRegion, the lexicon and the clause parser. Standard library only."""

from spacevln.language.clauses import Clause, ClauseType, parse
from spacevln.language.grounding import (
    attributes_of,
    cue_kind,
    head_noun,
    infer_region,
    known_categories,
    known_regions,
    norm,
    normalise_region,
    parse_region,
    region_kind,
    region_scores,
    same_thing,
)
from spacevln.language.phrases import NounPhrase
from spacevln.language.regions_lexicon import REGION_CUES
from spacevln.language.vocabulary import NounKind

__all__ = [
    "REGION_CUES",
    "Clause",
    "ClauseType",
    "NounKind",
    "NounPhrase",
    "attributes_of",
    "cue_kind",
    "head_noun",
    "infer_region",
    "known_categories",
    "known_regions",
    "norm",
    "normalise_region",
    "parse",
    "parse_region",
    "region_kind",
    "region_scores",
    "same_thing",
]
