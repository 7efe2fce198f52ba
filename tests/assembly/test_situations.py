"""Situations read back from a record give the prompts that were, or would have been, asked; and the command that shows them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from spacevln.agent import AgentSettings, NavigationAgent
from spacevln.assembly import Configuration, RecordedSituations
from spacevln.cli.prompt import prompt
from spacevln.core import (
    Action,
    Anchor,
    ChatRequest,
    CueKind,
    EpisodeSpec,
    ExecutorContext,
    ExecutorReply,
    InstructionTask,
    MoveForward,
    PlannerContext,
    PlannerReply,
    Pose,
    RecordError,
    SpaceKind,
    StageEnd,
    Stop,
    TurnLeft,
)
from spacevln.perception import LabelDetector
from spacevln.reasoning.spatial_cot import ExecutorPrompt, PlannerPrompt, PromptSettings
from spacevln.recording import EpisodeRecorder, RunFile, write_file
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import ScriptedExecutor, ScriptedPlanner, subtask_of

CHAIN = (
    Anchor("living room", SpaceKind.ROOM, "sofa", CueKind.SOLID),
    Anchor("", SpaceKind.UNKNOWN, "doorway", CueKind.OPENING),
    Anchor("bedroom", SpaceKind.ROOM, "bed", CueKind.SOLID),
)
FLAT = Flatland().spec


def plan(context: PlannerContext) -> Any:
    if context.feedback is None or context.last_subtask is None:
        return subtask_of(CHAIN, 0, "left 30")
    return subtask_of(CHAIN, context.last_subtask.current_index + (context.feedback.end is StageEnd.ARRIVAL))


def act(context: ExecutorContext) -> Action:
    allowed = context.admissible
    if len(context.progress.decisions) == 1 and allowed.left:
        return TurnLeft()
    return MoveForward(allowed.forward_m[-1]) if allowed.forward_m else TurnLeft() if allowed.left else Stop()


@dataclass
class Heard:
    """Passes on and keeps what was asked, in words."""

    planner: PlannerPrompt
    executor: ExecutorPrompt
    plans: list[str] = field(default_factory=list)
    acts: list[list[str]] = field(default_factory=list)

    def told(self, context: PlannerContext) -> PlannerReply:
        if not context.rejections:
            self.plans.append(words(self.planner.request(context)))
            self.acts.append([])
        return PlannerReply(plan(context))

    def done(self, context: ExecutorContext) -> ExecutorReply:
        self.acts[-1].append(words(self.executor.request(context)))
        return ExecutorReply(act(context))


def words(request: ChatRequest) -> str:
    return "\n".join(message.text for message in request.messages)


@pytest.fixture(scope="module")
def heard(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Heard]:
    run = tmp_path_factory.mktemp("run")
    folder = run / "episodes" / "words"
    configuration = Configuration(step_budget=80)
    recorder = EpisodeRecorder(folder)
    settings = PromptSettings(view_width_px=64, forward_width_px=64)
    listener = Heard(PlannerPrompt(settings, FLAT), ExecutorPrompt(settings, FLAT))
    minds = ScriptedPlanner([listener.told]), ScriptedExecutor([listener.done])
    agent = NavigationAgent(Flatland(), LabelDetector(), *minds, AgentSettings(step_limit=80), [recorder])
    agent.run(EpisodeSpec("words", "flatland", Pose(0.0, 0.0), InstructionTask("Go to the bed.")))
    recorder.close()
    said = {"version": "0", "suite": "flat", "created": "", "command": (), "configuration": configuration.model_dump(mode="json")}
    said |= {"configuration_hash": "", "packages": {}, "python": "", "platform": "", "git_revision": None}
    write_file(run / "run.json", RunFile.model_validate(said))
    return folder, listener


def test_every_prompt_can_be_made_anew_from_the_record(heard: tuple[Path, Heard]) -> None:
    folder, listener = heard
    situations = RecordedSituations(folder, Configuration(step_budget=80), FLAT.camera)
    assert len(listener.plans) >= 2
    for stage, told in enumerate(listener.plans):
        assert words(listener.planner.request(situations.planner(stage))) == told
        for decision, asked in enumerate(listener.acts[stage], start=1):
            assert words(listener.executor.request(situations.executor(stage, decision))) == asked


def test_what_the_record_does_not_hold_is_said(heard: tuple[Path, Heard], tmp_path: Path) -> None:
    folder, _ = heard
    situations = RecordedSituations(folder, Configuration(), FLAT.camera)
    with pytest.raises(RecordError, match="no stage 99: give another number"):
        situations.planner(99)
    with pytest.raises(RecordError, match="no decision 9 in stage 0"):
        situations.executor(0, 9)
    (tmp_path / "events.jsonl").write_bytes((folder / "events.jsonl").read_bytes())
    with pytest.raises(RecordError, match="level full"):
        RecordedSituations(tmp_path, Configuration(), FLAT.camera).planner(0)


def test_the_command_prints_the_prompt_and_writes_its_pictures(heard: tuple[Path, Heard], tmp_path: Path) -> None:
    folder, _ = heard
    done = CliRunner().invoke(prompt, [str(folder.parent.parent), "1", "--to", str(tmp_path / "p"), "--views", "4"])
    assert done.exit_code == 0, done.output
    assert "# LAST STAGE" in done.output
    assert "[01_map.png: " in done.output
    assert "5 pictures" in done.output
    assert len(list((tmp_path / "p").glob("*.jpg"))) == 4
    assert "Go to the bed." in (tmp_path / "p" / "request.md").read_text()


def test_the_command_prints_an_executors_question(heard: tuple[Path, Heard]) -> None:
    done = CliRunner().invoke(prompt, [str(heard[0]), "0", "--decision", "2"])
    assert done.exit_code == 0, done.output
    assert "1. forward" in done.output
    assert "# ADMISSIBLE" in done.output
