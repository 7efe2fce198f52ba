"""The detector that workers of a cluster share: one call for what waits with the same queries, each caller its own answer."""

from __future__ import annotations

import asyncio
import sys
import threading
from collections.abc import Sequence

import numpy as np
import pytest

from spacevln.core import Camera, Detection, Observation, Pose, PrerequisiteError, UsageError
from spacevln.evaluation.ray_cluster import require_ray
from spacevln.evaluation.shared_detector import MAX_BATCH_IMAGES, Batcher

CAMERA = Camera(width_px=2, height_px=2, hfov_deg=90, height_m=1)


def image(number: int) -> Observation:
    rgb = np.full((2, 2, 3), number, np.uint8)
    return Observation(rgb=rgb, depth_m=np.ones((2, 2), np.float32), pose=Pose(0, 0), camera=CAMERA)


class Numbering:
    """Finds in each image a thing called by its query and the image's number; waits for ``go`` in its first call."""

    def __init__(self) -> None:
        self.calls: list[tuple[int, tuple[str, ...]]] = []
        self.go = threading.Event()

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        self.calls.append((len(observations), tuple(queries)))
        assert self.go.wait(10)
        if "bad" in queries:
            raise UsageError("No such thing.")
        return [(Detection(f"{queries[0]} {each.rgb[0, 0, 0]}", (0, 0, 1, 1), 0.5),) for each in observations]


async def ask_at_once(detector: Numbering, requests: Sequence[tuple[Sequence[int], str]]) -> list[object]:
    batcher = Batcher(detector)
    tasks = []
    for numbers, query in requests:
        tasks.append(asyncio.create_task(batcher.detect([image(number) for number in numbers], (query,))))
        await asyncio.sleep(0.01)  # in this order
    detector.go.set()
    return await asyncio.gather(*tasks, return_exceptions=True)


def names(found: object) -> list[str]:
    assert isinstance(found, list)
    return [detection.category for detections in found for detection in detections]


def test_what_waits_with_the_same_queries_is_one_call() -> None:
    detector = Numbering()
    first, second, third, fourth = asyncio.run(
        ask_at_once(detector, [([1], "sofa"), ([2, 3], "sofa"), ([4], "bed"), ([5], "sofa")])
    )
    assert detector.calls == [(1, ("sofa",)), (3, ("sofa",)), (1, ("bed",))]
    assert names(first) == ["sofa 1"]
    assert names(second) == ["sofa 2", "sofa 3"]
    assert names(third) == ["bed 4"]
    assert names(fourth) == ["sofa 5"]


def test_a_call_has_a_largest_size_and_a_request_is_never_split() -> None:
    detector = Numbering()
    many = list(range(MAX_BATCH_IMAGES + 6))
    asyncio.run(ask_at_once(detector, [([0], "sofa"), (many, "sofa"), (many[:20], "sofa"), (many[:4], "sofa")]))
    assert [count for count, _ in detector.calls] == [1, MAX_BATCH_IMAGES + 6, 24]


def test_an_error_reaches_those_who_asked() -> None:
    first, bad, after = asyncio.run(ask_at_once(Numbering(), [([1], "sofa"), ([2], "bad"), ([3], "bed")]))
    assert names(first) == ["sofa 1"]
    assert isinstance(bad, UsageError)
    assert names(after) == ["bed 3"]


def test_without_ray_a_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(PrerequisiteError, match=r"pip install 'spacevln\[ray\]'"):
        require_ray()
