"""From an instruction to the clauses that the search aligns, and to the anchors that the chain names."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import replace

from spacevln.core import Anchor, ModelError, SpaceKind
from spacevln.language import Clause, ClauseType, NounKind, NounPhrase, cue_kind, known_categories, parse, region_kind

T = ClauseType
MAX_CLAUSES = 24
KNOWN = frozenset(known_categories())
_SOFT = (T.NOTICE, T.STRAIGHT, T.ORIENT)


def route_clauses(instruction: str) -> tuple[Clause, ...]:
    """The clauses to follow, the last one a STOP.

    Raises:
        ModelError: the instruction names no place and no action that the rules understand.
    """
    clauses = list(parse(instruction))
    if all(map(_says_nothing, clauses)):
        shown = instruction.strip()[:60]
        raise ModelError(
            f"The instruction {shown!r} names no place or action that the rules understand: give an English route instruction."
        )
    stops = [i for i, clause in enumerate(clauses) if clause.type is T.STOP]
    if stops:
        named = [i for i in stops if clauses[i].place is not None]
        last = named[-1] if named and named[-1] >= stops[-1] - 1 else stops[-1]
        rest = [
            c
            for i, c in enumerate(clauses)
            if i != last and c.type is not T.STOP and not (i > last and c.type in (*_SOFT, T.TURN))
        ]
        clauses = [*rest, clauses[last]]
    else:
        clauses.append(Clause(T.STOP, "stop"))
    return tuple(clauses[: MAX_CLAUSES - 1] + clauses[-1:] if len(clauses) > MAX_CLAUSES else clauses)


def with_implied_climb(clauses: tuple[Clause, ...], leads: Set[str]) -> tuple[Clause, ...]:
    """With the climb that "stop at the top of the stairs" asks for on the floor at their foot.

    Args:
        leads: where stairs lead from the floor of the start.
    """
    if any(clause.type is T.STAIRS for clause in clauses):
        return clauses
    at = next((i for i, clause in enumerate(clauses) if part_of_stairs(clause.place)), None)
    if at is None or (wanted := REACHED_BY[part_of_stairs(clauses[at].place)]) not in leads or len(leads) > 1:
        return clauses
    return (*clauses[:at], Clause(T.STAIRS, "", vertical=wanted), *clauses[at:])


def part_of_stairs(phrase: NounPhrase | None) -> str:
    """Which end of a flight a phrase names: ``"top"``, ``"bottom"``, ``"foot"``, ``"base"`` or ``""``."""
    return phrase.part if phrase is not None and phrase.kind is NounKind.STAIRS and phrase.part in REACHED_BY else ""


REACHED_BY = {"top": "up", "bottom": "down", "foot": "down", "base": "down"}
"""How one comes to an end of a flight from its other end."""


def _says_nothing(clause: Clause) -> bool:
    """A bare mention of something that the lexicon does not know."""
    phrase = clause.place
    if clause.type is not T.NOTICE or phrase is None:
        return clause.type is T.NOTICE
    return phrase.kind is NounKind.OBJECT and phrase.head not in KNOWN


def anchor_of(clause: Clause) -> Anchor | None:
    """The space-landmark anchor of a clause; None when it names nothing to verify."""
    phrase = clause.place
    if phrase is None or clause.type in (T.NOTICE, T.ORIENT):
        return None
    if clause.type is T.LEAVE and phrase.kind is not NounKind.OPENING:
        return Anchor(f"way out of the {phrase.head}", SpaceKind.CONNECTOR)
    if part_of_stairs(phrase):
        return Anchor(f"{phrase.part} of the stairs", SpaceKind.CONNECTOR)
    if clause.type is T.STAIRS or (phrase.kind is NounKind.STAIRS and clause.vertical):
        return Anchor(f"stairs {clause.vertical}".strip(), SpaceKind.FLOOR_TRANSITION)
    if phrase.kind is NounKind.REGION:
        space = f"end of the {phrase.head}" if phrase.part == "end" else phrase.head
        return Anchor(space, region_kind(phrase.head))
    if phrase.kind is NounKind.OPENING:
        space = f"{phrase.region} {phrase.head}".strip()
        return Anchor(space, SpaceKind.CONNECTOR)
    if phrase.kind in (NounKind.OBJECT, NounKind.STAIRS):
        space = phrase.of.head if phrase.of is not None and phrase.of.kind is NounKind.REGION else ""
        return Anchor(space, region_kind(space) if space else SpaceKind.UNKNOWN, phrase.phrase, cue_kind(phrase.phrase))
    return None


def planned_anchors(clauses: tuple[Clause, ...], followed: int) -> tuple[Anchor, ...]:
    """Anchors of the clauses that remain, without immediate repeats."""
    anchors: list[Anchor] = []
    for clause in clauses[followed:]:
        anchor = anchor_of(clause)
        if anchor is not None and (not anchors or str(anchors[-1]) != str(anchor)):
            anchors.append(anchor)
    return tuple(anchors)


def final_anchor(clauses: tuple[Clause, ...]) -> Anchor:
    """The goal: what the last clause that names something names."""
    for clause in reversed(clauses):
        anchor = anchor_of(replace(clause, vertical="") if clause.type is T.STOP else clause)
        if anchor is not None:
            if anchor.space_kind is SpaceKind.FLOOR_TRANSITION:
                return Anchor("end of the " + anchor.space, SpaceKind.CONNECTOR)
            return anchor
    return Anchor("end of the route", SpaceKind.UNKNOWN)
