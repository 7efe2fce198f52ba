"""Typed clauses with a formal meaning: what an instruction says before it is words.

A clause's meaning is a sequence of *atoms*, predicates over walks (:mod:`.semantics` evaluates them). Its code is the clause
template of R2R that it realises: T1 turn, T3 turn into, T4 take a left, T5 take the second left, M1 straight, H1 down the
hallway, X1 leave, N1 enter, D1 through, P1 past, G1 to, S1 stairs, A1 around, O1 orientation, V1 there is, Z1 to Z8 stop.
"""

from __future__ import annotations

from dataclasses import dataclass

from spacevln.environments.houses.plan import Item

LEFT, RIGHT = 1, -1
ANY_ROOM = "room"


@dataclass(frozen=True, slots=True)
class Thing:
    """What a noun phrase for a landmark means: any item of one of the categories that has all the attributes."""

    noun: str
    categories: tuple[str, ...]
    attributes: tuple[str, ...] = ()

    def matches(self, item: Item) -> bool:
        """Whether the phrase may mean this item."""
        return item.category in self.categories and set(self.attributes) <= set(item.attributes)


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn to a side (+1 left, -1 right), around (0), at a thing if given."""

    side: int
    degree: str = ""
    at: Thing | None = None


@dataclass(frozen=True, slots=True)
class Straight:
    """Keep the direction."""


@dataclass(frozen=True, slots=True)
class Along:
    """Walk at least a metre in a space of the type; to its end if ``end``."""

    space: str
    end: bool = False


@dataclass(frozen=True, slots=True)
class Pass:
    """Pass a thing, which is then on a side (0: either)."""

    thing: Thing
    side: int = 0


@dataclass(frozen=True, slots=True)
class Between:
    """Pass between two things."""

    one: Thing
    two: Thing


@dataclass(frozen=True, slots=True)
class Toward:
    """Approach a visible thing to within reach."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class See:
    """A thing is in sight; on a side of the heading (0: anywhere, 2: behind, 3: ahead)."""

    thing: Thing
    side: int = 0


@dataclass(frozen=True, slots=True)
class Cross:
    """Walk through a portal. Empty strings and zeros leave a property open.

    Args:
        source: type of the room that is left.
        target: type of the room that is entered; ``"room"`` means any.
        kind: ``"doorway"``, ``"opening"`` or ``"stairs"``.
        attributes: of the portal.
        turn: side of the turn into it.
        side: side on which it lies.
        ordinal: among those on its side; -1 is the last.
        climb: +1 up, -1 down.
    """

    source: str = ""
    target: str = ""
    kind: str = ""
    attributes: tuple[str, ...] = ()
    turn: int = 0
    side: int = 0
    ordinal: int = 0
    climb: int = 0


@dataclass(frozen=True, slots=True)
class Stop:
    """Where to end.

    Args:
        relation: ``here``, ``near``, ``front``, ``on``, ``between`` (things); ``doorway``, ``door`` (portals);
            ``inside``, ``in``, ``outside``, ``end`` (spaces); ``top``, ``bottom`` (stairs).
        thing, other: landmarks.
        space: type of a space.
        side: of a portal.
        ordinal: of a portal.
    """

    relation: str
    thing: Thing | None = None
    other: Thing | None = None
    space: str = ""
    side: int = 0
    ordinal: int = 0


Atom = Turn | Straight | Along | Pass | Between | Toward | See | Cross | Stop


@dataclass(frozen=True, slots=True)
class Clause:
    """A typed clause.

    Args:
        codes: R2R clause templates that it counts as; the first selects its phrases.
        form: which family of phrases words it.
        atoms: its meaning.
        slots: words for the phrases: (name, text) pairs.
        nouns: what it names, for counting anchors.
        wrap: ``"once"``, ``"until"`` or empty: as an event before the next clause, or after the previous one.
    """

    codes: tuple[str, ...]
    form: str
    atoms: tuple[Atom, ...]
    slots: tuple[tuple[str, str], ...] = ()
    nouns: tuple[str, ...] = ()
    wrap: str = ""

    @property
    def is_stop(self) -> bool:
        """Whether the clause ends the instruction."""
        return any(isinstance(atom, Stop) for atom in self.atoms)


def anchors(clauses: tuple[Clause, ...]) -> int:
    """Space-landmark anchors: clauses that name something and move, a stop that names only the same noun merged."""
    count = 0
    last: tuple[str, ...] = ()
    for clause in clauses:
        if not clause.nouns or clause.codes[0] in ("O1", "V1"):
            continue
        if (clause.is_stop or clause.wrap) and set(clause.nouns) <= set(last):
            continue
        count += 1
        last = clause.nouns
    return count


def mentions(clauses: tuple[Clause, ...]) -> tuple[int, int]:
    """(landmarks and openings named, how many of them with an attribute)."""
    named = attributed = 0
    for clause in clauses:
        for atom in clause.atoms:
            for thing in _things(atom):
                named += 1
                attributed += bool(thing.attributes)
            if isinstance(atom, Cross) and atom.kind in ("doorway", "opening"):
                named += 1
                attributed += bool(atom.attributes)
    return named, attributed


def _things(atom: Atom) -> tuple[Thing, ...]:
    match atom:
        case Turn(at=Thing() as thing):
            return (thing,)
        case Pass(thing=thing) | Toward(thing=thing) | See(thing=thing):
            return (thing,)
        case Between(one=one, two=two):
            return one, two
        case Stop(thing=Thing() as thing, other=other):
            return (thing,) if other is None else (thing, other)
        case _:
            return ()
