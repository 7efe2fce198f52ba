"""An open-vocabulary detector: a grounding model finds boxes of phrases, a segmenter cuts each thing out of its box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Detection, Observation
from spacevln.perception.open_vocabulary.boxes import BoxRules, GroundedBox, ScoredBoxes, select
from spacevln.perception.open_vocabulary.queries import Query, prefer_specific, queries_of

Image = NDArray[np.uint8]
"""(H, W, 3) RGB."""

Box = tuple[int, int, int, int]


class Grounder(Protocol):
    """Scores boxes for phrases."""

    def ground(self, images: Sequence[Image], queries: Sequence[Query], text_threshold: float) -> list[ScoredBoxes]:
        """Boxes of one batch, with a score for every query."""


class Segmenter(Protocol):
    """Cuts things out of their boxes."""

    def segment(self, image: Image, boxes_px: Sequence[Box]) -> list[NDArray[np.bool_]]:
        """One mask per box, of the box's size, the best of what the model offers; all False where it finds nothing."""


class ImageDetector(Protocol):
    """Detects in pictures alone: what a server shares between many agents."""

    def detect_images(self, images: Sequence[Image], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        """As :meth:`spacevln.core.Detector.detect`, of pictures."""


@dataclass(slots=True)
class DetectionCounts:
    """What a detector did so far."""

    images: int = 0
    boxes: int = 0
    empty_masks: int = 0


class OpenVocabularyDetector:
    """Implements :class:`spacevln.core.Detector` and :class:`ImageDetector`.

    The category of a detection is one of the phrases, the very one whose words the model grounded, with its attributes in it
    ("white sofa"). A box in which the segmenter finds nothing is dropped and counted.

    Args:
        grounder: finds boxes.
        segmenter: cuts masks; None = boxes only, which lifting reads in their middle.
        rules: which boxes count.
        batch_size: images per forward pass.
    """

    def __init__(
        self, grounder: Grounder, segmenter: Segmenter | None = None, rules: BoxRules | None = None, batch_size: int = 12
    ) -> None:
        self._grounder, self._segmenter = grounder, segmenter
        self._rules = rules or BoxRules()
        self._batch_size = batch_size
        self.counts = DetectionCounts()

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        """See :meth:`spacevln.core.Detector.detect`."""
        return self.detect_images([observation.rgb for observation in observations], queries)

    def detect_images(self, images: Sequence[Image], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        """Detections of any of the phrases, one tuple per image, in order; most confident first."""
        queries = queries_of(phrases)
        if not queries:
            return [()] * len(images)
        found: list[tuple[Detection, ...]] = [()] * len(images)
        for indices in self._batches(images):
            scored = self._grounder.ground([images[index] for index in indices], queries, self._rules.text_threshold)
            for index, boxes in zip(indices, scored, strict=True):
                found[index] = self._cut_out(images[index], queries, boxes)
        return found

    def _batches(self, images: Sequence[Image]) -> list[list[int]]:
        """Indices of images that go through the model together: of one size, as padding would change what is found."""
        by_size: dict[tuple[int, ...], list[int]] = {}
        for index, image in enumerate(images):
            by_size.setdefault(image.shape, []).append(index)
        return [
            group[begin : begin + self._batch_size]
            for group in by_size.values()
            for begin in range(0, len(group), self._batch_size)
        ]

    def _cut_out(self, image: Image, queries: Sequence[Query], scored: ScoredBoxes) -> tuple[Detection, ...]:
        height, width = image.shape[:2]
        scored = ScoredBoxes(scored.boxes_px, prefer_specific(scored.scores, queries))
        boxes = select(scored, width, height, self._rules)
        self.counts.images += 1
        self.counts.boxes += len(boxes)
        if self._segmenter is None or not boxes:
            return tuple(_detection(queries, box, None) for box in boxes)
        masks = self._segmenter.segment(image, [box.box_px for box in boxes])
        kept = [(box, mask) for box, mask in zip(boxes, masks, strict=True) if mask.any()]
        self.counts.empty_masks += len(boxes) - len(kept)
        return tuple(_detection(queries, box, mask) for box, mask in kept)


def _detection(queries: Sequence[Query], box: GroundedBox, mask: NDArray[np.bool_] | None) -> Detection:
    return Detection(queries[box.query].phrase, box.box_px, box.confidence, mask)
