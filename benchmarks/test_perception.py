"""Perception without a network's forward pass: goals are 5 ms a frame with 10 detections, and 3 ms for a server's round trip.

Run with ``pytest benchmarks/test_perception.py --benchmark-only``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from spacevln.core import Camera, Detection, Labels, Observation, Pose
from spacevln.mapping import MetricMap
from spacevln.memory import LocalLandmarkMemory
from spacevln.perception import lift
from spacevln.perception.open_vocabulary.boxes import BoxRules, ScoredBoxes, select
from spacevln.perception.open_vocabulary.masks import Framing, best_masks
from spacevln.perception.open_vocabulary.queries import prefer_specific, queries_of
from spacevln.perception.serving import SharedDetector
from spacevln.perception.serving import client as client_module

CAMERA = Camera(640, 480, 79.0, 0.88)
PHRASES = ("white sofa", "sofa", "couch", "doorway", "chair")
BOXES = [(20 + 120 * (k % 5), 120 + 170 * (k // 5), 130 + 120 * (k % 5), 270 + 170 * (k // 5)) for k in range(10)]


@pytest.fixture(scope="module")
def frame() -> Observation:
    """A wall at 4 m with ten things before it."""
    depth = np.full((480, 640), 4.0, np.float32)
    for k, (x0, y0, x1, y1) in enumerate(BOXES):
        depth[y0:y1, x0:x1] = 1.0 + 0.25 * k
    return Observation(
        np.zeros((480, 640, 3), np.uint8), depth, Pose(0, 0), CAMERA, labels=Labels(np.zeros((480, 640), np.int32), {})
    )


def scored() -> tuple[ScoredBoxes, np.ndarray, np.ndarray]:
    """What a grounding model (900 boxes) and a segmenter (3 masks of 256 x 256 a box) say of it."""
    rng = np.random.default_rng(0)
    boxes = np.vstack([BOXES, rng.uniform(0, 400, (890, 4))]).astype(np.float32)
    scores = np.vstack([np.eye(5)[np.arange(10) % 5] * 0.6, rng.uniform(0, 0.2, (890, 5))]).astype(np.float32)
    return (
        ScoredBoxes(boxes, scores),
        rng.normal(1, 1, (10, 3, 256, 256)).astype(np.float32),
        rng.random((10, 3)).astype(np.float32),
    )


def test_a_frame_of_ten_detections(benchmark, frame: Observation) -> None:  # type: ignore[no-untyped-def]
    """From the networks' outputs to the landmark pool: boxes, names, masks, lifting, fusion."""
    found, logits, quality = scored()
    queries, framing, metric_map = queries_of(PHRASES), Framing.padded(640, 480, 1024), MetricMap()
    metric_map.integrate(frame)

    def whole() -> int:
        boxes = select(ScoredBoxes(found.boxes_px, prefer_specific(found.scores, queries)), 640, 480, BoxRules())
        masks = best_masks(logits, quality, [box.box_px for box in boxes], framing)
        detections = [
            Detection(queries[box.query].phrase, box.box_px, box.confidence, mask) for box, mask in zip(boxes, masks, strict=True)
        ]
        landmarks = LocalLandmarkMemory("sofa", frame.pose)
        landmarks.update(lift(frame, detections), frame.pose, metric_map)
        return len(detections)

    assert benchmark(whole) == 10


@pytest.fixture
def client(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[SharedDetector]:
    """Of a server whose detector takes no time."""
    paths = [str(Path(__file__).parents[1] / "tests" / "perception"), *filter(None, sys.path)]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    opened = SharedDetector("echo_detector:quick", {}, tmp_path / "s")
    yield opened
    opened.close()
    for process in client_module._started:  # noqa: SLF001
        process.kill()
        process.wait()
    client_module._started.clear()  # noqa: SLF001


def test_a_round_trip_to_the_server(benchmark, client: SharedDetector) -> None:  # type: ignore[no-untyped-def]
    """A 640 x 480 image there, one detection with a mask of a fifth of it back."""
    image = np.random.default_rng(0).integers(0, 255, (480, 640, 3), np.uint8)
    ((found,),) = benchmark(client.detect_images, [image], ["sofa"])
    assert found.mask is not None
