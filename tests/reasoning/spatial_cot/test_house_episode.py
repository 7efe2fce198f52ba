"""A complete episode in an embedded house through prompts, HTTP, parsing, validation and control; the rules are its author."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from spacevln.agent import AgentSettings, EpisodeResult, NavigationAgent
from spacevln.core import (
    DecisionMade,
    Environment,
    ExecutorContext,
    ExecutorReply,
    ModelCalled,
    PlannerContext,
    PlannerReply,
    ReplyRefused,
    Role,
    StepTaken,
    SubtaskIssued,
)
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.evaluation.houses import pick_episode
from spacevln.models import ModelChoice, ModelDesk
from spacevln.models.modes import ModeMemory
from spacevln.perception import LabelDetector
from spacevln.reasoning.rules import RuleExecutor, RulePlanner
from spacevln.reasoning.spatial_cot import ExecutorPrompt, ModelExecutor, ModelPlanner, PlannerPrompt, PromptSettings
from spacevln.testing.chat_server import Say, ScriptedServer
from spacevln.testing.dictation import DictatingExecutor, DictatingPlanner, Dictation
from spacevln.testing.scripted import EventList

pytestmark = [pytest.mark.slow, pytest.mark.allow_hosts(["127.0.0.1"])]
PROMPTS = PromptSettings(turn_steps=6)


def drive(planner: Any, executor: Any, world: Environment, sink: EventList, task: str) -> EpisodeResult:
    agent = NavigationAgent(world, LabelDetector(), planner, executor, AgentSettings(), [sink])
    return agent.run(pick_episode(task, 9).spec)


def kept(sink: EventList, kind: type) -> list[Any]:
    return [event for event in sink.events if isinstance(event, kind)]


class FreshPlanner(DictatingPlanner):
    """What an earlier question left unsaid is forgotten."""

    def plan(self, context: PlannerContext) -> PlannerReply:
        self.dictation.lines.clear()
        return super().plan(context)


class FreshExecutor(DictatingExecutor):
    def act(self, context: ExecutorContext) -> ExecutorReply:
        self.dictation.lines.clear()
        return super().act(context)


@pytest.mark.parametrize("task", ["vln", "objectnav"])
def test_an_episode_over_http_reaches_what_its_author_reaches_alone(task: str, tmp_path: Path) -> None:
    world, alone, said = HousesEnvironment(), EventList(), EventList()
    expected = drive(DictatingPlanner(RulePlanner()), DictatingExecutor(RuleExecutor()), world, alone, task)

    plans, acts = Dictation(), Dictation()
    lines = {Role.PLANNER: plans, Role.EXECUTOR: acts}
    with ScriptedServer([lambda body: Say(lines[Role(body["model"])].say(body))], models=tuple(Role)) as server:
        choices = {
            role: ModelChoice(profile="openai-compatible", model=role.value, base_url=server.url, price=None) for role in Role
        }
        with ModelDesk(choices, memory=ModeMemory(tmp_path / "modes.json")) as desk:
            models = desk.for_episode(said.emit)
            planner = ModelPlanner(models[Role.PLANNER], PlannerPrompt(PROMPTS, world.spec))
            executor = ModelExecutor(models[Role.EXECUTOR], ExecutorPrompt(PROMPTS, world.spec))
            minds = FreshPlanner(RulePlanner(), planner, plans), FreshExecutor(RuleExecutor(), executor, acts)
            result = drive(*minds, world, said, task)
    world.close()

    assert [event.action for event in kept(said, StepTaken)] == [event.action for event in kept(alone, StepTaken)]
    assert [event.subtask for event in kept(said, SubtaskIssued)] == [event.subtask for event in kept(alone, SubtaskIssued)]
    assert (result.status, result.stop_reason, result.pose) == (expected.status, expected.stop_reason, expected.pose)
    assert [event.kind for event in kept(said, ReplyRefused)] == [event.kind for event in kept(alone, ReplyRefused)]
    called = kept(said, ModelCalled)
    assert len(called) >= len(kept(said, SubtaskIssued)) + len(kept(said, DecisionMade))
    assert all(len(event.request.images) == (13 if event.request.role is Role.PLANNER else 1) for event in called)
