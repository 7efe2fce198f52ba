"""What the tests of models share: a request, a desk on a scripted server, a clock that only sleeps in the mind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from spacevln.core import ChatModel, ChatRequest, ImagePart, Message, ReplySchema, Role, Speaker, TextPart
from spacevln.models import ModelChoice, ModelDesk, RetrySettings, RunAccess
from spacevln.models.modes import ModeMemory
from spacevln.models.retry import Timing
from spacevln.testing.scripted import EventList

JPEG = b"\xff\xd8\xff\xe0 picture"
SCHEMA = ReplySchema(
    "decision",
    {"type": "object", "properties": {"why": {"type": "string"}, "action": {"enum": ["left", "right"]}}, "required": ["action"]},
)
FAST = RetrySettings(attempts=3, first_wait_s=1.0, attempt_s=5.0, total_s=60.0)
GOOD = {"why": "the sofa is there", "action": "left"}


def request(text: str = "Where?", role: Role = Role.PLANNER, **changes: Any) -> ChatRequest:
    messages = (
        Message(Speaker.SYSTEM, (TextPart("You navigate."),), static=True),
        Message(Speaker.USER, (TextPart(text), ImagePart(JPEG, "view front"))),
    )
    return ChatRequest(**{"role": role, "messages": messages, "reply_schema": SCHEMA, **changes})


@dataclass
class MindClock:
    """Real time, plus what was slept in the mind."""

    slept: list[float] = field(default_factory=list)
    begin: float = 0.0

    def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)

    def clock(self) -> float:
        import time

        return time.monotonic() + sum(self.slept)

    @property
    def timing(self) -> Timing:
        return Timing(self.clock, self.sleep, np.random.default_rng(0))


@dataclass
class Setting:
    """One episode's models, and what became of the calls."""

    models: dict[Role, ChatModel]
    desk: ModelDesk
    heard: EventList
    time: MindClock

    @property
    def planner(self) -> ChatModel:
        return self.models[Role.PLANNER]


@contextmanager
def asking(
    url: str,
    folder: Path,
    retry: RetrySettings = FAST,
    access: RunAccess | None = None,
    profile: str = "openai-compatible",
    model: str = "scripted",
    **choice: Any,
) -> Iterator[Setting]:
    """Models of one episode at a server."""
    heard, time = EventList(), MindClock()
    chosen = ModelChoice(profile=profile, model=model, base_url=url, retry=retry, **choice)
    with ModelDesk(dict.fromkeys(Role, chosen), access, time.timing, ModeMemory(folder / "modes.json")) as desk:
        yield Setting(desk.for_episode(heard.emit), desk, heard, time)
