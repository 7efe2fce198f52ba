"""The composition root: from a configuration to a wired agent."""

from __future__ import annotations

from collections.abc import Sequence

from spacevln.agent import AgentSettings, Components, NavigationAgent
from spacevln.assembly.configuration import Configuration
from spacevln.core import Environment, EventSink
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.perception import LabelDetector
from spacevln.reasoning.rules import RuleExecutor, RulePlanner


def build_environment(configuration: Configuration) -> Environment:
    """The world of a run.

    Raises:
        PrerequisiteError: the renderer asked for cannot be used here.
    """
    settings = configuration.environment
    return HousesEnvironment(sliding=settings.sliding, renderer=settings.renderer)


def build_agent(configuration: Configuration, environment: Environment, sinks: Sequence[EventSink] = ()) -> NavigationAgent:
    """The agent of a run: detector, planner, executor, components, listeners."""
    detector = LabelDetector(**configuration.detector.model_dump())
    settings = AgentSettings(
        components=Components(**configuration.components.model_dump()),
        step_limit=configuration.step_budget,
    )
    return NavigationAgent(environment, detector, RulePlanner(), RuleExecutor(), settings, sinks)
