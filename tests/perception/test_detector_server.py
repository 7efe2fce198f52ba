import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from echo_detector import Echo, echo
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from spacevln.core import Detection, EnvironmentFailure, PrerequisiteError, UsageError
from spacevln.perception.serving import SharedDetector
from spacevln.perception.serving import client as client_module
from spacevln.perception.serving.batching import Batcher
from spacevln.perception.serving.wire import pack, unpack

Open = Callable[..., SharedDetector]


@pytest.fixture
def connect(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Open]:
    """Opens clients of a server of their own; the server is killed afterwards."""
    paths = [str(Path(__file__).parent), *filter(None, sys.path)]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    folder = tmp_path / "s"
    clients: list[SharedDetector] = []

    def opened(factory: str = "echo_detector:make", **settings: object) -> SharedDetector:
        clients.append(SharedDetector(factory, settings, folder))
        return clients[-1]

    yield opened
    for client in clients:
        client.close()
    for process in client_module._started:
        process.kill()
        process.wait()
    client_module._started.clear()


def picture(seed: int, width: int = 64, height: int = 48) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 255, (height, width, 3), np.uint8)


def same(a: Detection, b: Detection) -> bool:
    assert a.mask is not None
    assert b.mask is not None
    return (a.category, a.box_px, a.confidence) == (b.category, b.box_px, b.confidence) and np.array_equal(a.mask, b.mask)


@settings(deadline=None, max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.tuples(st.integers(1, 30), st.integers(1, 30), st.booleans(), st.integers(0, 99)), max_size=6))
def test_detections_survive_the_wire(rows: list[tuple[int, int, bool, int]]) -> None:
    found = tuple(
        Detection(
            "sofa", (3, 4, 3 + w, 4 + h), 0.5, np.random.default_rng(seed).random((h, w)) < 0.5 if masked else None, ("white",)
        )
        for w, h, masked, seed in rows
    )
    (back,) = unpack(*pack([found]))
    assert [(d.category, d.box_px, d.confidence, d.attributes) for d in back] == [
        (d.category, d.box_px, d.confidence, d.attributes) for d in found
    ]
    for a, b in zip(found, back, strict=True):
        assert (a.mask is None) == (b.mask is None)
        assert a.mask is None or np.array_equal(a.mask, b.mask)


def test_requests_that_wait_share_a_pass_when_they_ask_the_same() -> None:
    detector, busy, free = Echo(), threading.Event(), threading.Event()

    def detect_images(images: Sequence[NDArray[np.uint8]], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        busy.set()
        assert free.wait(10)
        return detector.detect_images(images, phrases)

    batcher = Batcher(detect_images, max_images=4)
    asked = [(("sofa",), 0), (("sofa",), 1), (("door",), 2), (("sofa",), 3), (("sofa",), 4), (("sofa",), 5), (("sofa",), 6)]
    answers = [batcher.submit([picture(0)], ("sofa",))]
    assert busy.wait(10)  # by the first alone: all others wait
    answers += [batcher.submit([picture(seed)], phrases) for phrases, seed in asked[1:]]
    free.set()
    for (phrases, seed), answer in zip(asked, answers, strict=True):
        ((found,),) = answer.result(10)
        assert same(found, echo(picture(seed), phrases[0]))
    batcher.close()
    assert detector.passes == [1, 4, 1, 1]


def test_an_error_reaches_its_callers_and_the_others_go_on() -> None:
    batcher = Batcher(Echo().detect_images)
    refused, fine = batcher.submit([picture(0)], ["refuse"]), batcher.submit([picture(1)], ["sofa"])
    with pytest.raises(UsageError):
        refused.result(10)
    assert len(fine.result(10)) == 1
    batcher.close()


def test_a_client_starts_the_server_and_others_find_it(connect: Open) -> None:
    first, second = connect(), connect()
    assert first.detect_images([], ["sofa"]) == []
    for client, size in ((first, (64, 48)), (second, (320, 240)), (first, (640, 480))):
        images = [picture(seed, *size) for seed in range(3)]
        found = client.detect_images(images, ["sofa", "door"])
        assert [
            same(a, echo(image, a.category)) for image, detections in zip(images, found, strict=True) for a in detections
        ] == [True] * 6
    assert (first.counts.starts, second.counts.starts) == (1, 0)
    assert first.detect_images([picture(0)], ["pid"])[0][0].category == second.detect_images([picture(0)], ["pid"])[0][0].category


def test_the_detector_s_errors_come_through_and_the_server_lives_on(connect: Open) -> None:
    client = connect()
    with pytest.raises(UsageError, match="'refuse' is refused"):
        client.detect_images([picture(0)], ["refuse"])
    with pytest.raises(EnvironmentFailure, match="ZeroDivisionError"):
        client.detect_images([picture(0)], ["fail"])
    assert client.detect_images([picture(0)], ["sofa"])
    assert (client.counts.starts, client.counts.retries) == (1, 0)


def test_a_bug_ends_the_server_and_the_next_request_starts_another(connect: Open) -> None:
    client = connect()
    with pytest.raises(EnvironmentFailure, match="ended by a bug"):
        client.detect_images([picture(0)], ["bug"])
    ((found,),) = client.detect_images([picture(7)], ["sofa"])
    assert same(found, echo(picture(7), "sofa"))
    assert (client.counts.starts, client.counts.retries) == (2, 1)


def test_a_server_that_cannot_start_says_why(connect: Open) -> None:
    with pytest.raises(PrerequisiteError, match="These settings are not usable"):
        connect("echo_detector:unusable").detect_images([picture(0)], ["sofa"])


def test_a_killed_server_is_started_again_and_requests_are_retried_and_counted(connect: Open) -> None:
    client = connect()
    pid = int(client.detect_images([picture(0)], ["pid"])[0][0].category.split()[1])
    os.kill(pid, signal.SIGKILL)
    for process in client_module._started:
        process.wait()
    ((found,),) = client.detect_images([picture(7)], ["sofa"])
    assert same(found, echo(picture(7), "sofa"))
    assert (client.counts.starts, client.counts.retries) == (2, 1)
    with pytest.raises(EnvironmentFailure, match="died 3 times under one request"):
        client.detect_images([picture(0)], ["crash"])
    assert client.counts.retries == 3


def soak(connect: Open, clients: int, seconds: float) -> int:
    """Many clients with pictures and phrases of their own; every answer must be the asker's."""
    deadline = time.monotonic() + seconds
    began = threading.Barrier(clients)

    def one(number: int) -> int:
        client, count = connect(delay_s=0.002), 0
        began.wait()
        while time.monotonic() < deadline or count == 0:
            images = [picture(number * 1_000_003 + count * 3 + k, 48 + 16 * (number % 2), 32) for k in range(1 + count % 3)]
            phrases = ["sofa", "door"][: 1 + (number + count) % 2]
            found = client.detect_images(images, phrases)
            assert [[d.category for d in each] for each in found] == [phrases] * len(images)
            assert all(same(d, echo(image, d.category)) for image, each in zip(images, found, strict=True) for d in each)
            count += 1
        assert client.counts.requests == count
        assert client.counts.retries == 0
        return count

    with ThreadPoolExecutor(clients) as pool:
        return sum(pool.map(one, range(clients)))


def test_answers_are_neither_lost_nor_swapped(connect: Open) -> None:
    assert soak(connect, clients=4, seconds=1.0) >= 4


@pytest.mark.slow
def test_eight_clients_for_half_a_minute(connect: Open) -> None:
    assert soak(connect, clients=8, seconds=30.0) >= 100
