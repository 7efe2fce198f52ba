"""The words of a situation: what the last stage brought, what a view shows, what the landmark pool holds."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

from spacevln.core import (
    Anchor,
    AnchorStatus,
    ExecutedDecision,
    Feedback,
    LandmarkCandidate,
    LandmarkPool,
    Sighting,
    SpaceKind,
    StageEnd,
    StageRecord,
    Subtask,
    View,
    egocentric_label,
)
from spacevln.language.names import full_name, quoted
from spacevln.reasoning.spatial_cot.actions import words_of
from spacevln.reasoning.spatial_cot.pictures import SAME_THING_M, bearing_words, nearest_sightings, obstacle_words

STATUS = {AnchorStatus.VERIFIED: "done", AnchorStatus.CURRENT: "here", AnchorStatus.PENDING: "ahead"}

_ENDS = {
    StageEnd.ARRIVAL: "arrival: the target was reached by the evidence of landmark, floor or space.",
    StageEnd.STOP: "the executor said stop.",
    StageEnd.BLOCKED: "blocked: no move was left that the executor could make.",
    StageEnd.STAGE_BUDGET: "the moves of a stage were used up before an arrival.",
    StageEnd.EPISODE_END: "the steps of the episode were used up.",
}


def anchor_words(anchor: Anchor | None) -> str:
    """``"living room, by the white sofa"``; a floor transition ends on the other floor, not by the stairs."""
    if anchor is None:
        return "none"
    if anchor.space_kind is SpaceKind.FLOOR_TRANSITION:
        return f"{anchor.space or 'stairs'}, over the whole flight to the other floor"
    return ", by ".join(part for part in (anchor.space, f"the {anchor.cue}" if anchor.cue else "") if part)


def crosses_floors(subtask: Subtask) -> bool:
    """Whether the stage leads over stairs: then to be near them is no arrival."""
    return subtask.next_anchor is not None and subtask.next_anchor.space_kind is SpaceKind.FLOOR_TRANSITION


def landmark_words(landmark: str) -> str:
    """The phrase in double quotes, or ``"none"``."""
    return quoted(landmark) if landmark else "none"


def chain_lines(subtask: Subtask) -> list[str]:
    """The anchor chain as it stood in a reply, one JSON object a line, ready to be copied."""
    return [
        json.dumps(
            {"space": anchor.space, "kind": anchor.space_kind, "landmark": anchor.cue, "status": STATUS[subtask.status(index)]},
            ensure_ascii=False,
        )
        for index, anchor in enumerate(subtask.chain)
    ]


def end_words(feedback: Feedback) -> str:
    """Why the last stage ended."""
    return _ENDS[feedback.end]


def motion_words(record: StageRecord) -> str:
    """What the body did in a stage."""
    if not record.decisions:
        return "did not move."
    moves = "; ".join(map(move_words, record.decisions))
    return f"moved {record.moved_m:.1f} m in all, net turn {_turn_words(record.turned_rad)}. Moves: {moves}."


def move_words(decision: ExecutedDecision) -> str:
    """One decision and what came of it: ``"forward 0.75: moved 0.50 m, then blocked"``."""
    asked = words_of(decision.asked, decision.purpose)
    if decision.purpose is not None:
        return f"{asked}: turned {_turn_words(decision.turned_rad)}"
    cut = ", then blocked" if decision.stalled else ", then cut short by the end of the stage" if decision.interrupted else ""
    return f"{asked}: moved {decision.moved_m:.2f} m{cut}"


def _turn_words(turned_rad: float) -> str:
    degrees = math.degrees(turned_rad)
    return f"{abs(degrees):.0f} deg {'left' if degrees > 0 else 'right'}" if abs(degrees) >= 1 else "0 deg"


def pool_words(pool: LandmarkPool, landmark: str, *, crossing: bool) -> str:
    """The stage-end summary of the landmark pool, seen from where the robot stands now.

    Args:
        pool, landmark: B of the last stage and what it tracked.
        crossing: that stage led over these stairs, as for :func:`candidate_words`.
    """
    if not landmark:
        return "none was tracked."
    if not pool:
        return f"{quoted(landmark)} was never seen in this stage."
    return "; ".join(
        f"{quoted(full_name(candidate.category, candidate.attributes))} {candidate.distance_m:.1f} m away, "
        f"{egocentric_label(candidate.bearing_rad)}{', arrived' if candidate.arrived and not crossing else ''}"
        for candidate in pool
    )


def candidate_words(candidate: LandmarkCandidate, *, crossing: bool) -> str:
    """One entry of the landmark pool for the executor.

    Args:
        candidate: what is told.
        crossing: the stage leads over these stairs: near them nothing is reached, so their arrival flag is left out.
    """
    arrived = "" if crossing else f", {'arrived' if candidate.arrived else 'not arrived'}"
    return (
        f"{quoted(full_name(candidate.category, candidate.attributes))}: {'visible' if candidate.visible else 'remembered'}, "
        f"{candidate.distance_m:.1f} m, {bearing_words(candidate.bearing_rad)}, confidence {candidate.confidence:.2f}{arrived}"
    )


def view_words(view: View, told: Sequence[Sighting]) -> str:
    """One line about a view: ``left 30: obstacle 2.1 m; detected "sofa" 2.3 m``.

    Args:
        view: what is shown.
        told: of :func:`told_once`.
    """
    words = f"{view.label}: obstacle {obstacle_words(view.obstacle_m)}"
    if told:
        seen = ", ".join(f"{quoted(full_name(s.category, s.attributes))} {s.distance_m:.1f} m" for s in told)
        words += f"; detected {seen}"
    return words


def told_once(views: Sequence[View]) -> list[list[Sighting]]:
    """The sightings that are told of each view: each thing where it is nearest to the middle, since views overlap."""
    told: list[list[Sighting]] = [[] for _ in views]
    kept: list[Sighting] = []
    shown = [(abs(s.bearing_rad), index, s) for index, view in enumerate(views) for s in nearest_sightings(view)]
    for _, index, sighting in sorted(shown, key=lambda item: item[:2]):
        if not any(_same_thing(sighting, other) for other in kept):
            kept.append(sighting)
            told[index].append(sighting)
    return [sorted(things, key=lambda thing: (thing.distance_m, thing.category)) for things in told]


def _same_thing(one: Sighting, other: Sighting) -> bool:
    reach_m = SAME_THING_M + max(one.extent_m, other.extent_m) / 4
    named_alike = (one.category, one.attributes) == (other.category, other.attributes)
    return named_alike and math.dist(one.position_m[:2], other.position_m[:2]) <= reach_m
