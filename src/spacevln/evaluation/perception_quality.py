"""How good a detector is, against a simulator's labels: what it finds, where that is, and whether one would stop there.

The truth of an image is what :class:`~spacevln.perception.LabelDetector` finds without errors, the truth of a place is what
lifting makes of that instance's own pixels, and the truth of an arrival is what Local Landmark Memory decides on these. So the
numbers tell of the detector alone, and the same code judges any.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from spacevln.core import Detection, Detector, Environment, Observation, Sighting
from spacevln.evaluation.perception_walks import Walk
from spacevln.mapping import MetricMap
from spacevln.memory import LocalLandmarkMemory
from spacevln.perception import LabelDetector, lift, names
from spacevln.perception.label_detector import MIN_PIXELS

LEAST_IOU = 0.5
"""Overlap of two boxes that are one thing."""

SMALL_SHARE = 0.5
"""Of a detection's box that things too small to count, and rightly named, may cover without its being a false alarm."""

EDGES_M = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0)
"""Of the bins over distance."""

BATCH = 12
"""Images per call of the detector, a look-around."""


@dataclass(slots=True)
class Tally:
    """Detections and instances of some distance.

    Args:
        instances, found: that there are, and of which a detection tells.
        detections, right: that were made, and that tell of an instance.
        errors_m: horizontal distance of the place lifted from the detection to that lifted from the instance's own pixels.
        mask_ious: overlap of the masks of detection and instance.
    """

    instances: int = 0
    found: int = 0
    detections: int = 0
    right: int = 0
    errors_m: list[float] = field(default_factory=list)
    mask_ious: list[float] = field(default_factory=list)

    @property
    def precision(self) -> float:
        """Share of detections that are right; nan for none."""
        return self.right / self.detections if self.detections else math.nan

    @property
    def recall(self) -> float:
        """Share of instances that are found; nan for none."""
        return self.found / self.instances if self.instances else math.nan


@dataclass(slots=True)
class Arrivals:
    """Whether a landmark counts as reached, decided at every image for every phrase that is ever seen on the way."""

    both: int = 0
    false: int = 0
    missed: int = 0
    neither: int = 0

    def add(self, decided: bool, truly: bool) -> None:
        """Count a decision."""
        self.both += decided and truly
        self.false += decided and not truly
        self.missed += truly and not decided
        self.neither += not (decided or truly)

    @property
    def precision(self) -> float:
        """Share of arrivals that are none but by error; nan for none."""
        return self.both / (self.both + self.false) if self.both + self.false else math.nan

    @property
    def recall(self) -> float:
        """Share of true arrivals that are noticed; nan for none."""
        return self.both / (self.both + self.missed) if self.both + self.missed else math.nan

    @property
    def accuracy(self) -> float:
        """Share of right decisions; nan for none."""
        count = self.both + self.false + self.missed + self.neither
        return (self.both + self.neither) / count if count else math.nan


@dataclass(slots=True)
class WalkQuality:
    """Of one walk.

    Args:
        episode_id: of the walk.
        images: that it has.
        whole: all distances together, things without depth included.
        by_distance: bins of :data:`EDGES_M`; instances by their own distance, detections by theirs.
        arrivals: by how many different pictures must show a landmark.
    """

    episode_id: str
    images: int
    whole: Tally
    by_distance: tuple[Tally, ...]
    arrivals: dict[int, Arrivals]


def judge_walk(
    walk: Walk, environment: Environment, detector: Detector, arrival_sightings: Sequence[int] = (1, 2, 3)
) -> WalkQuality:
    """Show a detector the images of a walk, and count.

    Args:
        walk: through an embedded house.
        environment: that shows it.
        detector: to be judged; asked the walk's vocabulary in every image.
        arrival_sightings: of temporal verification, each judged beside the others.
    """
    quality = WalkQuality(
        walk.episode.episode_id, 0, Tally(), tuple(Tally() for _ in EDGES_M[1:]), {n: Arrivals() for n in arrival_sightings}
    )
    stops = _Stops(walk.vocabulary, arrival_sightings)
    for observation, truth, found in _seen(walk, environment, detector):
        quality.images += 1
        pairs = matched(truth, found)
        wrong = set(range(len(found))) - {f for _, f in pairs}
        ignored = {f for f in wrong if _shows_small_things(found[f], observation)}
        true_places = [_lifted(observation, detection) for detection in truth]
        places = [_lifted(observation, detection) for detection in found]
        kept = [f for f in range(len(found)) if f not in ignored]
        for t, place in enumerate(true_places):
            for tally in _tallies(quality, place):
                tally.instances += 1
                tally.found += any(t == pair[0] for pair in pairs)
        for f in kept:
            for tally in _tallies(quality, places[f]):
                tally.detections += 1
                tally.right += f not in wrong
        for t, f in pairs:
            _compare(quality, truth[t], found[f], true_places[t], places[f])
        stops.look(observation, _present(true_places), _present(places))
        stops.count(quality.arrivals)
    return quality


def _seen(
    walk: Walk, environment: Environment, detector: Detector
) -> Iterator[tuple[Observation, tuple[Detection, ...], tuple[Detection, ...]]]:
    """Every image with what there is and what was found."""
    way = walk.images(environment)
    while images := list(islice(way, BATCH)):
        truths = LabelDetector().detect(images, walk.vocabulary)
        yield from zip(images, truths, detector.detect(images, walk.vocabulary), strict=True)


def matched(truth: Sequence[Detection], found: Sequence[Detection]) -> list[tuple[int, int]]:
    """Pairs of an instance and the detection that tells of it, each used once; the most confident detections choose first."""
    pairs: list[tuple[int, int]] = []
    free = set(range(len(truth)))
    for f in sorted(range(len(found)), key=lambda f: (-found[f].confidence, f)):
        overlaps = {t: box_iou(truth[t].box_px, found[f].box_px) for t in sorted(free) if _same_kind(truth[t], found[f])}
        best = max(overlaps, key=lambda t: overlaps[t], default=None)
        if best is not None and overlaps[best] >= LEAST_IOU:
            free.discard(best)
            pairs.append((best, f))
    return pairs


def _same_kind(truth: Detection, found: Detection) -> bool:
    """A detector may say less than the label (table of a dining table), or the same in other words."""
    return names(found.category, truth.category)


def box_iou(a: tuple[int, int, int, int], b: tuple[int, int, int, int]) -> float:
    """Overlap of two boxes over their union."""
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    both = max(width, 0) * max(height, 0)
    union = (a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - both
    return both / union if union else 0.0


def mask_iou(a: Detection, b: Detection) -> float | None:
    """Overlap of two masks over their union; None where one has none."""
    if a.mask is None or b.mask is None:
        return None
    x0, y0 = min(a.box_px[0], b.box_px[0]), min(a.box_px[1], b.box_px[1])
    size = (max(a.box_px[3], b.box_px[3]) - y0, max(a.box_px[2], b.box_px[2]) - x0)
    laid = np.zeros((2, *size), np.bool_)
    for canvas, each in zip(laid, (a, b), strict=True):
        left, top, right, bottom = each.box_px
        canvas[top - y0 : bottom - y0, left - x0 : right - x0] = each.mask
    union = int((laid[0] | laid[1]).sum())
    return int((laid[0] & laid[1]).sum()) / union if union else 0.0


def _shows_small_things(detection: Detection, observation: Observation) -> bool:
    """Whether a detection rightly names what is too small in the image to count as there."""
    labels = observation.labels
    if labels is None:
        return False
    x0, y0, x1, y1 = detection.box_px
    window = labels.instance_ids[y0:y1, x0:x1]
    seen = np.bincount(labels.instance_ids[observation.depth_m > 0], minlength=1)
    least = MIN_PIXELS * labels.instance_ids.size / (640 * 480)
    small = [
        instance
        for instance, label in labels.instances.items()
        if names(detection.category, label.category) and (instance >= len(seen) or seen[instance] < least)
    ]
    pixels = np.isin(window, small)
    if detection.mask is not None:
        return bool(detection.mask.any()) and float(pixels[detection.mask].mean()) >= SMALL_SHARE
    return window.size > 0 and float(pixels.mean()) >= SMALL_SHARE


def _lifted(observation: Observation, detection: Detection) -> Sighting | None:
    return next(iter(lift(observation, [detection])), None)


def _present(places: Iterable[Sighting | None]) -> list[Sighting]:
    return [place for place in places if place is not None]


def _tallies(quality: WalkQuality, place: Sighting | None) -> Iterator[Tally]:
    yield quality.whole
    if place is None:
        return
    for tally, low, high in zip(quality.by_distance, EDGES_M, EDGES_M[1:], strict=False):
        if low <= place.distance_m < high:
            yield tally


def _compare(
    quality: WalkQuality, truth: Detection, found: Detection, true_place: Sighting | None, place: Sighting | None
) -> None:
    overlap = mask_iou(truth, found)
    for tally in _tallies(quality, true_place):
        if true_place is not None and place is not None:
            tally.errors_m.append(math.dist(true_place.position_m[:2], place.position_m[:2]))
        if overlap is not None:
            tally.mask_ious.append(overlap)


class _Stops:
    """Local Landmark Memories of every phrase, on the labels and on a detector's findings."""

    def __init__(self, phrases: Sequence[str], arrival_sightings: Sequence[int]) -> None:
        self._phrases, self._arrival_sightings = phrases, tuple(arrival_sightings)
        self._map = MetricMap()
        self._memories: dict[str, tuple[LocalLandmarkMemory, dict[int, LocalLandmarkMemory]]] = {}

    def look(self, observation: Observation, true_places: Sequence[Sighting], places: Sequence[Sighting]) -> None:
        """Take in one image."""
        self._map.integrate(observation)
        pose = observation.pose
        for phrase in self._phrases:
            is_seen = any(names(phrase, sighting.category) for sighting in (*true_places, *places))
            if phrase not in self._memories:
                if not is_seen:
                    continue
                tracked = {n: LocalLandmarkMemory(phrase, pose, arrival_sightings=n) for n in self._arrival_sightings}
                self._memories[phrase] = (LocalLandmarkMemory(phrase, pose), tracked)
            true_memory, memories = self._memories[phrase]
            true_memory.update(true_places, pose, self._map)
            for memory in memories.values():
                memory.update(places, pose, self._map)

    def count(self, arrivals: dict[int, Arrivals]) -> None:
        """Compare what both say at this image."""
        for true_memory, memories in self._memories.values():
            for n, memory in memories.items():
                arrivals[n].add(memory.arrived, true_memory.arrived)
