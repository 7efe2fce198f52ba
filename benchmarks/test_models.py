"""Overhead of the model boundary without the model: what every call pays beside the server's time."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from spacevln.core import (
    ChatReply,
    ChatRequest,
    ImagePart,
    Message,
    ModelCalled,
    ReplySchema,
    Role,
    Speaker,
    TextPart,
    read_object,
)
from spacevln.models import ModelChoice
from spacevln.models.dialect import request_body
from spacevln.models.ledger import RunLedger
from spacevln.models.profiles import profile
from spacevln.recording import EpisodeRecorder

REPLY = json.dumps(
    {
        "observation": "A hallway with a brown bench on the left and a doorway ahead. " * 6,
        "memory": "The kitchen lies behind, 4 m. " * 6,
        "progress": {"reasoning": "The bench was reached. " * 6, "verdict": "completed"},
        "decision": "Through the doorway ahead. " * 6,
        "plan": "Then the sofa. " * 6,
        "chain": [{"space": "hallway", "kind": "connector", "landmark": "bench", "status": "done"}] * 4,
        "complete": False,
    }
)


@pytest.fixture(scope="module")
def planner_request() -> ChatRequest:
    rng = np.random.default_rng(0)
    smooth = cv2.resize(rng.integers(0, 255, (12, 16, 3), dtype=np.uint8), (512, 384))
    _, data = cv2.imencode(".jpg", smooth)
    pictures = tuple(ImagePart(data.tobytes() + bytes([k]), f"view {k}") for k in range(13))
    messages = (
        Message(Speaker.SYSTEM, (TextPart("rule " * 1200),), static=True),
        Message(Speaker.USER, (TextPart("state " * 400), *pictures)),
    )
    return ChatRequest(Role.PLANNER, messages, ReplySchema("r", {"type": "object", "properties": {"a": {"type": "string"}}}))


def test_request_body_of_a_planner(benchmark: Any, planner_request: ChatRequest) -> None:
    choice, known = ModelChoice(profile="dashscope", model="m"), profile("dashscope")
    benchmark(lambda: json.dumps(request_body(planner_request, choice, known, known.best_mode)))


def test_digest_of_a_planner_request(benchmark: Any, planner_request: ChatRequest) -> None:
    benchmark(lambda: planner_request.digest)


def test_reading_a_reply(benchmark: Any) -> None:
    benchmark(lambda: read_object(REPLY))


def test_recording_a_call(benchmark: Any, planner_request: ChatRequest, tmp_path: Path) -> None:
    recorder = EpisodeRecorder(tmp_path)
    event = ModelCalled("m", planner_request, ChatReply(REPLY))
    benchmark(lambda: recorder.emit(event))
    recorder.close()


def test_a_place_in_the_shared_ledger(benchmark: Any, tmp_path: Path) -> None:
    ledger = RunLedger(tmp_path / "ledger.sqlite", max_usd=1e9)

    def call() -> None:
        ledger.check()
        ledger.reserve()
        ledger.spend(0.001)

    benchmark(call)
    ledger.close()
