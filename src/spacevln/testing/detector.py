"""What every detector must do.

Run it on an own one in five lines::

    from spacevln.testing.detector import DetectorConformance

    class TestMine(DetectorConformance):
        def make_detector(self): return MyDetector()
        def make_scene(self): return observations, "sofa"

The scene: one or more observations, the first of which shows an instance of the phrase.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from spacevln.core.interfaces import Detector
from spacevln.core.sensing import Detection, Observation


class DetectorConformance:
    """Subclass it, give the two makers, and let pytest collect it."""

    def make_detector(self) -> Detector:
        """A new detector."""
        raise NotImplementedError("Give make_detector() in your subclass: it returns the detector under test.")

    def make_scene(self) -> tuple[Sequence[Observation], str]:
        """Observations and a phrase of which the first one shows an instance."""
        raise NotImplementedError("Give make_scene() in your subclass: it returns observations and a phrase seen in the first.")

    @pytest.fixture
    def detector(self) -> Detector:
        """The detector under test."""
        return self.make_detector()

    @pytest.fixture
    def observations(self) -> Sequence[Observation]:
        """Observations of the scene."""
        return self.make_scene()[0]

    @pytest.fixture
    def phrase(self) -> str:
        """A phrase that the first observation shows."""
        return self.make_scene()[1]

    def test_one_tuple_per_observation_in_order(
        self, detector: Detector, observations: Sequence[Observation], phrase: str
    ) -> None:
        """The reply is a list with a tuple of detections for each image."""
        found = detector.detect(observations, [phrase])
        assert isinstance(found, list)
        assert len(found) == len(observations)
        assert all(isinstance(detections, tuple) for detections in found)
        assert all(isinstance(detection, Detection) for detections in found for detection in detections)

    def test_finds_what_is_there(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """The phrase is found in the image that shows it."""
        assert detector.detect(observations[:1], [phrase])[0]

    def test_boxes_lie_in_the_image(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """Whole pixels, not empty, the end exclusive."""
        for observation, detections in zip(observations, detector.detect(observations, [phrase]), strict=True):
            for detection in detections:
                x0, y0, x1, y1 = detection.box_px
                assert all(isinstance(edge, int) for edge in detection.box_px)
                assert 0 <= x0 < x1 <= observation.camera.width_px
                assert 0 <= y0 < y1 <= observation.camera.height_px

    def test_masks_fill_their_boxes(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """A mask is boolean, has the size of its box and is not empty."""
        for detections in detector.detect(observations, [phrase]):
            for detection in detections:
                if detection.mask is not None:
                    x0, y0, x1, y1 = detection.box_px
                    assert detection.mask.dtype == np.bool_
                    assert detection.mask.shape == (y1 - y0, x1 - x0)
                    assert detection.mask.any()

    def test_confidence_is_a_probability(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """From 0 to 1."""
        for detections in detector.detect(observations, [phrase]):
            assert all(0 <= detection.confidence <= 1 for detection in detections)

    def test_a_category_is_a_plain_term(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """Lower case, no blanks around it, not empty."""
        for detections in detector.detect(observations, [phrase]):
            for detection in detections:
                assert detection.category == detection.category.strip().lower() != ""

    def test_no_query_no_detection(self, detector: Detector, observations: Sequence[Observation]) -> None:
        """Without a query nothing is sought."""
        assert detector.detect(observations, []) == [()] * len(observations)

    def test_no_observation_no_result(self, detector: Detector, phrase: str) -> None:
        """An empty batch has an empty reply."""
        assert detector.detect([], [phrase]) == []

    def test_a_batch_gives_what_single_images_give(
        self, detector: Detector, observations: Sequence[Observation], phrase: str
    ) -> None:
        """The company of other images changes nothing."""
        together = detector.detect(observations, [phrase])
        alone = [detector.detect([observation], [phrase])[0] for observation in observations]
        assert [_facts(detections) for detections in together] == [_facts(detections) for detections in alone]

    def test_repeats_itself(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """The same images and phrase give the same detections."""
        first, second = detector.detect(observations, [phrase]), detector.detect(observations, [phrase])
        assert [_facts(detections) for detections in first] == [_facts(detections) for detections in second]

    def test_leaves_the_observation_alone(self, detector: Detector, observations: Sequence[Observation], phrase: str) -> None:
        """Images are read, never written."""
        before = [(observation.rgb.copy(), observation.depth_m.copy()) for observation in observations]
        detector.detect(observations, [phrase])
        for observation, (rgb, depth_m) in zip(observations, before, strict=True):
            assert np.array_equal(observation.rgb, rgb)
            assert np.array_equal(observation.depth_m, depth_m, equal_nan=True)


def _facts(detections: Sequence[Detection]) -> list[tuple[str, tuple[int, int, int, int], float]]:
    return [(detection.category, detection.box_px, round(detection.confidence, 4)) for detection in detections]
