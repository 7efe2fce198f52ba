from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scenes import observe

from spacevln.core import Detector, Observation, Pose, UsageError
from spacevln.perception import LabelDetector
from spacevln.testing.detector import DetectorConformance

SOFA = ("sofa", ("white", "leather"), (20, 40, 60, 80, 2.0))
BLACK = ("sofa", ("black",), (90, 40, 130, 80, 2.0))
CHAIR = ("chair", (), (65, 60, 80, 90, 1.5))


def scene() -> Observation:
    return observe({1: SOFA, 2: BLACK, 3: CHAIR})


class TestLabelDetector(DetectorConformance):
    def make_detector(self) -> Detector:
        return LabelDetector()

    def make_scene(self) -> tuple[Sequence[Observation], str]:
        return [scene(), observe({1: CHAIR}), observe({})], "sofa"


class TestNoisyLabelDetector(DetectorConformance):
    def make_detector(self) -> Detector:
        return LabelDetector(miss_rate=0.3, confusion_rate=0.3, jitter_px=20, seed=5)

    def make_scene(self) -> tuple[Sequence[Observation], str]:
        return [scene(), observe({1: CHAIR}), observe({})], "sofa"


def test_box_mask_and_words_are_the_instance_s() -> None:
    (found,) = LabelDetector().detect([observe({7: SOFA})], ["couch"])[0]
    assert found.category == "sofa"
    assert found.attributes == ("white", "leather")
    assert found.box_px == (20, 40, 60, 80)
    assert found.mask is not None
    assert found.mask.all()


def test_only_what_is_asked_is_found() -> None:
    assert {d.category for d in LabelDetector().detect([scene()], ["chair"])[0]} == {"chair"}
    assert {d.category for d in LabelDetector().detect([scene()], ["chair", "settee"])[0]} == {"chair", "sofa"}
    assert LabelDetector().detect([scene()], ["refrigerator"])[0] == ()


def test_attributes_that_agree_give_confidence_and_others_take_it() -> None:
    white, black = LabelDetector().detect([scene()], ["white sofa"])[0]
    assert white.attributes == ("white", "leather")
    assert white.confidence > 0.7
    assert black.confidence == 0.35
    plain = LabelDetector().detect([scene()], ["white sofa", "sofa"])[0]
    assert plain[0].confidence == plain[1].confidence


def test_small_and_unmeasured_things_are_not_seen() -> None:
    tiny = observe({1: ("vase", (), (10, 10, 11, 12, 2.0))})
    assert LabelDetector().detect([tiny], ["vase"])[0] == ()
    beyond = scene()
    depth = beyond.depth_m.copy()
    depth[beyond.labels.instance_ids == 1] = 0.0
    found = LabelDetector().detect([replace(beyond, depth_m=depth)], ["sofa"])[0]
    assert [d.attributes for d in found] == [("black",)]


def test_an_occluded_part_is_not_in_the_mask() -> None:
    (found,) = LabelDetector().detect([observe({1: SOFA, 2: ("box", (), (20, 40, 40, 80, 1.0))})], ["sofa"])[0]
    assert found.box_px == (40, 40, 60, 80)


def test_no_labels_is_refused_in_a_sentence() -> None:
    with pytest.raises(UsageError, match="no labels"):
        LabelDetector().detect([replace(scene(), labels=None)], ["sofa"])
    with pytest.raises(UsageError, match="miss_rate=2"):
        LabelDetector(miss_rate=2)


def test_misses_and_confusions_come_at_their_rates_and_depend_on_the_seed() -> None:
    views = [observe({1: SOFA}, wall_m=4 + 0.001 * k) for k in range(3)]
    ids = np.random.default_rng(0)
    views = [
        observe({1: (*SOFA[:2], (20 + int(ids.integers(30)), 40, 60 + int(ids.integers(60)), 80 + int(ids.integers(30)), 2.0))})
        for _ in range(300)
    ]
    seen = [len(found) for found in LabelDetector(miss_rate=0.3, seed=1).detect(views, ["sofa"])]
    assert 0.6 < np.mean(seen) < 0.8
    other = [len(found) for found in LabelDetector(miss_rate=0.3, seed=2).detect(views, ["sofa"])]
    assert seen != other
    confused = [len(found) for found in LabelDetector(confusion_rate=0.4).detect(views, ["sofa"])]
    assert 0.5 < np.mean(confused) < 0.7
    assert any(LabelDetector(confusion_rate=0.4).detect(views, ["armchair"]))


def test_noise_does_not_depend_on_the_queries() -> None:
    noisy = LabelDetector(miss_rate=0.5, jitter_px=10, seed=3)
    alone = noisy.detect([scene()], ["sofa"])[0]
    together = [d for d in noisy.detect([scene()], ["chair", "sofa", "bed"])[0] if d.category == "sofa"]
    assert [d.box_px for d in alone] == [d.box_px for d in together]


def test_jitter_moves_boxes_a_little_and_keeps_masks_fitting() -> None:
    straight = LabelDetector().detect([scene()], ["sofa"])[0]
    shaken = LabelDetector(jitter_px=20, seed=1).detect([scene()], ["sofa"])[0]
    shifts = [abs(a - b) for d, e in zip(straight, shaken, strict=True) for a, b in zip(d.box_px, e.box_px, strict=True)]
    assert 0 < max(shifts) <= 5  # 20 px at 640
    assert all(d.mask.shape == (d.box_px[3] - d.box_px[1], d.box_px[2] - d.box_px[0]) for d in shaken)


def test_large_instance_ids_are_fine() -> None:
    (found,) = LabelDetector().detect([observe({60000: SOFA}, Pose(1, 2, 0, 0.3))], ["sofa"])[0]
    assert found.category == "sofa"
