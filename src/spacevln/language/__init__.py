"""Words and what they stand for: Norm, ParseRegion, the lexicon and the clause parser. Standard library only."""

from spacevln.language.clauses import Clause, parse
from spacevln.language.grammar import ClauseType
from spacevln.language.grounding import (
    attributes_of,
    cue_kind,
    grounding_terms,
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
from spacevln.language.object_rooms import FREE_FLOOR_M2, LOWER_STOREY, OPENS_ON, ROOM_SHARES, SINGLE_ROOMS, chance_in_room
from spacevln.language.phrases import NounPhrase
from spacevln.language.regions_lexicon import REGION_CUES
from spacevln.language.vocabulary import NounKind

__all__ = [
    "FREE_FLOOR_M2",
    "LOWER_STOREY",
    "OPENS_ON",
    "REGION_CUES",
    "ROOM_SHARES",
    "SINGLE_ROOMS",
    "Clause",
    "ClauseType",
    "NounKind",
    "NounPhrase",
    "attributes_of",
    "chance_in_room",
    "cue_kind",
    "grounding_terms",
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
