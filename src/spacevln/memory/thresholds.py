"""Doorways and openings as segments on the floor: connector evidence that keeps distinct spaces apart (paper appendix)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from spacevln.core import CueKind, Sighting
from spacevln.core.geometry import Float
from spacevln.language import cue_kind

SAME_THRESHOLD_M = 0.6  # between the middles
WIDTH_M = (0.4, 3.0)  # narrower is a gap between things, wider is no door
MIN_VIEWS = 2  # one view may take a cupboard or the far end of a hallway for a jamb [ours]
SHARED_JAMB_M = 0.2  # two openings do not share a jamb: the narrower is the opening [ours]


@dataclass(frozen=True, slots=True)
class Threshold:
    """A way through a wall, on one floor.

    Args:
        floor: storey.
        a_m, b_m: the jambs (x, y).
        distance_m: from which it was seen best.
        views: number of images that showed it.
    """

    floor: int
    a_m: tuple[float, float]
    b_m: tuple[float, float]
    distance_m: float
    views: int = 1

    @property
    def width_m(self) -> float:
        """From jamb to jamb."""
        return math.dist(self.a_m, self.b_m)

    @property
    def middle_m(self) -> tuple[float, float]:
        """Middle of the opening (x, y)."""
        return (self.a_m[0] + self.b_m[0]) / 2, (self.a_m[1] + self.b_m[1]) / 2


class Thresholds:
    """Every threshold seen so far; of several views of one opening the nearest stands. Two views make it believed."""

    def __init__(self, known: Iterable[Threshold] = ()) -> None:
        self._known = list(known)
        self._believed = self._believe()

    def __iter__(self) -> Iterator[Threshold]:
        return iter(self._known)

    def add(self, sightings: Iterable[Sighting], floor: int) -> None:
        """Take in the openings with a way through among the sightings; their order does not matter."""
        for sighting in sorted(sightings, key=lambda s: (s.distance_m, s.surface_m)):
            if not sighting.is_passage or len(sighting.surface_m) < 2 or cue_kind(sighting.category) is not CueKind.OPENING:
                continue
            new = Threshold(floor, sighting.surface_m[0], sighting.surface_m[-1], sighting.distance_m)
            if WIDTH_M[0] <= new.width_m <= WIDTH_M[1]:
                self._add(new)
        self._believed = self._believe()

    def _add(self, new: Threshold) -> None:
        for index, old in enumerate(self._known):
            apart = max(SAME_THRESHOLD_M, (old.width_m + new.width_m) / 4)
            if old.floor == new.floor and math.dist(old.middle_m, new.middle_m) <= apart:
                self._known[index] = replace(min(old, new, key=lambda one: one.distance_m), views=old.views + 1)
                return
        self._known.append(new)

    def _believe(self) -> tuple[int, ...]:
        """Indices of what was seen often enough and shares no jamb with a narrower one, ascending."""
        often = [index for index, threshold in enumerate(self._known) if threshold.views >= MIN_VIEWS]
        kept: list[int] = []
        for index in sorted(often, key=lambda index: (self._known[index].width_m, index)):
            if not any(_share_a_jamb(self._known[index], self._known[other]) for other in kept):
                kept.append(index)
        return tuple(sorted(kept))

    def believed(self, floor: int) -> tuple[int, ...]:
        """Numbers of those on one floor that are believed; a number stays with its threshold."""
        return tuple(index for index in self._believed if self._known[index].floor == floor)

    def on(self, floor: int) -> tuple[Threshold, ...]:
        """Those of one floor that are believed."""
        return tuple(self._known[index] for index in self.believed(floor))

    def between(self, floor: int, a_m: Float, b_m: Float) -> bool:
        """Whether the straight line from a to b goes through a threshold."""
        a, b = np.asarray(a_m, float), np.asarray(b_m, float)
        length = float(np.hypot(*(b - a)))
        return length > 0 and bool(crossing_m(a, ((b - a) / length)[None], self.on(floor))[0] < length)


def _share_a_jamb(one: Threshold, two: Threshold) -> bool:
    ends = ((a, b) for a in (one.a_m, one.b_m) for b in (two.a_m, two.b_m))
    return one.floor == two.floor and any(math.dist(a, b) < SHARED_JAMB_M for a, b in ends)


def crossing_m(origin_m: Float, directions: Float, thresholds: Iterable[Threshold]) -> Float:
    """Distance at which rays first cross a threshold.

    Args:
        origin_m: (2,).
        directions: (N, 2) unit vectors.
        thresholds: segments.

    Returns:
        (N,) [m]; inf for rays that cross none.
    """
    nearest = np.full(len(directions), np.inf)
    for threshold in thresholds:
        a, b = np.array(threshold.a_m), np.array(threshold.b_m)
        along, to_a = b - a, a - origin_m
        cross = directions[:, 0] * along[1] - directions[:, 1] * along[0]
        safe = np.where(np.abs(cross) < 1e-12, np.nan, cross)
        t = (to_a[0] * along[1] - to_a[1] * along[0]) / safe
        s = (to_a[0] * directions[:, 1] - to_a[1] * directions[:, 0]) / safe
        hit = (t > 0) & (s >= -0.05) & (s <= 1.05)
        nearest = np.where(hit, np.fmin(nearest, t), nearest)
    return nearest
