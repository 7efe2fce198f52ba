"""One attempt at one episode: build the agent, record, run, judge. The episode boundary for every error."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from spacevln.agent import EpisodeResult
from spacevln.assembly import Configuration, RegisteredEnvironment, build_agent, build_detector, build_environment, check_settings
from spacevln.core import (
    Detector,
    Environment,
    EnvironmentFailure,
    Event,
    EventSink,
    PrerequisiteError,
    RecordError,
    SpaceVLNError,
    SpendingLimit,
    StopReason,
    UsageError,
)
from spacevln.evaluation import resources
from spacevln.evaluation.baselines import BLIND_M, ForwardWalker, OracleWalker, RandomWalker, ReferenceWalker, Walker, walk
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.frontier import FrontierWalker
from spacevln.evaluation.score import environment_failure, score
from spacevln.evaluation.truth import MeasuredTruth, Surveyed
from spacevln.memory import BuildingMemory, SavedMemory, save_memory
from spacevln.models import ModelDesk, RunAccess
from spacevln.recording import EpisodeRecorder, RecordLevel, ResultFile, read_events, write_file
from spacevln.viewer import draw_topdown

MEMORY_FILE = "memory.npz"
"""The final memory in an episode's record."""


@runtime_checkable
class Filmed(Protocol):
    """An environment that can show its robot from outside."""

    def external_view(self) -> NDArray[np.uint8]:
        """The picture now, (H, W, 3)."""


class Session(AbstractContextManager["Session"]):
    """An environment that is reused over episodes, and the configuration of the agents that run in it.

    Args:
        configuration: of the run.
        environment, detector: used instead of those that the configuration names.
        access: what the run lets its models do.

    Raises:
        UsageError: the settings do not fit the environment.
    """

    def __init__(
        self,
        configuration: Configuration,
        environment: Environment | None = None,
        access: RunAccess | None = None,
        detector: Detector | None = None,
    ) -> None:
        self._configuration = configuration
        self._detector = detector or build_detector(configuration)
        self._environment = environment or build_environment(configuration)
        try:
            check_settings(configuration, self._environment.spec)
            self._desk = None if configuration.models is None else ModelDesk(configuration.models.choices, access)
        except SpaceVLNError:
            self._environment.close()
            raise

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._environment.close()
        if self._desk is not None:
            self._desk.close()

    def attempt(
        self,
        episode: Episode,
        directory: Path,
        *,
        level: RecordLevel = RecordLevel.FULL,
        chase: bool = False,
        restarts: int = 0,
        sinks: Sequence[EventSink] = (),
    ) -> ResultFile:
        """Run an episode once and write its record and result.

        Args:
            episode: what to run; only its ``spec`` reaches the agent.
            directory: of its record.
            level: of detail.
            chase: keep the pictures of a camera that follows the robot, too.
            restarts: how often it was begun before.
            sinks: further listeners.

        Returns:
            The result. An unexpected error of the program is recorded as ``crash.txt`` and counted as an environment failure.

        Raises:
            PrerequisiteError: a scene or the simulator is missing; the run stops.
            RecordError: the record cannot be written; the run stops and can be resumed.
            SpendingLimit: the run has spent what it may; the body was stopped, the episode has no result.
            UsageError: the memory to begin with is of another building, or cannot be read; or nothing here films the robot.
        """
        known, cpu_begin_s = self._known(episode), time.process_time()
        try:
            episode = self._measured(episode)
        except EnvironmentFailure as error:
            result = environment_failure(episode, f"before the start: {error}", restarts=restarts)
            write_file(directory / "result.json", result, first_stands=True)
            return result
        recorder = EpisodeRecorder(directory, level, self._external_view() if chase else None)
        try:
            left = self._drive(episode, known, (recorder, *sinks))
            if left is not None and left.stop_reason is StopReason.SPENDING:
                raise SpendingLimit(left.detail)
            lines = list(read_events(directory))
            result = score(episode, lines, restarts=restarts)
            write_file(directory / resources.NAME, resources.measure(lines, cpu_begin_s))
            if left is not None:
                result = result.model_copy(update=self._keep(left, episode, known, directory))
        except (RecordError, SpendingLimit, PrerequisiteError):
            raise
        except EnvironmentFailure as error:  # of a baseline; the agent's loop tells of it by itself
            result = environment_failure(episode, str(error), restarts=restarts)
        except Exception as error:  # noqa: BLE001 - the episode boundary: a bug must not take the other episodes along
            (directory / "crash.txt").write_text(traceback.format_exc(), encoding="utf-8")
            result = environment_failure(episode, f"internal error: {type(error).__name__}: {error}", restarts=restarts)
        finally:
            recorder.close()
        write_file(directory / "result.json", result, first_stands=True)
        if level is RecordLevel.FULL and self._configuration.driver == "agent" and not (directory / "crash.txt").exists():
            draw_topdown(directory)
        return result

    def _external_view(self) -> Callable[[], NDArray[np.uint8]]:
        """The camera that follows the robot."""
        if not isinstance(self._environment, Filmed):
            raise UsageError("--chase is asked for, and only the embedded houses can film the robot: leave --chase out.")
        return self._environment.external_view

    def _measured(self, episode: Episode) -> Episode:
        """The episode with the truth that the environment's simulator measures, where its file could only annotate."""
        if episode.truth is not None or episode.annotations is None or not isinstance(self._environment, Surveyed):
            return episode
        truth = MeasuredTruth(episode.annotations, self._environment.geodesics(episode.scene), episode.start)
        return replace(episode, truth=truth)

    def _known(self, episode: Episode) -> SavedMemory | None:
        """The memory of earlier episodes in this building, where the configuration names one."""
        setting = self._configuration.memory
        known = None if setting is None else setting.load()
        if known is not None and known.scene != episode.scene:
            raise UsageError(
                f"The memory is of {known.scene}, the episode is in {episode.scene}: give a memory of that building."
            )
        return known

    def _keep(self, left: EpisodeResult, episode: Episode, known: SavedMemory | None, directory: Path) -> dict[str, str | None]:
        """Save the final memory beside the record; what the result says of it."""
        T_scene_episode = episode.start if known is None else known.T_scene_episode
        building = BuildingMemory(left.metric_map, left.memory.hierarchical)
        try:
            save_memory(directory / MEMORY_FILE, SavedMemory(episode.scene, T_scene_episode, building))
        except OSError as error:
            raise RecordError(f"Cannot write {MEMORY_FILE} in {str(directory)!r} ({error.strerror}): free space.") from error
        setting = self._configuration.memory
        return {"memory": MEMORY_FILE, "loaded_memory": None if setting is None else setting.digest}

    def _drive(self, episode: Episode, known: SavedMemory | None, sinks: Sequence[EventSink]) -> EpisodeResult | None:
        """Run the agent, which gets the ``spec`` and nothing else, or a baseline, which leaves nothing."""
        match self._configuration.driver:
            case "agent":
                environment = self._environment if known is None else RegisteredEnvironment(self._environment, known)
                building = None if known is None else known.building
                models = None if self._desk is None else self._desk.for_episode(_teller(sinks))
                return build_agent(self._configuration, environment, sinks, models, self._detector).run(episode.spec, building)
            case "random":
                walker: Walker = RandomWalker(episode.episode_id.encode())
            case "forward":
                walker = ForwardWalker()
            case "frontier":
                walker = FrontierWalker(episode.spec.task, self._detector, BLIND_M)
            case "oracle":
                if episode.truth is None:
                    raise UsageError(f"{episode.episode_id!r} has no truth that an oracle could follow: use a suite's episode.")
                walker = OracleWalker(episode.truth, episode.start)
            case "reference":
                if not isinstance(episode.truth, MeasuredTruth):
                    raise UsageError(f"{episode.episode_id!r} has no recorded path to walk: use an episode of R2R-CE or RxR-CE.")
                walker = ReferenceWalker(episode.truth, episode.start)
        walk(walker, episode, self._environment, sinks, self._configuration.step_budget)
        return None


def _teller(sinks: Sequence[EventSink]) -> Callable[[Event], None]:
    """Tells every listener."""

    def tell(event: Event) -> None:
        for sink in sinks:
            sink.emit(event)

    return tell
