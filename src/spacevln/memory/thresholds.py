"""Doorways and openings as segments on the floor: connector evidence that keeps distinct spaces apart (paper appendix)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from spacevln.core import CueKind, Sighting
from spacevln.core.geometry import Float
from spacevln.language import cue_kind

SAME_THRESHOLD_M = 0.6  # between the middles
WIDTH_M = (0.4, 3.0)  # narrower is a gap between things, wider is no door


@dataclass(frozen=True, slots=True)
class Threshold:
    """A way through a wall, from jamb ``a_m`` to jamb ``b_m`` (x, y), on one floor; seen from ``distance_m``."""

    floor: int
    a_m: tuple[float, float]
    b_m: tuple[float, float]
    distance_m: float

    @property
    def width_m(self) -> float:
        """From jamb to jamb."""
        return math.dist(self.a_m, self.b_m)

    @property
    def middle_m(self) -> tuple[float, float]:
        """Middle of the opening (x, y)."""
        return (self.a_m[0] + self.b_m[0]) / 2, (self.a_m[1] + self.b_m[1]) / 2


class Thresholds:
    """Every threshold seen so far; of two views of one opening the nearer stands."""

    def __init__(self, known: Iterable[Threshold] = ()) -> None:
        self._known = list(known)

    def __iter__(self) -> Iterator[Threshold]:
        return iter(self._known)

    def add(self, sightings: Iterable[Sighting], floor: int) -> None:
        """Take in the openings with a way through among the sightings."""
        for sighting in sightings:
            if not sighting.is_passage or len(sighting.surface_m) < 2 or cue_kind(sighting.category) is not CueKind.OPENING:
                continue
            new = Threshold(floor, sighting.surface_m[0], sighting.surface_m[-1], sighting.distance_m)
            if not WIDTH_M[0] <= new.width_m <= WIDTH_M[1]:
                continue
            for index, old in enumerate(self._known):
                apart = max(SAME_THRESHOLD_M, (old.width_m + new.width_m) / 4)
                if old.floor == floor and math.dist(old.middle_m, new.middle_m) <= apart:
                    if new.distance_m < old.distance_m:
                        self._known[index] = new
                    break
            else:
                self._known.append(new)

    def on(self, floor: int) -> tuple[Threshold, ...]:
        """Those of one floor."""
        return tuple(threshold for threshold in self._known if threshold.floor == floor)

    def between(self, floor: int, a_m: Float, b_m: Float) -> bool:
        """Whether the straight line from a to b goes through a threshold."""
        a, b = np.asarray(a_m, float), np.asarray(b_m, float)
        length = float(np.hypot(*(b - a)))
        return length > 0 and bool(crossing_m(a, ((b - a) / length)[None], self.on(floor))[0] < length)


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
