"""What an episode in a house is: the task, and the truth that only evaluation may read."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Literal

from spacevln.core.errors import SpaceVLNError
from spacevln.core.task import EpisodeSpec

Split = Literal["dev", "test"]
Point = tuple[float, float, float]


class NoEpisodeError(SpaceVLNError):
    """A house yields no episode that meets the conditions within the bounded number of attempts; take another seed."""


@dataclass(frozen=True, slots=True)
class EpisodeTags:
    """What an episode is like, for tables and statistics.

    Args:
        split: whose phrases it uses.
        length_bin: ``"4-7"``, ``"7-10"``, ``"10-14"`` or ``"14-21"`` metres of geodesic distance;
            object goals also ``"0-4"`` and ``"21+"``.
        floors: number of storeys that the shortest path visits.
        height_m: height of the goal over the start.
        doors: doorways and openings on the shortest path.
        words, sentences, anchors: of the instruction (0 for object goals).
        clause_count: clauses of the instruction.
        clauses: clause templates in the order of the text, codes of :mod:`.clauses` (a clause may count as two).
        mentions: landmarks and openings named, and how many of them with an attribute.
        places: how many places its meaning allows.
        ambiguity_m: geodesic distance from the goal to the furthest of them.
        goal_visible: object goals: whether an instance is in line of sight of the start.
    """

    split: Split
    length_bin: str
    floors: int
    height_m: float
    doors: int
    words: int = 0
    sentences: int = 0
    anchors: int = 0
    clause_count: int = 0
    clauses: tuple[str, ...] = ()
    mentions: tuple[int, int] = (0, 0)
    places: int = 1
    ambiguity_m: float = 0.0
    goal_visible: bool = False


@dataclass(frozen=True, slots=True)
class HouseEpisode:
    """An episode with its truth; scene frame, metres, rounded to 1 mm.

    Args:
        spec: what an environment resets to.
        goals: positions, of which one must be reached: one for a route, one per instance (its success place
            nearest to the path's end) for an object goal.
        reference_path: 4 to 7 nodes from start to goal, about 2 m apart, as in R2R.
        shortest_path: dense polyline.
        geodesic_m: length of the shortest path to the nearest goal.
        tags: for tables.
        category: object goals: what to find.
        instance_ids: object goals: items of that category.
    """

    spec: EpisodeSpec
    goals: tuple[Point, ...]
    reference_path: tuple[Point, ...]
    shortest_path: tuple[Point, ...]
    geodesic_m: float
    tags: EpisodeTags
    category: str | None = None
    instance_ids: tuple[int, ...] = ()


def length_bin(length_m: float) -> str:
    """The bin of a geodesic distance."""
    for low, high in ((0, 4), (4, 7), (7, 10), (10, 14), (14, 21)):
        if length_m < high:
            return f"{low}-{high}"
    return "21+"


def rounded(x: float, y: float, z: float) -> Point:
    """A point in millimetres, without negative zeros."""
    return round(x, 3) + 0.0, round(y, 3) + 0.0, round(z, 3) + 0.0


def resample(path: tuple[Point, ...], nodes: int) -> tuple[Point, ...]:
    """``nodes`` points at equal arc lengths along a polyline, both ends included."""
    arc = [0.0]
    for a, b in itertools.pairwise(path):
        arc.append(arc[-1] + sum((q - p) ** 2 for p, q in zip(a, b, strict=True)) ** 0.5)
    out: list[Point] = []
    k = 0
    for i in range(nodes):
        s = arc[-1] * i / (nodes - 1)
        while k < len(arc) - 2 and arc[k + 1] < s:
            k += 1
        t = 0.0 if arc[k + 1] == arc[k] else min(max((s - arc[k]) / (arc[k + 1] - arc[k]), 0.0), 1.0)
        a, b = path[k], path[k + 1]
        out.append(rounded(*(p + t * (q - p) for p, q in zip(a, b, strict=True))))
    return tuple(out)
