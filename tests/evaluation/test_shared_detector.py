"""The detector that workers of a cluster share: one call for what waits with the same queries, each caller its own answer."""

from __future__ import annotations

import asyncio
import sys
import threading
from collections.abc import Sequence
from concurrent.futures import Future

import numpy as np
import pytest

from spacevln.assembly import Configuration
from spacevln.core import Camera, Detection, Labels, Observation, Pose, PrerequisiteError, UsageError
from spacevln.evaluation.ray_cluster import require_ray
from spacevln.evaluation.shared_detector import MAX_BATCH_IMAGES, DetectorActor
from spacevln.perception.serving.batching import Batcher

CAMERA = Camera(width_px=2, height_px=2, hfov_deg=90, height_m=1)


def image(number: int) -> Observation:
    rgb = np.full((2, 2, 3), number, np.uint8)
    nothing = Labels(np.zeros((2, 2), np.int32), {})
    return Observation(rgb=rgb, depth_m=np.ones((2, 2), np.float32), pose=Pose(0, 0), camera=CAMERA, labels=nothing)


class Numbering:
    """Finds in each image a thing called by its query and the image's number; waits for ``go`` in its first call."""

    def __init__(self) -> None:
        self.calls: list[tuple[int, tuple[str, ...]]] = []
        self.busy, self.go = threading.Event(), threading.Event()

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        self.calls.append((len(observations), tuple(queries)))
        self.busy.set()
        assert self.go.wait(10)
        if "bad" in queries:
            raise UsageError("No such thing.")
        return [(Detection(f"{queries[0]} {each.rgb[0, 0, 0]}", (0, 0, 1, 1), 0.5),) for each in observations]


def ask_at_once(detector: Numbering, requests: Sequence[tuple[Sequence[int], str]]) -> list[Future[list[tuple[Detection, ...]]]]:
    """Answers of a batcher to requests that came in this order while it was at the first."""
    batcher = Batcher(detector.detect, MAX_BATCH_IMAGES)
    answers = []
    for numbers, query in requests:
        answers.append(batcher.submit([image(number) for number in numbers], (query,)))
        assert detector.busy.wait(10)
    detector.go.set()
    batcher.close()
    return answers


def names(found: Future[list[tuple[Detection, ...]]]) -> list[str]:
    return [detection.category for detections in found.result(10) for detection in detections]


def test_what_waits_with_the_same_queries_is_one_call() -> None:
    detector = Numbering()
    first, second, third, fourth = ask_at_once(detector, [([1], "sofa"), ([2, 3], "sofa"), ([4], "bed"), ([5], "sofa")])
    assert detector.calls == [(1, ("sofa",)), (3, ("sofa",)), (1, ("bed",))]
    assert names(first) == ["sofa 1"]
    assert names(second) == ["sofa 2", "sofa 3"]
    assert names(third) == ["bed 4"]
    assert names(fourth) == ["sofa 5"]


def test_a_call_has_a_largest_size_and_a_request_is_never_split() -> None:
    detector = Numbering()
    many = list(range(MAX_BATCH_IMAGES + 6))
    ask_at_once(detector, [([0], "sofa"), (many, "sofa"), (many[:20], "sofa"), (many[:4], "sofa")])
    assert [count for count, _ in detector.calls] == [1, MAX_BATCH_IMAGES + 6, 24]


def test_an_error_reaches_those_who_asked() -> None:
    first, bad, after = ask_at_once(Numbering(), [([1], "sofa"), ([2], "bad"), ([3], "bed")])
    assert names(first) == ["sofa 1"]
    assert isinstance(bad.exception(10), UsageError)
    assert names(after) == ["bed 3"]


def test_the_actor_answers_as_the_detector_that_the_configuration_names() -> None:
    async def ask_twice(actor: DetectorActor) -> list[list[tuple[Detection, ...]]]:
        return await asyncio.gather(actor.detect([image(1)], ("sofa",)), actor.detect([image(1), image(2)], ("sofa",)))

    assert asyncio.run(ask_twice(DetectorActor(Configuration().model_dump_json()))) == [[()], [(), ()]]


def test_without_ray_a_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(PrerequisiteError, match=r"pip install 'spacevln\[ray\]'"):
        require_ray()
