"""A detector that reads simulator labels: what an ideal open-vocabulary detector would find, made worse on request."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from spacevln.core import Detection, InstanceLabel, Observation, UsageError
from spacevln.perception.attributes import Agreement
from spacevln.perception.matching import best_fit

MIN_PIXELS = 40  # at 640x480; scaled with the image's area [ours]
FULL_PIXELS = 4000  # at 640x480; from this size on confidence is highest [ours]
CONFIDENCE_RANGE = (0.55, 0.95)  # of the smallest and of a large mask

_CONFUSABLE: tuple[tuple[str, ...], ...] = (
    ("sofa", "armchair", "bench", "bed"),
    ("chair", "armchair", "stool", "dining chair", "office chair", "bar stool"),
    ("dining table", "desk", "coffee table", "side table", "counter", "kitchen island", "console table"),
    ("cabinet", "wardrobe", "dresser", "bookshelf", "shelf", "sideboard", "nightstand"),
    ("toilet", "sink", "bathtub", "bidet", "vanity"),
    ("television", "monitor", "painting", "mirror", "whiteboard", "window"),
    ("doorway", "opening", "door", "window"),
    ("plant", "lamp", "floor lamp", "vase", "flowers"),
    ("refrigerator", "washing machine", "dryer", "oven", "dishwasher", "stove"),
    ("rug", "doormat", "runner", "bath mat"),
    ("treadmill", "exercise bike", "rowing machine", "weight bench"),
)


@dataclass(frozen=True, slots=True)
class LabelDetector:
    """Implements :class:`spacevln.core.Detector` from ``Observation.labels`` alone.

    An instance is found when at least ``MIN_PIXELS`` (scaled with the image) of its pixels are visible and have depth, so
    only within the range of the depth sensor. It fits a query through ``language.norm``; the detection's category is the
    simulator's own word, its confidence grows with the size of the mask and is capped by how far the attributes agree
    (:class:`~spacevln.perception.attributes.Agreement`), e.g. 0.35 for a black sofa where only "white sofa" is asked.

    Args:
        miss_rate: chance that an instance is overlooked in an image.
        confusion_rate: chance that it is taken for a similar category.
        jitter_px: largest shift of each box edge at 640 px image width; the mask moves along.
        seed: of those three. The outcome depends on the seed, the image and the instance alone, neither on the queries nor
            on what was detected before.
    """

    miss_rate: float = 0.0
    confusion_rate: float = 0.0
    jitter_px: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name, rate in (("miss_rate", self.miss_rate), ("confusion_rate", self.confusion_rate)):
            if not 0 <= rate <= 1:
                raise UsageError(f"LabelDetector {name}={rate} is not a probability: give a value from 0 to 1.")
        if self.jitter_px < 0:
            raise UsageError(f"LabelDetector jitter_px={self.jitter_px} is negative: give pixels, 0 for none.")

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        """See :meth:`spacevln.core.Detector.detect`.

        Raises:
            UsageError: an observation carries no labels.
        """
        return [self._detect_one(observation, tuple(queries)) for observation in observations]

    def _detect_one(self, observation: Observation, queries: tuple[str, ...]) -> tuple[Detection, ...]:
        if observation.labels is None:
            raise UsageError(
                "The observation has no labels: LabelDetector works in a simulator that gives them; choose another detector here."
            )
        labels = observation.labels
        image = self._image_key(labels.instance_ids) if self._noisy else 0
        seen_as: dict[int, tuple[InstanceLabel, Agreement, np.random.Generator]] = {}
        for instance in sorted(labels.instances):
            rng = np.random.default_rng([self.seed, image, instance])
            label = self._perceived(labels.instances[instance], rng)
            best = best_fit(queries, label.category, label.attributes) if label else None
            if label and best:
                seen_as[instance] = (label, best, rng)
        found = []
        for instance, box, mask in _masks(labels.instance_ids, observation.depth_m, tuple(seen_as)):
            label, agreed, rng = seen_as[instance]
            confidence = round(min(_size_confidence(int(mask.sum()), mask_area=labels.instance_ids.size), agreed.value), 2)
            box, mask = self._jittered(box, mask, labels.instance_ids.shape, rng)
            found.append(Detection(label.category, box, confidence, mask, label.attributes))
        found.sort(key=lambda detection: (-detection.confidence, detection.box_px, detection.category))
        return tuple(found)

    @property
    def _noisy(self) -> bool:
        return bool(self.miss_rate or self.confusion_rate or self.jitter_px)

    @staticmethod
    def _image_key(instance_ids: NDArray[np.int32]) -> int:
        return zlib.crc32(np.ascontiguousarray(instance_ids[::4, ::4]).tobytes())

    def _perceived(self, label: InstanceLabel, rng: np.random.Generator) -> InstanceLabel | None:
        """What this image makes of an instance: itself, a similar category, or nothing."""
        if not self._noisy:
            return label
        missed, confused, choice = rng.random(3)
        if missed < self.miss_rate:
            return None
        if confused < self.confusion_rate:
            others = sorted({other for group in _CONFUSABLE if label.category in group for other in group} - {label.category})
            if others:
                return InstanceLabel(others[int(choice * len(others))], label.attributes)
        return label

    def _jittered(
        self, box: tuple[int, int, int, int], mask: NDArray[np.bool_], shape: tuple[int, ...], rng: np.random.Generator
    ) -> tuple[tuple[int, int, int, int], NDArray[np.bool_]]:
        if not self.jitter_px:
            return box, mask
        height, width = shape[:2]
        reach = self.jitter_px * width / 640
        dx, dy = (round(shift) for shift in rng.uniform(-reach, reach, 2))
        x0, y0, x1, y1 = box[0] + dx, box[1] + dy, box[2] + dx, box[3] + dy
        cx0, cy0, cx1, cy1 = max(x0, 0), max(y0, 0), min(x1, width), min(y1, height)
        if cx1 - cx0 < 2 or cy1 - cy0 < 2:
            return box, mask
        return (cx0, cy0, cx1, cy1), mask[cy0 - y0 : cy1 - y0, cx0 - x0 : cx1 - x0]


def _size_confidence(pixels: int, mask_area: int) -> float:
    scale = mask_area / (640 * 480)
    low, high = CONFIDENCE_RANGE
    grown = (pixels - MIN_PIXELS * scale) / ((FULL_PIXELS - MIN_PIXELS) * scale)
    return low + (high - low) * float(np.sqrt(min(max(grown, 0.0), 1.0)))


def _masks(
    instance_ids: NDArray[np.int32], depth_m: NDArray[np.float32], wanted: tuple[int, ...]
) -> list[tuple[int, tuple[int, int, int, int], NDArray[np.bool_]]]:
    """Box and mask of every wanted instance that is visible enough, in the order of ``wanted``."""
    if not wanted:
        return []
    table = np.zeros(max(int(instance_ids.max()), max(wanted)) + 1, np.int32)
    table[list(wanted)] = np.arange(1, len(wanted) + 1)
    compact = table[np.maximum(instance_ids, 0)]
    compact[~(depth_m > 0)] = 0  # no measurement, NaN included
    least = max(4, MIN_PIXELS * instance_ids.size / (640 * 480))
    found = []
    for index, window in enumerate(ndimage.find_objects(compact, len(wanted))):
        if window is None:
            continue
        mask = compact[window] == index + 1
        if mask.sum() < least:
            continue
        rows, columns = window
        found.append((wanted[index], (columns.start, rows.start, columns.stop, rows.stop), mask))
    return found
