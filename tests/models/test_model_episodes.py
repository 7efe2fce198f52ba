"""Whole episodes over HTTP: the same as without it, whatever the server does, recorded and replayed."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from chatting import MindClock

from spacevln.agent import AgentSettings, EpisodeResult, NavigationAgent
from spacevln.core import (
    CallRetried,
    EpisodeSpec,
    EpisodeStatus,
    EventSink,
    InstructionTask,
    ModelCalled,
    Pose,
    ReplyRefused,
    Role,
    StepTaken,
    StopReason,
)
from spacevln.models import ModelChoice, ModelDesk, RetrySettings, RunAccess
from spacevln.models.modes import ModeMemory
from spacevln.perception import LabelDetector
from spacevln.reasoning.rules import RuleExecutor, RulePlanner
from spacevln.reasoning.spatial_cot import ExecutorPrompt, ModelExecutor, ModelPlanner, PlannerPrompt, PromptSettings
from spacevln.recording import EpisodeRecorder, RecordLevel, read_events, usage_of
from spacevln.testing.chat_server import Hang, Raw, Refuse, Reset, Say, ScriptedServer, Turn, closed_url
from spacevln.testing.dictation import DictatingExecutor, DictatingPlanner, Dictation
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import EventList

pytestmark = pytest.mark.allow_hosts(["127.0.0.1"])
SPEC = EpisodeSpec("words", "flatland", Pose(0.0, 0.0), InstructionTask("Walk through the doorway and stop beside the bed."))
QUICK = RetrySettings(attempts=3, first_wait_s=0.5, attempt_s=5.0, total_s=30.0)
PROMPTS = PromptSettings(turn_steps=6, view_width_px=64, forward_width_px=64)
Spoiler = Callable[[str], Turn]


class Dictated:
    """The rules, speaking through a server that plays their words, spoiled or not."""

    def __init__(self, folder: Path, spoil: Spoiler | None = None, retry: RetrySettings = QUICK, url: str | None = None) -> None:
        self.plans, self.acts = Dictation(), Dictation()
        self.spoil = spoil or Say
        self.server = ScriptedServer([self.play], models=("planner", "executor"))
        self.folder, self.retry, self.url = folder, retry, url

    def play(self, body: dict[str, Any]) -> Turn:
        lines = (self.plans if body["model"] == "planner" else self.acts).lines
        return self.spoil(lines[0] if lines else "{}")

    def run(self, *sinks: EventSink, limit: int = 80, access: RunAccess | None = None) -> EpisodeResult:
        def tell(event: Any) -> None:
            for sink in sinks:
                sink.emit(event)

        with self.server as server:
            choices = {
                role: ModelChoice(
                    profile="openai-compatible",
                    model=role.value,
                    base_url=self.url or server.url,
                    retry=self.retry,
                    price={"kind": "tokens", "input": 1.0, "output": 2.0},  # type: ignore[arg-type]
                )
                for role in Role
            }
            with ModelDesk(choices, access, MindClock().timing, ModeMemory(self.folder / "modes.json")) as desk:
                models = desk.for_episode(tell)
                world = Flatland()
                planner = _Forgetful(
                    RulePlanner(), ModelPlanner(models[Role.PLANNER], PlannerPrompt(PROMPTS, world.spec)), self.plans
                )
                executor = _ForgetfulExecutor(
                    RuleExecutor(), ModelExecutor(models[Role.EXECUTOR], ExecutorPrompt(PROMPTS, world.spec)), self.acts
                )
                agent = NavigationAgent(world, LabelDetector(), planner, executor, AgentSettings(step_limit=limit), sinks)
                return agent.run(SPEC)


class _Forgetful(DictatingPlanner):
    """What was dictated for an earlier call and never said is forgotten; a line may be played more than once."""

    def plan(self, context: Any) -> Any:
        self.dictation.lines.clear()
        return super().plan(context)


class _ForgetfulExecutor(DictatingExecutor):
    def act(self, context: Any) -> Any:
        self.dictation.lines.clear()
        return super().act(context)


def steps(sink: EventList) -> list[StepTaken]:
    return [event for event in sink.events if isinstance(event, StepTaken)]


def alone(limit: int = 80) -> tuple[EventList, EpisodeResult]:
    sink, world = EventList(), Flatland()
    settings = AgentSettings(step_limit=limit)
    agent = NavigationAgent(
        world, LabelDetector(), DictatingPlanner(RulePlanner()), DictatingExecutor(RuleExecutor()), settings, [sink]
    )
    return sink, agent.run(SPEC)


def test_an_episode_over_http_is_the_episode_of_its_author(tmp_path: Path) -> None:
    sink, recorder = EventList(), EpisodeRecorder(tmp_path / "episode")
    result = Dictated(tmp_path).run(sink, recorder)
    recorder.close()
    expected_sink, expected = alone()
    assert [event.action for event in steps(sink)] == [event.action for event in steps(expected_sink)]
    assert (result.status, result.stop_reason, result.pose) == (expected.status, expected.stop_reason, expected.pose)
    lines = list(read_events(tmp_path / "episode"))
    usage = usage_of(lines)
    called = [event for event in sink.events if isinstance(event, ModelCalled)]
    assert usage["planner"].calls + usage["executor"].calls == len(called)
    assert usage["planner"].usd > 0
    assert usage["planner"].tokens.input_tokens > usage["executor"].tokens.input_tokens / usage["executor"].calls
    stages = {line.stage for line in lines if line.event == "model_called"}
    parts = [usage_of(lines, stage) for stage in stages]
    assert sum(part["planner"].usd for part in parts) == pytest.approx(usage["planner"].usd)


def test_every_call_is_recorded_whole(tmp_path: Path) -> None:
    folder = tmp_path / "episode"
    sink, recorder = EventList(), EpisodeRecorder(folder)
    Dictated(tmp_path).run(sink, recorder, limit=20)
    recorder.close()
    called = [event for event in sink.events if isinstance(event, ModelCalled)]
    lines = [line for line in read_events(folder) if line.event == "model_called"]
    for event, line in zip(called, lines, strict=True):
        assert line.digest == event.request.digest
        assert line.reply == event.reply
        assert line.parsed == json.loads(event.reply.text)  # type: ignore[union-attr]
        pictures = [part for message in line.messages for part in message.parts if part.kind == "image"]
        assert [(folder / part.file).read_bytes() for part in pictures] == [image.data for image in event.request.images]
        static = [part for message in line.messages if message.static for part in message.parts]
        assert {part.kind for part in static} == {"text_file"}
    assert len({path.suffix for path in (folder / "prompts").iterdir()} & {".txt", ".jpg", ".json"}) == 3


def test_a_light_record_keeps_the_hashes_of_pictures_only(tmp_path: Path) -> None:
    folder = tmp_path / "episode"
    recorder = EpisodeRecorder(folder, RecordLevel.LIGHT)
    Dictated(tmp_path).run(recorder, limit=20)
    recorder.close()
    assert not list((folder / "prompts").glob("*.jpg"))
    line = next(line for line in read_events(folder) if line.event == "model_called")
    picture = next(part for message in line.messages for part in message.parts if part.kind == "image")
    assert picture.file is None
    assert len(picture.sha256) == 64


def test_a_dead_server_ends_the_episode_in_a_controlled_way(tmp_path: Path) -> None:
    sink = EventList()
    result = Dictated(tmp_path, url=closed_url()).run(sink)
    assert result.status is EpisodeStatus.MODEL_FAILURE
    assert result.stopped
    assert "connection" in result.detail
    assert [event.kind for event in sink.events if isinstance(event, CallRetried)] == ["connection"] * 2


def test_an_executor_that_fails_hands_the_stage_back(tmp_path: Path) -> None:
    def spoil(words: str) -> Turn:
        return Refuse(500) if '"choice"' in words else Say(words)

    sink = EventList()
    result = Dictated(tmp_path, spoil).run(sink, limit=20)
    assert "FallbackUsed" in sink.names()
    assert result.status in (EpisodeStatus.STEP_LIMIT, EpisodeStatus.MODEL_FAILURE)


def test_a_spent_purse_stops_the_body_and_is_no_failure_of_the_model(tmp_path: Path) -> None:
    sink = EventList()
    result = Dictated(tmp_path).run(sink, access=RunAccess(max_usd=0.005))
    assert (result.status, result.stop_reason, result.stopped) == (EpisodeStatus.INTERRUPTED, StopReason.SPENDING, True)
    assert "--max-usd 0.005" in result.detail
    assert "FallbackUsed" not in sink.names()


FAULTS: tuple[Callable[[str], Turn], ...] = (
    lambda _: Refuse(429, headers={"Retry-After": "3"}),
    lambda _: Refuse(500),
    lambda _: Refuse(503),
    lambda _: Refuse(400, "no"),
    lambda _: Reset(),
    lambda _: Reset(mid_reply=False),
    lambda _: Hang(),
    lambda _: Raw(b'{"choices": [{"message": {"content": "\xff"}}]}'),
    lambda _: Raw(b'{"choices": ['),
    lambda words: Say(words[: len(words) // 2], finish="length"),
    lambda words: Say(words[: len(words) // 2]),
    lambda words: Say(f"Here it is:\n```json\n{words}\n```"),
    lambda words: Say(f"I think {words} is best."),
    lambda _: Say(""),
    lambda _: Say("", finish="content_filter"),
    lambda _: Say("x" * 1_000_000),
    lambda words: Say(words.replace("front", "north").replace("forward", "fly")),
    lambda words: Say(words.replace('"ahead"', '"done"')),
    lambda words: Say(json.dumps(dict.fromkeys(json.loads(words)))),
    lambda words: Say(words + "\ud800"),
)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 200, 25))
def test_any_sequence_of_faults_ends_in_a_controlled_way_with_a_readable_record(first: int, tmp_path: Path) -> None:
    patience = RetrySettings(attempts=3, first_wait_s=0.1, attempt_s=0.12, total_s=30.0)
    for seed in range(first, first + 25):
        rng, lock = np.random.default_rng(seed), threading.Lock()
        rate = float(rng.uniform(0.05, 0.7))

        def spoil(words: str, rng: np.random.Generator = rng, rate: float = rate, lock: threading.Lock = lock) -> Turn:
            with lock:
                return FAULTS[rng.integers(len(FAULTS))](words) if rng.random() < rate else Say(words)

        sink, recorder = EventList(), EpisodeRecorder(tmp_path / str(seed), RecordLevel.LIGHT)
        result = Dictated(tmp_path, spoil, patience).run(sink, recorder, limit=40)
        recorder.close()
        assert result.status in (EpisodeStatus.STOPPED, EpisodeStatus.STEP_LIMIT, EpisodeStatus.MODEL_FAILURE)
        assert result.stopped
        assert result.steps <= 40
        lines = list(read_events(tmp_path / str(seed)))
        assert lines[-1].event == "episode_ended"
        assert len(lines) == len(sink.events)
        assert all(event.kind and event.reason for event in sink.events if isinstance(event, ReplyRefused))
