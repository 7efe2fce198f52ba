"""Clauses in order along a trail: a monotone alignment, and what each further leg makes of it.

The vector of a trail holds, for every number of clauses, the best score of having followed that many of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from spacevln.language import Clause, ClauseType
from spacevln.reasoning.rules.legs import Leg
from spacevln.reasoning.rules.matching import WEIGHT, Matcher

T = ClauseType
SKIP = 0.8  # of a clause's weight, lost when it is not followed
BARE_STOP = 0.65  # of a stop's weight, where it names nothing
UNMENTIONED_CROSSING = 0.45
UNMENTIONED_TURN = 0.25
BIG_TURN_RAD = math.radians(60)
SLACK_M = 1.0
LEG_COST_PER_M = 0.01
NO = -math.inf

Vector = tuple[float, ...]


def advance(
    vector: Vector, clauses: Sequence[Clause], leg: Leg, matcher: Matcher, first: bool, stop_score: float | None
) -> Vector:
    """The vector after a leg.

    Args:
        stop_score: of a final STOP fulfilled by the end of the leg; None on legs that go on.
    """
    count = len(clauses)
    states: list[list[tuple[float, float, int, int]]] = [[] for _ in range(count + 1)]
    for j, score in enumerate(vector):
        if score > NO:
            states[j].append((score, 0.0, 0, 0))
    for j in range(count):
        kept = sorted(states[j], key=lambda state: (-state[0], state[1]))[:4]
        states[j] = kept
        if not kept:
            continue
        clause = clauses[j]
        weight = WEIGHT[clause.type]
        if clause.type is T.STOP:
            if stop_score is not None:
                states[j + 1].extend((score + stop_score, leg.length_m, mask, turns) for score, _, mask, turns in kept)
            continue
        states[j + 1].extend((score - SKIP * weight, s, mask, turns) for score, s, mask, turns in kept)
        for option in matcher.options(clause, leg):
            for score, s, mask, turns in kept:
                used_up = mask & (option.crossing | option.bars) or (option.turn >= 0 and turns >> option.turn & 1)
                if option.s_m < s - SLACK_M or used_up:
                    continue
                used = turns | (1 << option.turn) if option.turn >= 0 else turns
                states[j + 1].append((score + option.score, max(s, option.s_m), mask | option.crossing, used))
    crossing = leg.kind in ("cross", "stairs")
    big = [i for i, (s, angle) in enumerate(leg.turns) if abs(angle) > BIG_TURN_RAD and not (first and s < 1e-6)]
    cost = LEG_COST_PER_M * leg.length_m
    out = []
    for j, options in enumerate(states):
        best = NO
        implied = crossing and j < count and matcher.goes_on_beyond(clauses[j], leg)
        for score, _, mask, turns in options:
            lost = UNMENTIONED_CROSSING if crossing and not mask and not implied else 0.0
            lost += UNMENTIONED_TURN * sum(1 for i in big if not turns >> i & 1)
            best = max(best, score - lost - cost)
        out.append(best)
    return tuple(out)


def worth(clause: Clause) -> float:
    """The best score that a clause can have."""
    return WEIGHT[clause.type] * (BARE_STOP if clause.type is T.STOP and clause.place is None else 1.0)
