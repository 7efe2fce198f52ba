"""One attempt at one episode: build the agent, record, run, judge. The episode boundary for every error."""

from __future__ import annotations

import traceback
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType

from spacevln.assembly import Configuration, build_agent, build_environment
from spacevln.core import EventSink, RecordError, UsageError
from spacevln.evaluation.baselines import ForwardWalker, OracleWalker, RandomWalker, walk
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.score import environment_failure, score
from spacevln.recording import EpisodeRecorder, RecordLevel, ResultFile, write_file
from spacevln.viewer import draw_topdown


class Session(AbstractContextManager["Session"]):
    """An environment that is reused over episodes, and the configuration of the agents that run in it."""

    def __init__(self, configuration: Configuration) -> None:
        self._configuration = configuration
        self._environment = build_environment(configuration)

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._environment.close()

    def attempt(
        self,
        episode: Episode,
        directory: Path,
        *,
        level: RecordLevel = RecordLevel.FULL,
        restarts: int = 0,
        sinks: Sequence[EventSink] = (),
    ) -> ResultFile:
        """Run an episode once and write its record and result.

        Args:
            episode: what to run; only its ``spec`` reaches the agent.
            directory: of its record.
            level: of detail.
            restarts: how often a worker died in it before.
            sinks: further listeners.

        Returns:
            The result. An unexpected error of the program is recorded as ``crash.txt`` and counted as an environment failure.

        Raises:
            RecordError: the record cannot be written; the run stops and can be resumed.
        """
        recorder = EpisodeRecorder(directory, level)
        try:
            self._drive(episode, (recorder, *sinks))
            result = score(episode, directory, restarts=restarts)
        except RecordError:
            raise
        except Exception as error:  # noqa: BLE001 - the episode boundary: a bug must not take the other episodes along
            (directory / "crash.txt").write_text(traceback.format_exc(), encoding="utf-8")
            result = environment_failure(episode, f"internal error: {type(error).__name__}: {error}", restarts=restarts)
        finally:
            recorder.close()
        write_file(directory / "result.json", result, first_stands=True)
        if level is RecordLevel.FULL and self._configuration.driver == "agent" and not (directory / "crash.txt").exists():
            draw_topdown(directory)
        return result

    def _drive(self, episode: Episode, sinks: Sequence[EventSink]) -> None:
        """Run the agent, which gets the ``spec`` and nothing else, or a baseline."""
        match self._configuration.driver:
            case "agent":
                build_agent(self._configuration, self._environment, sinks).run(episode.spec)
            case "random":
                walk(RandomWalker(episode.episode_id.encode()), episode, self._environment, sinks)
            case "forward":
                walk(ForwardWalker(), episode, self._environment, sinks)
            case "oracle":
                if episode.truth is None:
                    raise UsageError(f"{episode.episode_id!r} has no truth that an oracle could follow: use a suite's episode.")
                walk(OracleWalker(episode.truth), episode, self._environment, sinks)
