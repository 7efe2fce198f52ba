"""Spatial-CoT without its model. Medians on one idle thread must be under: planner request 120 ms, executor request 15 ms, parse
and validate 2 ms.

Run with ``pytest benchmarks/test_prompting.py --benchmark-only``; add ``--benchmark-timer=time.process_time`` on a busy machine.
A planner request is also timed with all that leads to it: memory text, map drawn, and the HTTP body with its pictures in Base64.
The views are of an embedded house, 640 x 480, with three marked things each; the map is what the agent has drawn there.
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from spacevln.agent import AgentSettings, EpisodeResult, NavigationAgent
from spacevln.control import ControlSettings, validate_subtask
from spacevln.core import ExecutorContext, ExecutorReply, PlannerContext, PlannerReply, ReplyMode
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.evaluation.houses import pick_episode
from spacevln.models import ModelChoice, profile
from spacevln.models.dialect import request_body
from spacevln.perception import LabelDetector
from spacevln.reasoning.rules import RuleExecutor, RulePlanner
from spacevln.reasoning.spatial_cot import ExecutorPrompt, Layout, PlannerPrompt, PromptSettings
from spacevln.testing.dictation import executor_words, planner_words

SHOWN_STAGE = 2
PLANNER_S, EXECUTOR_S, PARSE_S = 0.120, 0.015, 0.002


Situations = tuple["Witness", "ExecutorWitness", Any, EpisodeResult]
"""Of planner and executor, the body, and what the episode left behind."""


def median_s(benchmark: Any) -> float:
    return float(benchmark.stats.stats.median)


class Witness(RulePlanner):
    """Keeps the situations of the rules' episode."""

    def __init__(self) -> None:
        super().__init__()
        self.plans: list[tuple[PlannerContext, PlannerReply]] = []

    def plan(self, context: PlannerContext) -> PlannerReply:
        self.plans.append((context, super().plan(context)))
        return self.plans[-1][1]


class ExecutorWitness(RuleExecutor):
    def __init__(self) -> None:
        super().__init__()
        self.acts: list[tuple[ExecutorContext, ExecutorReply]] = []

    def act(self, context: ExecutorContext) -> ExecutorReply:
        self.acts.append((context, super().act(context)))
        return self.acts[-1][1]


@pytest.fixture(scope="module")
def situations() -> Situations:
    environment, planner, executor = HousesEnvironment(), Witness(), ExecutorWitness()
    agent = NavigationAgent(environment, LabelDetector(), planner, executor, AgentSettings(step_limit=90))
    result = agent.run(pick_episode("vln", 9).spec)
    environment.close()
    return planner, executor, environment.spec, result


@pytest.mark.parametrize("layout", list(Layout))
def test_planner_request(benchmark: Any, situations: Situations, layout: Layout) -> None:
    planner, _, spec, _ = situations
    context = planner.plans[SHOWN_STAGE][0]
    prompt = PlannerPrompt(PromptSettings(layout=layout), spec)
    request = benchmark(prompt.request, context)
    benchmark.extra_info["kib"] = sum(len(image.data) for image in request.images) // 1024
    assert len(request.images) == (2 if layout is Layout.MOSAIC else 13)
    assert median_s(benchmark) < PLANNER_S


def test_planner_request_from_memory_to_http_body(benchmark: Any, situations: Situations) -> None:
    planner, _, spec, result = situations
    context, prompt = planner.plans[SHOWN_STAGE][0], PlannerPrompt(PromptSettings(), spec)
    choice, known = ModelChoice(profile="dashscope", model="qwen3.5-plus"), profile("dashscope")

    def ask() -> bytes:
        told = result.memory.egocentric(result.pose, result.metric_map)
        request = prompt.request(replace(context, memory=told))
        return json.dumps(request_body(request, choice, known, ReplyMode.JSON_SCHEMA)).encode()

    benchmark.extra_info["kib"] = len(benchmark(ask)) // 1024
    assert median_s(benchmark) < PLANNER_S


def test_executor_request(benchmark: Any, situations: Situations) -> None:
    planner, executor, spec, _ = situations
    seen = planner.plans[SHOWN_STAGE][0].views[0].sightings[:3]
    context = replace(executor.acts[-1][0], sightings=seen)
    benchmark(ExecutorPrompt(PromptSettings(), spec).request, context)
    assert median_s(benchmark) < EXECUTOR_S


def test_planner_reply_parsed_and_validated(benchmark: Any, situations: Situations) -> None:
    planner, _, spec, _ = situations
    context, reply = planner.plans[SHOWN_STAGE]
    thought = replace(
        reply.thought, observation="In front there is a hallway with a rug. " * 20, decision="Front leads there. " * 20
    )
    text = json.dumps(planner_words(replace(reply, thought=thought)))
    prompt, settings = PlannerPrompt(PromptSettings(), spec), ControlSettings()

    def parse() -> int:
        return len(validate_subtask(prompt.parse(text, context), context, settings))

    assert benchmark(parse) == 0
    assert median_s(benchmark) < PARSE_S


def test_executor_reply_parsed(benchmark: Any, situations: Situations) -> None:
    _, executor, spec, _ = situations
    text = json.dumps(executor_words(executor.acts[0][1]))
    prompt = ExecutorPrompt(PromptSettings(turn_steps=6), spec)
    benchmark(prompt.parse, text)
    assert median_s(benchmark) < PARSE_S
