"""What judging a detector gave, over many walks: numbers with intervals over houses, and their curves over distance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from pydantic import BaseModel, ConfigDict

from spacevln.evaluation.perception_quality import EDGES_M, Arrivals, Tally, WalkQuality
from spacevln.evaluation.statistics import interval
from spacevln.viewer.curves import Curve, Panel, Point

LEAST_COUNT = 20
"""Things that a bin needs to be drawn."""


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Share(_File):
    """A share with its 95 % bootstrap interval over walks; None where nothing was counted, or one walk alone counted."""

    value: float | None
    low: float | None
    high: float | None


class Distances(_File):
    """What was found at some distance. ``error_m`` is the median, ``error90_m`` the 90th percentile."""

    from_m: float
    to_m: float | None
    instances: int
    detections: int
    precision: float | None
    recall: float | None
    error_m: float | None
    error90_m: float | None
    mask_iou: float | None


class ArrivalDecisions(_File):
    """Decisions at every image for every phrase that was seen, with so many pictures needed for an arrival."""

    arrival_sightings: int
    decisions: int
    true_arrivals: int
    false_arrivals: int
    accuracy: Share
    precision: Share
    recall: Share


class PerceptionReport(_File):
    """``perception.json``."""

    detector: dict[str, str | float | int | bool]
    walks: tuple[str, ...]
    images: int
    precision: Share
    recall: Share
    whole: Distances
    by_distance: tuple[Distances, ...]
    arrivals: tuple[ArrivalDecisions, ...]


def report_of(walks: Sequence[WalkQuality], detector: dict[str, str | float | int | bool]) -> PerceptionReport:
    """Everything of some walks.

    Args:
        walks: at least one.
        detector: its settings, as the report tells them.
    """
    bins = zip(EDGES_M, EDGES_M[1:], *(walk.by_distance for walk in walks), strict=False)
    return PerceptionReport(
        detector=detector,
        walks=tuple(walk.episode_id for walk in walks),
        images=sum(walk.images for walk in walks),
        precision=_share(walks, lambda walk: walk.whole.precision, _sum(walk.whole for walk in walks).precision),
        recall=_share(walks, lambda walk: walk.whole.recall, _sum(walk.whole for walk in walks).recall),
        whole=_distances(0.0, None, _sum(walk.whole for walk in walks)),
        by_distance=tuple(_distances(low, high, _sum(tallies)) for low, high, *tallies in bins),
        arrivals=tuple(_decisions(walks, n) for n in walks[0].arrivals),
    )


def panels(report: PerceptionReport) -> tuple[Panel, ...]:
    """Precision and recall, position error, and arrival decisions."""
    drawn = [each for each in report.by_distance if each.to_m is not None and each.instances >= LEAST_COUNT]
    arrivals = report.arrivals

    def over_distance(name: str, read: Callable[[Distances], float | None], scale: float) -> Curve:
        points = [((each.from_m + (each.to_m or 0.0)) / 2, read(each)) for each in drawn]
        return Curve(name, tuple(Point(x, scale * y) for x, y in points if y is not None))

    def over_sightings(name: str, read: Callable[[ArrivalDecisions], Share]) -> Curve:
        return Curve(
            name, tuple(_percent(each.arrival_sightings, read(each)) for each in arrivals if read(each).value is not None)
        )

    errors = (over_distance("median", lambda each: each.error_m, 1.0), over_distance("90 %", lambda each: each.error90_m, 1.0))
    worst = max((point.y for curve in errors for point in curve.points), default=0.0)
    return (
        Panel(
            "What is found",
            "distance of the thing [m]",
            "share [%]",
            (
                over_distance("precision", lambda each: each.precision, 100.0),
                over_distance("recall", lambda each: each.recall, 100.0),
            ),
            100.0,
        ),
        Panel("Where it is", "distance of the thing [m]", "error of the place [m]", errors, _round_up(worst)),
        Panel(
            "Whether one has arrived",
            "pictures needed for an arrival",
            "share [%]",
            (over_sightings("precision", lambda each: each.precision), over_sightings("recall", lambda each: each.recall)),
            100.0,
        ),
    )


def _percent(x: float, share: Share) -> Point:
    low, high = (None if each is None else 100.0 * each for each in (share.low, share.high))
    return Point(x, 100.0 * (share.value or 0.0), low, high)


def _round_up(value: float) -> float:
    return next(limit for limit in (0.1, 0.2, 0.4, 1.0, 2.0, 4.0, 10.0, math.inf) if value <= limit)


def _sum(tallies: Iterable[Tally]) -> Tally:
    total = Tally()
    for tally in tallies:
        total.instances += tally.instances
        total.found += tally.found
        total.detections += tally.detections
        total.right += tally.right
        total.errors_m += tally.errors_m
        total.mask_ious += tally.mask_ious
    return total


def _distances(low_m: float, high_m: float | None, tally: Tally) -> Distances:
    return Distances(
        from_m=low_m,
        to_m=high_m,
        instances=tally.instances,
        detections=tally.detections,
        precision=_known(tally.precision),
        recall=_known(tally.recall),
        error_m=float(np.median(tally.errors_m)) if tally.errors_m else None,
        error90_m=float(np.percentile(tally.errors_m, 90)) if tally.errors_m else None,
        mask_iou=float(np.mean(tally.mask_ious)) if tally.mask_ious else None,
    )


def _decisions(walks: Sequence[WalkQuality], n: int) -> ArrivalDecisions:
    total = Arrivals()
    for walk in walks:
        each = walk.arrivals[n]
        total.both, total.false = total.both + each.both, total.false + each.false
        total.missed, total.neither = total.missed + each.missed, total.neither + each.neither
    return ArrivalDecisions(
        arrival_sightings=n,
        decisions=total.both + total.false + total.missed + total.neither,
        true_arrivals=total.both + total.missed,
        false_arrivals=total.false,
        accuracy=_share(walks, lambda walk: walk.arrivals[n].accuracy, total.accuracy),
        precision=_share(walks, lambda walk: walk.arrivals[n].precision, total.precision),
        recall=_share(walks, lambda walk: walk.arrivals[n].recall, total.recall),
    )


def _share(walks: Sequence[WalkQuality], read: Callable[[WalkQuality], float], value: float) -> Share:
    """The share over everything counted, with the spread of the walks' own shares around their mean laid around it."""
    found = interval([each for walk in walks if not math.isnan(each := read(walk))])
    if math.isnan(value) or found.low is None or found.high is None:
        return Share(value=_known(value), low=None, high=None)
    low, high = value + found.low - found.mean, value + found.high - found.mean
    return Share(value=value, low=max(low, 0.0), high=min(high, 1.0))


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
