import pytest

from spacevln.perception import Agreement, fit, names


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
