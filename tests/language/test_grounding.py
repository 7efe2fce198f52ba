"""Norm, ParseRegion and region inference."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.core import Anchor, CueKind, SpaceKind
from spacevln.language import (
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
    same_thing,
)


@pytest.mark.parametrize(
    ("phrase", "head"),
    [
        ("the large white couch", "sofa"),
        ("fridge", "refrigerator"),
        ("dining room table", "dining table"),
        ("the TV", "television"),
        ("bathroom door", "doorway"),
        ("exit sign", "exit sign"),
        ("the table next to the bed", "table"),
        ("zorgle", "zorgle"),
    ],
)
def test_head_noun_is_canonical_and_takes_the_longest_name(phrase: str, head: str) -> None:
    assert head_noun(phrase) == head


def test_norm_gives_the_whole_alias_group_canonical_first() -> None:
    assert norm("white couch")[0] == "sofa"
    assert {"sofa", "couch", "loveseat"} <= set(norm("white couch"))
    assert norm("door")[0] == "doorway"
    assert norm("") == ()


def test_a_general_chair_may_be_an_armchair_but_not_the_other_way_round() -> None:
    assert "armchair" in norm("chair")
    assert "chair" not in norm("armchair")


def test_attributes_come_before_the_head_in_one_spelling() -> None:
    assert attributes_of("the large gray leather sofa") == ("large", "grey", "leather")
    assert attributes_of("sofa") == ()


@pytest.mark.parametrize(
    ("phrase", "name"),
    [
        ("the white couch by the window", "white couch"),
        ("the big gray leather sofa", "big gray leather sofa"),
        ("second brown doorway on the right", "brown doorway"),
        ("red zorgle", "red zorgle"),
    ],
)
def test_a_detector_is_asked_the_attributes_as_written_and_then_the_bare_names(phrase: str, name: str) -> None:
    assert grounding_terms(phrase) == (name, *norm(phrase))


@given(st.sampled_from(known_categories()))
def test_without_attributes_it_is_asked_the_bare_names(category: str) -> None:
    assert grounding_terms(f"the {category}") == norm(category)


def test_every_canonical_category_is_its_own_head() -> None:
    assert [name for name in known_categories() if head_noun(name) != name] == []


@pytest.mark.parametrize(
    ("text", "region"),
    [
        ("corridor", "hallway"),
        ("study", "office"),
        ("the Living Area", "living room"),
        ("walk-in closet", "closet"),
        ("kitchen zone", "kitchen"),
        ("staircase", "stairs"),
        ("boiler chamber", "boiler chamber"),
        ("", ""),
    ],
)
def test_regions_are_normalised_and_unknown_text_is_kept(text: str, region: str) -> None:
    assert normalise_region(text) == region


def test_region_types_normalise_to_themselves() -> None:
    assert [region for region in known_regions() if normalise_region(region) != region] == []


def test_kinds_of_spaces_and_cues() -> None:
    assert region_kind("hall") is SpaceKind.CONNECTOR
    assert region_kind("stairs") is SpaceKind.FLOOR_TRANSITION
    assert region_kind("bedroom") is SpaceKind.ROOM
    assert region_kind("boiler chamber") is SpaceKind.UNKNOWN
    assert cue_kind("") is CueKind.NONE
    assert cue_kind("glass door") is CueKind.OPENING
    assert cue_kind("staircase") is CueKind.STAIRS
    assert cue_kind("white sofa") is CueKind.SOLID


def test_parse_region_splits_an_anchor_and_keeps_three_cues() -> None:
    assert parse_region("family room - sofa / tv / rug / lamp") == ("living room", ("sofa", "tv", "rug"))
    assert parse_region(Anchor("study", SpaceKind.ROOM, "desk", CueKind.SOLID)) == ("office", ("desk",))
    assert parse_region("") == ("", ())


def test_rooms_are_told_by_what_stands_in_them() -> None:
    assert infer_region([("bed", 2.0), ("nightstand", 2.0), ("painting", 1.0)]) == "bedroom"
    assert infer_region([("toilet", 2.0), ("sink", 1.0)]) == "bathroom"
    assert infer_region([("stove", 1.0), ("fridge", 1.0), ("dining chair", 4.0)]) == "kitchen"
    assert infer_region([("painting", 1.0)]) == ""
    assert infer_region([]) == ""


def test_same_thing_up_to_synonyms() -> None:
    assert same_thing("couch", "the white sofa")
    assert not same_thing("chair", "sofa")
    assert not same_thing("", "")


@given(st.text(max_size=200))
def test_no_text_breaks_the_lexicon(text: str) -> None:
    assert isinstance(norm(text), tuple)
    assert isinstance(normalise_region(text), str)
    assert isinstance(cue_kind(text), CueKind)
    region, cues = parse_region(text)
    assert isinstance(region, str)
    assert len(cues) <= 3
