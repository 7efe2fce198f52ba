"""Clause constructors: each pairs the words of a clause (slots) with its meaning (atoms)."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.episodes.clauses import (
    ANY_ROOM,
    Along,
    Between,
    Clause,
    Cross,
    Pass,
    See,
    Stop,
    Straight,
    Thing,
    Toward,
    Turn,
)
from spacevln.environments.houses.episodes.nouns import (
    ORDINAL_WORDS,
    SIDE_WORDS,
    definite,
    indefinite,
    portal_words,
    room_words,
    thing_words,
)
from spacevln.environments.houses.episodes.topology import Portal
from spacevln.environments.houses.plan import Room

ONCE_FORMS = frozenset(("exit", "enter", "past", "through_door", "stairs_up", "stairs_down", "hall_end", "through_space"))
UNTIL_FORMS = frozenset(("enter", "toward", "go_to_space", "stop_near_reach", "through_door"))
UNTIL_AFTER = frozenset(("straight", "hall", "past", "straight_past", "turn_down"))

Rng = np.random.Generator


def _side(angle: float) -> int:
    return 1 if angle > 0 else -1


def _words(angle_or_side: float) -> tuple[tuple[str, str], ...]:
    return (("side", SIDE_WORDS[_side(angle_or_side)]),)


def _thing(thing: Thing) -> tuple[tuple[str, str], ...]:
    words = thing_words(thing)
    return (("lm", definite(words)), ("a_lm", indefinite(words)))


def _space(room: Room, rng: Rng) -> tuple[tuple[tuple[str, str], ...], str, str]:
    words = room_words(room.type, rng)
    return (("space", definite(words)), ("space_bare", words)), words, room.type.replace("_", " ")


def turn(angle: float) -> Clause:
    """T1."""
    return Clause(("T1",), "turn", (Turn(_side(angle)),), _words(angle))


def take_turn(angle: float) -> Clause:
    """T4."""
    return Clause(("T4",), "take_turn", (Turn(_side(angle)),), _words(angle))


def turn_at(angle: float, thing: Thing, rng: Rng) -> Clause:
    """T2, or T4 at a landmark."""
    atoms = (Turn(_side(angle), at=thing),)
    if rng.random() < 0.7:
        return Clause(("T2",), "turn_at", atoms, _words(angle) + _thing(thing), (thing.noun,))
    return Clause(("T4",), "take_turn_at", atoms, _words(angle) + _thing(thing), (thing.noun,))


def turn_down(angle: float, room: Room, rng: Rng) -> Clause:
    """T3 with a hallway."""
    slots, noun, kind = _space(room, rng)
    return Clause(("T3",), "turn_down", (Turn(_side(angle)), Along(kind)), _words(angle) + slots, (noun,))


def turn_into(angle: float, room: Room, rng: Rng) -> Clause:
    """T3 with the room that is entered."""
    slots, noun, kind = _space(room, rng)
    return Clause(("T3",), "turn_into", (Cross(target=kind, turn=_side(angle)),), _words(angle) + slots, (noun,))


def slight(angle: float, rng: Rng) -> Clause:
    """T6, gentle."""
    del rng
    return Clause(("T6",), "slight", (Turn(_side(angle), "slight"),), _words(angle))


def sharp(angle: float, rng: Rng) -> Clause:
    """T6, tight."""
    del rng
    return Clause(("T6",), "sharp", (Turn(_side(angle)),), _words(angle))


def around(rng: Rng) -> Clause:
    """T7."""
    del rng
    return Clause(("T7",), "around", (Turn(0),))


def straight(rng: Rng) -> Clause:
    """M1."""
    del rng
    return Clause(("M1",), "straight", (Straight(),))


def straight_past(thing: Thing) -> Clause:
    """M2 past a landmark."""
    return Clause(("M2", "P1"), "straight_past", (Straight(), Pass(thing)), _thing(thing), (thing.noun,))


def straight_through(portal: Portal, rng: Rng) -> Clause:
    """M2 through an opening."""
    noun, kind = portal_words(portal, rng)
    return Clause(("M2", "D1"), "straight_through", (Straight(), Cross(kind=kind)), (("door", definite(noun)),), (noun,))


def straight_into(room: Room, rng: Rng) -> Clause:
    """M2 into a space."""
    slots, noun, kind = _space(room, rng)
    return Clause(("M2",), "straight_into", (Straight(), Cross(target=kind)), slots, (noun,))


def hallway(room: Room, rng: Rng, end: bool) -> Clause:
    """H1."""
    slots, noun, kind = _space(room, rng)
    return Clause(("H1",), "hall_end" if end else "hall", (Along(kind, end),), slots, (noun,))


def through_space(room: Room, rng: Rng) -> Clause:
    """D2 or A2."""
    slots, noun, kind = _space(room, rng)
    if rng.random() < 0.62:
        return Clause(("D2",), "through_space", (Along(kind),), slots, (noun,))
    return Clause(("A2",), "across_space", (Along(kind),), slots, (noun,))


def past(thing: Thing) -> Clause:
    """P1."""
    return Clause(("P1",), "past", (Pass(thing),), _thing(thing), (thing.noun,))


def over(thing: Thing) -> Clause:
    """P1 with a rug."""
    return Clause(("P1",), "over", (Pass(thing),), _thing(thing), (thing.noun,))


def past_side(thing: Thing, side: int) -> Clause:
    """P2."""
    return Clause(("P2",), "past_side", (Pass(thing, side),), _words(side) + _thing(thing), (thing.noun,))


def side_of(thing: Thing, side: int) -> Clause:
    """G2: keeping to a side of a landmark, which is then on the other side."""
    return Clause(("G2",), "side_of", (Pass(thing, -side),), _words(side) + _thing(thing), (thing.noun,))


def around_thing(thing: Thing) -> Clause:
    """A1."""
    return Clause(("A1",), "around_thing", (Pass(thing),), _thing(thing), (thing.noun,))


def along_thing(thing: Thing) -> Clause:
    """A4."""
    return Clause(("A4",), "along_thing", (Pass(thing),), _thing(thing), (thing.noun,))


def between(one: Thing, two: Thing) -> Clause:
    """A3."""
    slots = (("lm", definite(thing_words(one))), ("lm2", definite(thing_words(two))))
    return Clause(("A3",), "between", (Between(one, two),), slots, (one.noun, two.noun))


def toward(thing: Thing, rng: Rng) -> Clause:
    """G1 with a landmark."""
    del rng
    return Clause(("G1",), "toward", (Toward(thing),), _thing(thing), (thing.noun,))


def there_is(thing: Thing, side: int) -> Clause:
    """V1."""
    return Clause(("V1",), "there_is", (Pass(thing, side),), _words(side) + _thing(thing), (thing.noun,))


def orient(thing: Thing, side: int) -> Clause:
    """O1: which way to face at the start."""
    form = {2: "with_behind", 3: "facing"}.get(side, "with_side")
    return Clause(("O1",), form, (See(thing, side),), (_words(side) if abs(side) == 1 else ()) + _thing(thing), (thing.noun,))


def leave(room: Room, rng: Rng) -> Clause:
    """X1."""
    slots, noun, kind = _space(room, rng)
    if rng.random() < 0.14:
        return Clause(("X1",), "exit", (Cross(source=kind),), (("space", "the room"), ("space_bare", "room")), ("room",))
    return Clause(("X1",), "exit", (Cross(source=kind),), slots, (noun,))


def leave_through(room: Room, portal: Portal, rng: Rng) -> Clause:
    """X2 through an opening."""
    slots, noun, kind = _space(room, rng)
    door, means = portal_words(portal, rng)
    atoms = (Cross(source=kind, kind=means),)
    return Clause(("X2",), "exit_through", atoms, (*slots, ("door", definite(door))), (noun, door))


def leave_into(room: Room, there: Room, rng: Rng) -> Clause:
    """X2 into a space."""
    slots, noun, kind = _space(room, rng)
    other = room_words(there.type, rng)
    atoms = (Cross(source=kind, target=there.type.replace("_", " ")),)
    return Clause(("X2",), "exit_into", atoms, (*slots, ("space2", definite(other))), (noun, other))


def enter(room: Room, rng: Rng) -> Clause:
    """N1."""
    slots, noun, kind = _space(room, rng)
    return Clause(("N1",), "enter", (Cross(target=kind),), slots, (noun,))


def go_to_space(room: Room, rng: Rng) -> Clause:
    """G1 with a space."""
    slots, noun, kind = _space(room, rng)
    return Clause(("G1",), "go_to_space", (Cross(target=kind),), slots, (noun,))


def through_door(portal: Portal, rng: Rng, attributed: bool) -> Clause:
    """D1."""
    noun, kind = portal_words(portal, rng)
    attributes = portal.attributes[:1] if attributed else ()
    if attributes and attributes[0] == "arched" and noun == "archway":
        attributes = ()
    words = " ".join([*attributes, noun])
    slots = (("door", definite(words)), ("a_door", indefinite(words)))
    return Clause(("D1",), "through_door", (Cross(kind=kind, attributes=attributes),), slots, (noun,))


def door_on_side(portal: Portal, side: int, rng: Rng) -> Clause:
    """N3 with an opening."""
    noun, kind = portal_words(portal, rng)
    return Clause(("N3", "D1"), "door_side", (Cross(kind=kind, side=side),), (*_words(side), ("door", definite(noun))), (noun,))


def room_on_side(room: Room, side: int, rng: Rng) -> Clause:
    """N3 with a space."""
    slots, noun, kind = _space(room, rng)
    if rng.random() < 0.3 and room.type not in ("hallway", "balcony"):
        slots, noun, kind = (("space", "the room"), ("space_bare", "room")), "room", ANY_ROOM
    return Clause(("N3", "N1"), "room_side", (Cross(target=kind, side=side),), _words(side) + slots, (noun,))


def ordinal_door(portal: Portal, side: int, ordinal: int, rng: Rng) -> Clause:
    """N2 with an ordinal."""
    noun, _ = portal_words(portal, rng)
    slots = (*_words(side), ("door", noun), ("ord", ORDINAL_WORDS[ordinal]))
    return Clause(("N2",), "ordinal_door", (Cross(side=side, ordinal=ordinal),), slots, (noun,))


def ordinal_turn(side: int, ordinal: int) -> Clause:
    """T5."""
    slots = (*_words(side), ("ord", ORDINAL_WORDS[ordinal]))
    return Clause(("T5",), "ordinal_turn", (Cross(side=side, ordinal=ordinal),), slots)


def next_room() -> Clause:
    """N2 with "next"."""
    return Clause(("N2",), "next_room", (Cross(target=ANY_ROOM),), (), ("room",))


def stairs(climb: int, rng: Rng) -> Clause:
    """S1."""
    word = ("stairs", "stairs", "stairs", "stairs", "staircase", "steps")[int(rng.integers(6))]
    form = "stairs_up" if climb > 0 else "stairs_down"
    return Clause(("S1",), form, (Cross(climb=climb),), (("stairs", word),), ("stairs",))


def stop(codes: tuple[str, ...], form: str, meaning: Stop, slots: tuple[tuple[str, str], ...], nouns: tuple[str, ...]) -> Clause:
    """Z1 to Z8."""
    return Clause(codes, form, (meaning,), slots, nouns)
