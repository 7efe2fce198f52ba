import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacevln.language import grounding_terms, known_categories, norm
from spacevln.language.vocabulary import ATTRIBUTES, TERMS
from spacevln.perception import Agreement, fit, names
from spacevln.perception.matching import best_fit

ADJECTIVES = st.lists(st.sampled_from(sorted(ATTRIBUTES)), max_size=2)
NOUNS = st.sampled_from([*sorted(" ".join(term) for term in TERMS), "zorgle", "teal contraption"])


@pytest.mark.parametrize(
    ("phrase", "category"),
    [
        ("white sofa", "sofa"),
        ("couch", "sofa"),
        ("the large table", "dining table"),
        ("doorway", "door"),
        ("door", "opening"),
        ("staircase", "stairs"),
    ],
)
def test_a_phrase_is_named_by_its_synonyms_and_kinds(phrase: str, category: str) -> None:
    assert names(phrase, category)


@pytest.mark.parametrize(
    ("phrase", "category"),
    [("sofa", "bed"), ("coffee table", "dining table"), ("dining table", "table"), ("", "sofa"), ("sofa", "")],
)
def test_other_things_are_not(phrase: str, category: str) -> None:
    assert not names(phrase, category)


def test_attributes_agree_contradict_or_stay_open() -> None:
    assert fit("white sofa", "sofa", ("white", "leather")) is Agreement.AGREED
    assert fit("white sofa", "sofa", ("cream",)) is Agreement.AGREED
    assert fit("white sofa", "sofa", ("black", "leather")) is Agreement.CONTRADICTED
    assert fit("white sofa", "sofa", ("leather",)) is Agreement.UNKNOWN
    assert fit("white sofa", "white sofa") is Agreement.AGREED
    assert fit("white sofa", "black sofa") is Agreement.CONTRADICTED
    assert fit("sofa", "sofa", ("black",)) is Agreement.AGREED
    assert fit("white sofa", "bed", ("white",)) is None


@settings(max_examples=150, deadline=None)
@given(
    adjectives=ADJECTIVES,
    noun=NOUNS,
    seen=ADJECTIVES,
    category=st.one_of(st.sampled_from(known_categories()), st.just("zorgle"), NOUNS),
)
def test_a_label_fits_the_terms_of_a_phrase_as_it_fits_the_bare_names(
    adjectives: list[str], noun: str, seen: list[str], category: str
) -> None:
    """So that asking the attributes as well changes nothing for a detector that reads labels."""
    phrase = " ".join((*adjectives, noun))
    assert best_fit(grounding_terms(phrase), category, tuple(seen)) == best_fit(norm(phrase), category, tuple(seen))
