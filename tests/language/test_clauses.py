"""The clause parser: types, slots, order, and any input."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.language import ClauseType as T
from spacevln.language import NounKind, parse


def types(text: str) -> list[T]:
    return [clause.type for clause in parse(text)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Turn left.", [T.TURN]),
        ("Turn around and leave the bedroom.", [T.TURN_AROUND, T.LEAVE]),
        ("Walk past the sofa and through the door on the left.", [T.PAST, T.THROUGH]),
        ("Exit the kitchen into the hallway.", [T.LEAVE, T.ENTER]),
        ("Go down the hall to the end.", [T.ALONG]),
        ("Walk up the stairs and wait at the top of the stairs.", [T.STAIRS, T.STOP]),
        ("Walk between the chair and the table.", [T.BETWEEN]),
        ("Go straight until you reach the piano.", [T.STRAIGHT, T.TO]),
        ("Walk to the right of the bench.", [T.PAST]),
        ("Go around the bed, cross the room and stop.", [T.AROUND, T.ACROSS, T.STOP]),
        ("With the bed on your left, walk forward.", [T.ORIENT, T.STRAIGHT]),
    ],
)
def test_clauses_are_typed(text: str, expected: list[T]) -> None:
    found = types(text)
    assert [kind for kind in found if kind is not T.NOTICE] == [kind for kind in expected if kind is not T.NOTICE]


def test_slots_of_a_turn() -> None:
    (turn,) = parse("Make a slight right at the white sofa.")
    assert (turn.side, turn.degree, turn.relation) == ("right", "slight", "at")
    assert turn.place is not None
    assert (turn.place.head, turn.place.attributes) == ("sofa", ("white",))


def test_ordinals_and_sides_of_doors() -> None:
    (door,) = parse("Go through the second door on your right.")
    assert door.type is T.THROUGH
    assert door.place is not None
    assert (door.place.kind, door.place.ordinal, door.place.side) == (NounKind.OPENING, 2, "right")
    (branch,) = parse("Take the third left.")
    assert (branch.type, branch.side, branch.ordinal) == (T.TURN, "left", 3)


def test_a_door_to_a_room_is_a_door_and_no_entering() -> None:
    (stop,) = parse("Stop at the bathroom door.")
    assert stop.type is T.STOP
    assert stop.place is not None
    assert (stop.place.kind, stop.place.region) == (NounKind.OPENING, "bathroom")
    (other,) = parse("Stop in the doorway of the kitchen.")
    assert other.place is not None
    assert other.place.region == "kitchen"


@pytest.mark.parametrize(
    ("text", "relation", "head"),
    [
        ("Wait by the lamp.", "next to", "lamp"),
        ("Stop in front of the fireplace.", "in front of", "fireplace"),
        ("Stand just inside the bedroom.", "in", "bedroom"),
        ("Stop outside of the office.", "outside", "office"),
        ("Stop before you enter the kitchen.", "before", "kitchen"),
    ],
)
def test_stop_relations(text: str, relation: str, head: str) -> None:
    stop = parse(text)[-1]
    assert stop.type is T.STOP
    assert stop.place is not None
    assert (stop.relation, stop.place.head) == (relation, head)


def test_conditions_come_before_the_action_they_qualify() -> None:
    assert types("Stop once you pass the sofa.") == [T.PAST, T.STOP]
    assert types("Once you exit the room, turn left.") == [T.LEAVE, T.TURN]


def test_right_as_an_adverb_is_no_turn() -> None:
    assert T.TURN not in types("Walk right past the sofa and wait right there.")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "   ",
        "...",
        "\U0001f600\U0001f3e0",
        "\u53bb\u53a8\u623f",
        "\u0418\u0434\u0438 \u043d\u0430 \u043a\u0443\u0445\u043d\u044e",
    ],
)
def test_what_is_no_english_gives_no_clauses(text: str) -> None:
    assert parse(text) == ()


@given(st.text(alphabet=st.characters(codec="utf-8"), max_size=400))
def test_any_text_is_read_without_an_error(text: str) -> None:
    assert all(isinstance(clause.type, T) for clause in parse(text))


@pytest.mark.parametrize(
    "text", ["walk " * 4000, "turn left and " * 1500, "the " * 5000, "stop wait " * 2000, "second door to the " * 1000]
)
def test_long_input_is_read_to_its_end(text: str) -> None:
    long, short = parse(text[:20000]), parse(text[:2000])
    assert len(long) >= len(short)
    assert len(long) <= len(text[:20000].split())
