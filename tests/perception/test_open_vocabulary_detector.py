from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scenes import observe

from spacevln.core import Detector, Observation
from spacevln.perception import lift
from spacevln.perception.open_vocabulary.boxes import ScoredBoxes
from spacevln.perception.open_vocabulary.detector import Box, Image, OpenVocabularyDetector
from spacevln.perception.open_vocabulary.queries import Query
from spacevln.testing.detector import DetectorConformance

SOFA = (20, 40, 60, 80)


class Painted:
    """Finds a sofa at ``SOFA`` in pictures whose corner is not black."""

    def __init__(self) -> None:
        self.batches: list[int] = []

    def ground(self, images: Sequence[Image], queries: Sequence[Query], text_threshold: float) -> list[ScoredBoxes]:
        assert 0 < text_threshold < 1
        self.batches.append(len(images))
        sofa = ScoredBoxes(
            np.array([SOFA], np.float32), np.array([[0.6 * ("sofa" in query.text) for query in queries]], np.float32)
        )
        nothing = ScoredBoxes(np.zeros((0, 4), np.float32), np.zeros((0, len(queries)), np.float32))
        return [sofa if image[0, 0, 0] else nothing for image in images]


class Halves:
    """The left half of every box; nothing in boxes at the image's left border."""

    def segment(self, image: Image, boxes_px: Sequence[Box]) -> list[NDArray[np.bool_]]:
        assert image.ndim == 3
        masks = []
        for x0, y0, x1, y1 in boxes_px:
            mask = np.zeros((y1 - y0, x1 - x0), np.bool_)
            mask[:, : (x1 - x0) // 2] = x0 > 0
            masks.append(mask)
        return masks


def picture(has_sofa: bool = True) -> Observation:
    observation = observe({1: ("sofa", (), (*SOFA, 2.0))})
    observation.rgb[0, 0, 0] = has_sofa
    return observation


class TestOpenVocabularyDetector(DetectorConformance):
    def make_detector(self) -> Detector:
        return OpenVocabularyDetector(Painted(), Halves(), batch_size=2)

    def make_scene(self) -> tuple[Sequence[Observation], str]:
        return [picture(), picture(has_sofa=False), picture()], "sofa"


def test_what_is_found_carries_the_phrase_box_mask_and_lifts() -> None:
    detector = OpenVocabularyDetector(Painted(), Halves())
    (found,) = detector.detect([picture()], ["white sofa", "door"])[0]
    assert (found.category, found.box_px, found.attributes) == ("white sofa", SOFA, ())
    assert found.mask is not None
    assert found.mask.mean() == 0.5
    (sighting,) = lift(picture(), [found])
    assert abs(sighting.position_m[0] - 2.0) < 0.02


def test_batches_are_as_large_as_allowed() -> None:
    grounder = Painted()
    OpenVocabularyDetector(grounder, batch_size=5).detect([picture()] * 12, ["sofa"])
    assert grounder.batches == [5, 5, 2]
    grounder.batches.clear()
    OpenVocabularyDetector(grounder).detect([picture()] * 12, ["..."])
    assert grounder.batches == []


def test_boxes_alone_have_no_masks_and_empty_masks_are_counted() -> None:
    (found,) = OpenVocabularyDetector(Painted()).detect([picture()], ["sofa"])[0]
    assert found.mask is None

    class Nothing(Halves):
        def segment(self, image: Image, boxes_px: Sequence[Box]) -> list[NDArray[np.bool_]]:
            return [np.zeros_like(mask) for mask in super().segment(image, boxes_px)]

    detector = OpenVocabularyDetector(Painted(), Nothing())
    assert detector.detect([picture()], ["sofa"]) == [()]
    assert (detector.counts.images, detector.counts.boxes, detector.counts.empty_masks) == (1, 1, 1)
