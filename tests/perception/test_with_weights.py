"""Published models on two renders, where their weights lie on this machine: ``pytest -m weights tests/perception``.

What is expected comes from the renderer (``make_renders.py``), not from a model: a model that finds the sofa finds it there.
``SPACEVLN_TEST_GROUNDER`` and ``SPACEVLN_TEST_SEGMENTER`` name other models than the default ones.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from make_renders import CAMERA, VIEWS
from numpy.typing import NDArray

from spacevln.core import Detection, Observation, Pose
from spacevln.perception.open_vocabulary.opening import DetectorChoice, open_detector

FOLDER = Path(__file__).parent / "renders"
LEAST_OVERLAP = 0.5  # intersection over union, of boxes and of masks
EXPECTED: dict[str, dict[str, list[int]]] = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))


def picture(name: str) -> Observation:
    bgr = cv2.imread(str(FOLDER / f"{name}.jpg"))
    assert bgr is not None
    rgb = np.ascontiguousarray(bgr[:, :, ::-1])
    return Observation(rgb, np.ones(rgb.shape[:2], np.float32), Pose(0.0, 0.0), CAMERA)


def true_mask(name: str, phrase: str) -> NDArray[np.bool_]:
    masks = cv2.imread(str(FOLDER / f"{name}.png"), cv2.IMREAD_GRAYSCALE)
    assert masks is not None
    return np.asarray(masks == 1 + list(EXPECTED[name]).index(phrase))


def overlap(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    return float(np.count_nonzero(a & b)) / max(1, np.count_nonzero(a | b))


def filled(box: tuple[int, ...], mask: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
    """A box, or the mask in it, as a mask of the whole image."""
    x0, y0, x1, y1 = box
    whole = np.zeros((CAMERA.height_px, CAMERA.width_px), np.bool_)
    whole[y0:y1, x0:x1] = True if mask is None else mask
    return whole


def missing(name: str, found: tuple[Detection, ...]) -> list[str]:
    """What a detector did not find where it is, in words."""
    told = []
    for phrase, box in EXPECTED[name].items():
        of_it = [detection for detection in found if detection.category == phrase]
        best = max(of_it, key=lambda each: overlap(filled(each.box_px), filled(tuple(box))), default=None)
        if best is None or overlap(filled(best.box_px), filled(tuple(box))) < LEAST_OVERLAP:
            told.append(f"{name}: no box of the {phrase}")
        elif best.mask is not None and overlap(filled(best.box_px, best.mask), true_mask(name, phrase)) < LEAST_OVERLAP:
            told.append(f"{name}: another mask of the {phrase}")
    return told


def truth(name: str, shift_px: int = 0) -> tuple[Detection, ...]:
    found = []
    for phrase, (x0, y0, x1, y1) in EXPECTED[name].items():
        mask = true_mask(name, phrase)[y0:y1, x0:x1]
        found.append(Detection(phrase, (x0, y0 - shift_px, x1, y1 - shift_px), 0.9, mask))
    return tuple(found)


@pytest.mark.parametrize("name", VIEWS)
def test_what_is_expected_is_in_the_picture_and_errors_are_told(name: str) -> None:
    assert list(EXPECTED[name]) == list(VIEWS[name][2])
    assert missing(name, truth(name)) == []
    assert len(missing(name, truth(name, shift_px=70))) >= 1
    assert len(missing(name, ())) == 4
    turned = tuple(Detection(d.category, d.box_px, 0.9, ~d.mask) for d in truth(name) if d.mask is not None)
    assert any("mask" in line for line in missing(name, turned))


@pytest.mark.weights
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", VIEWS)
def test_published_models_find_what_is_there(name: str) -> None:
    usual = DetectorChoice()
    choice = DetectorChoice(
        os.environ.get("SPACEVLN_TEST_GROUNDER", usual.grounder), os.environ.get("SPACEVLN_TEST_SEGMENTER", usual.segmenter)
    )
    (found,) = open_detector(choice).detect([picture(name)], tuple(EXPECTED[name]))
    assert missing(name, found) == []
