"""The agent's success as a function of its detector's errors, simulated on a simulator's labels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from spacevln.assembly import Configuration, LabelDetectorSettings
from spacevln.evaluation.runs import Run
from spacevln.evaluation.statistics import Interval, interval
from spacevln.viewer.curves import Curve, Panel, Point


@dataclass(frozen=True, slots=True, order=True)
class Level:
    """Errors of the detector and what the agent does about them.

    Args:
        miss_rate, confusion_rate: see :class:`~spacevln.perception.LabelDetector`.
        arrival_sightings: pictures that must show a landmark before it counts as reached.
    """

    miss_rate: float = 0.0
    confusion_rate: float = 0.0
    arrival_sightings: int = 1

    @property
    def folder(self) -> str:
        """Name of its run directory."""
        errors = [f"{name}-{rate:g}" for name, rate in (("misses", self.miss_rate), ("confusions", self.confusion_rate)) if rate]
        verified = [f"sightings-{self.arrival_sightings}"] if self.arrival_sightings > 1 else []
        return "-".join([*(errors or ["none"]), *verified])

    def configured(self, base: Configuration) -> Configuration:
        """A run's configuration with this detector."""
        detector = LabelDetectorSettings(miss_rate=self.miss_rate, confusion_rate=self.confusion_rate)
        return base.model_copy(update={"detector": detector, "arrival_sightings": self.arrival_sightings})


def levels_of(misses: Sequence[float], confusions: Sequence[float], sightings: Sequence[int]) -> tuple[Level, ...]:
    """Either error alone, and none, each with every number of sightings."""
    rates = {(0.0, 0.0), *((rate, 0.0) for rate in misses), *((0.0, rate) for rate in confusions)}
    return tuple(sorted(Level(miss, confusion, n) for miss, confusion in rates for n in sightings))


def successes(runs: Mapping[Level, Run]) -> dict[Level, Interval]:
    """Success rate in percent with its interval, by level."""
    return {level: interval(list(run.values("SR").values())) for level, run in runs.items()}


def success_panels(found: Mapping[Level, Interval]) -> tuple[Panel, Panel]:
    """Success over misses and over confusions, one curve for each number of sightings."""
    sightings = sorted({level.arrival_sightings for level in found})

    def curve(n: int, misses: bool) -> Curve:
        points = []
        for level in sorted(found):
            rate, other = level.miss_rate, level.confusion_rate
            rate, other = (rate, other) if misses else (other, rate)
            if level.arrival_sightings == n and not other:
                points.append(Point(100 * rate, found[level].mean, found[level].low, found[level].high))
        return Curve("one picture" if n == 1 else f"{n} pictures", tuple(points))

    count = max((each.count for each in found.values()), default=0)
    titles = (("Things overlooked", "per image [%]", True), ("Things taken for others", "per image [%]", False))
    first, second = (
        Panel(f"{title} (n = {count})", x, "success [%]", tuple(curve(n, misses) for n in sightings), 100.0)
        for title, x, misses in titles
    )
    return first, second
