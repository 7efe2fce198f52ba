"""The composition root: from a configuration to a wired agent."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

from spacevln.agent import AgentSettings, Components, NavigationAgent
from spacevln.assembly.attentive import Attention, AttentiveExecutor, AttentivePlanner
from spacevln.assembly.configuration import (
    Configuration,
    GNBenchSettings,
    HabitatSettings,
    HousesSettings,
    OpenVocabularySettings,
)
from spacevln.control import ControlSettings
from spacevln.core import (
    ChatModel,
    Detector,
    Environment,
    EnvironmentSpec,
    EventSink,
    Executor,
    Planner,
    PrerequisiteError,
    Role,
    UsageError,
)
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.robot.environment import RobotEnvironment
from spacevln.perception import LabelDetector
from spacevln.perception.open_vocabulary.opening import open_from
from spacevln.perception.serving import SharedDetector
from spacevln.reasoning.rules import Gait, RuleExecutor, RulePlanner
from spacevln.reasoning.spatial_cot import ExecutorPrompt, ModelExecutor, ModelPlanner, PlannerPrompt, PromptSettings

OPENER = "spacevln.perception.open_vocabulary.opening:open_from"
"""What a detector server opens."""


def build_environment(configuration: Configuration) -> Environment:
    """The world of a run.

    Raises:
        PrerequisiteError: the renderer asked for, or the bridge to a simulator, cannot be used here.
    """
    settings = configuration.environment
    if isinstance(settings, HousesSettings):
        return HousesEnvironment(sliding=settings.sliding, renderer=settings.renderer)
    return _bridged(settings)


def _bridged(settings: HabitatSettings | GNBenchSettings) -> Environment:
    if importlib.util.find_spec("spacevln_bridge") is None or importlib.util.find_spec("msgpack") is None:
        raise PrerequisiteError("This simulator is reached over a bridge: install it with `pip install 'spacevln[habitat]'`.")
    values = settings.model_dump(exclude={"simulator", "preset"})
    if isinstance(settings, GNBenchSettings):
        from spacevln.environments.gn_bench.environment import GNBenchEnvironment
        from spacevln.environments.gn_bench.setup import GNBenchSetup

        return GNBenchEnvironment(GNBenchSetup(**values))
    from spacevln.environments.habitat.environment import HabitatEnvironment
    from spacevln.environments.habitat.setup import HabitatSetup

    return HabitatEnvironment(HabitatSetup(**values))


def check_settings(configuration: Configuration, spec: EnvironmentSpec) -> None:
    """What only the body can tell of a configuration, asked before an episode begins.

    Raises:
        UsageError: the number of views does not divide this body's look-around.
    """
    if "vlm" in (configuration.planner, configuration.executor):
        PlannerPrompt(prompt_settings(configuration), spec)


def build_detector(configuration: Configuration) -> Detector:
    """What grounds landmarks; models are opened once in a process and shared by its episodes.

    Raises:
        PrerequisiteError: a detector's library or weights are missing.
        UsageError: its weights are damaged, or it cannot run so here.
    """
    settings = configuration.detector
    return _open_vocabulary(settings) if isinstance(settings, OpenVocabularySettings) else LabelDetector(**settings.model_dump())


@lru_cache(maxsize=1)
def _open_vocabulary(settings: OpenVocabularySettings) -> Detector:
    values = settings.model_dump(exclude={"shared"})
    return SharedDetector(OPENER, values) if settings.shared else open_from(**values)


def build_agent(
    configuration: Configuration,
    environment: Environment,
    sinks: Sequence[EventSink] = (),
    models: Mapping[Role, ChatModel] | None = None,
    detector: Detector | None = None,
) -> NavigationAgent:
    """The agent of a run: detector, planner, executor, components, listeners.

    Args:
        configuration: of the run.
        environment: that it drives.
        sinks: listeners.
        models: chat models by role, for a planner or executor that asks one.
        detector: used instead of a new one of the configuration's.

    Raises:
        UsageError: a model is needed and not given.
    """
    settings = AgentSettings(
        components=Components(**configuration.components.model_dump()),
        control=_control(environment.spec),
        step_limit=configuration.step_budget,
        glimpses=configuration.glimpses and configuration.planner == "rules",
        short_looks=configuration.short_looks,
        arrival_sightings=configuration.arrival_sightings,
    )
    planner = _planner(configuration, environment.spec, models or {})
    executor = _executor(configuration, environment.spec, models or {})
    if isinstance(environment, RobotEnvironment):
        attention = Attention(environment.live)
        planner = planner if isinstance(planner, RulePlanner) else AttentivePlanner(planner, attention)
        proceed = environment.proceed if environment.goes_on_while_thinking else None
        executor = executor if isinstance(executor, RuleExecutor) else AttentiveExecutor(executor, attention, proceed)
    return NavigationAgent(environment, detector or build_detector(configuration), planner, executor, settings, sinks)


def _control(spec: EnvironmentSpec) -> ControlSettings:
    """The thresholds for this body: a wider one stands off from obstacles by as much more."""
    usual = ControlSettings()
    return replace(usual, stand_off_m=usual.stand_off_m + Gait.of(spec).wider_m)


def _planner(configuration: Configuration, spec: EnvironmentSpec, models: Mapping[Role, ChatModel]) -> Planner:
    if configuration.planner == "rules":
        return RulePlanner()
    return ModelPlanner(_model(models, Role.PLANNER), PlannerPrompt(prompt_settings(configuration), spec))


def _executor(configuration: Configuration, spec: EnvironmentSpec, models: Mapping[Role, ChatModel]) -> Executor:
    if configuration.executor == "rules":
        return RuleExecutor(Gait.of(spec))
    return ModelExecutor(_model(models, Role.EXECUTOR), ExecutorPrompt(prompt_settings(configuration), spec))


def prompt_settings(configuration: Configuration) -> PromptSettings:
    """What models are shown in this run."""
    return PromptSettings(**configuration.components.model_dump(), **configuration.prompts.model_dump())


def _model(models: Mapping[Role, ChatModel], role: Role) -> ChatModel:
    if role not in models:
        raise UsageError(f"A model-written {role} needs a chat model: give --model.")
    return models[role]
