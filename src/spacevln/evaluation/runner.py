"""Runs the episodes of a suite in workers, survives their death, and resumes (DESIGN 5.8).

An episode whose worker dies has no result yet: it restarts from its start on a fresh worker, and a second death makes it an
environment failure. An episode that was interrupted, because the runner was stopped or killed, restarts as well. What has a
result is never run again. A directory holds one suite with one configuration.
"""

from __future__ import annotations

import fcntl
import json
import platform
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from spacevln.assembly import Configuration
from spacevln.core import Detector, EpisodeStatus, RecordError, UsageError
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.datasets import EpisodeSequence, Selection
from spacevln.evaluation.journal import Journal, held, note
from spacevln.evaluation.pool import Attempt, Outcome, Pool, Queue, WatchedPool, Workplace
from spacevln.evaluation.processes import Processes
from spacevln.evaluation.score import environment_failure
from spacevln.evaluation.summary import summarise
from spacevln.models import UNLIMITED, RunAccess
from spacevln.recording import (
    RecordLevel,
    ResultFile,
    RunFile,
    SummaryFile,
    episode_directory,
    read_file,
    read_result,
    write_file,
)

MAX_DEATHS = 1
"""Deaths of a worker inside one episode that are forgiven."""


@dataclass(frozen=True, slots=True)
class Job:
    """What a worker needs to know, as plain text across the process boundary."""

    selection: Selection
    configuration: Configuration
    directory: Path
    level: RecordLevel
    access: RunAccess = UNLIMITED
    chase: bool = False

    def to_json(self) -> str:
        """Encode."""
        return json.dumps(
            {
                "selection": self.selection.model_dump(mode="json"),
                "configuration": self.configuration.model_dump(mode="json"),
                "directory": str(self.directory),
                "level": self.level.value,
                "access": self.access.to_json(),
                "chase": self.chase,
            }
        )

    @classmethod
    def from_json(cls, text: str) -> Job:
        """Decode."""
        data = json.loads(text)
        return cls(
            selection=Selection.model_validate(data["selection"]),
            configuration=Configuration.model_validate(data["configuration"]),
            directory=Path(data["directory"]),
            level=RecordLevel(data["level"]),
            access=RunAccess.from_json(data["access"]),
            chase=data["chase"],
        )


def claim_directory(directory: Path, run: RunFile) -> None:
    """Write ``run.json``, or check that the directory belongs to the same suite and configuration.

    Raises:
        UsageError: it holds another run: configurations are never mixed.
        RecordError: it cannot be written.
    """
    path = directory / "run.json"
    write_file(path, run, first_stands=True)
    before = read_file(path, RunFile)
    if (before.suite, before.configuration_hash) != (run.suite, run.configuration_hash):
        raise UsageError(
            f"{str(directory)!r} holds a run of {before.suite} with configuration {before.configuration_hash}, "
            f"this is {run.suite} with {run.configuration_hash}: give another --out."
        )
    if before.dataset != run.dataset:
        raise UsageError(
            f"{str(directory)!r} holds a run of {before.suite} on data files that have changed since: give another --out."
        )


def finished(directory: Path, episode_id: str) -> ResultFile | None:
    """The standing result of an episode; an interrupted attempt is none, and its file is removed."""
    folder = episode_directory(directory, episode_id)
    result = read_result(folder)
    if result is not None and result.status is EpisodeStatus.INTERRUPTED:
        (folder / "result.json").unlink(missing_ok=True)
        return None
    return result


def bench(
    job: Job,
    workers: int,
    on_result: Callable[[ResultFile], None],
    *,
    deadline_s: float | None = None,
    workplace: Workplace | None = None,
) -> SummaryFile:
    """Run every episode that has no result, then write ``summary.json``.

    Args:
        job: what to run and where.
        workers: how many.
        on_result: called for every result, those of an earlier call included.
        deadline_s: per episode; a worker that takes longer is killed, which counts as its death.
        workplace: where they live instead of in processes of this machine.

    Returns:
        The summary of all results in the directory, those of other shards included.

    Raises:
        KeyboardInterrupt: after the workers were told to end; the directory can be resumed.
        RecordError: the disk refuses; the directory can be resumed.
        UsageError: another runner works on the same episodes.
    """
    episodes = job.selection.load()
    pool = WatchedPool(workplace or Processes(), open_session, job.to_json(), workers, deadline_s)
    shard = "" if job.selection.shard is None else f"-{job.selection.shard[0]}-of-{job.selection.shard[1]}"
    with alone(job.directory, shard):
        run_episodes(episodes, job.directory, pool, on_result)
    everything = job.selection.whole() if shard else episodes
    return write_summary(everything, job.directory)


def write_summary(episodes: EpisodeSequence, directory: Path) -> SummaryFile:
    """Write ``summary.json`` over the results that are there, in the order of the suite."""
    results = [result for name in episodes.ids if (result := finished(directory, name)) is not None]
    summary = summarise(results)
    write_file(directory / "summary.json", summary)
    return summary


def run_episodes(episodes: EpisodeSequence, directory: Path, pool: Pool, on_result: Callable[[ResultFile], None]) -> None:
    """Give every episode its one result.

    Args:
        episodes: which.
        directory: of the run.
        pool: runs them.
        on_result: called for every result, those that were there included.
    """
    waiting: list[tuple[str, str]] = []
    for name, scene in zip(episodes.ids, episodes.scenes, strict=True):
        result = finished(directory, name)
        if result is None:
            waiting.append((name, scene))
        else:
            on_result(result)
    if not waiting:
        return
    queue = Queue(waiting)

    def begin(name: str) -> int:
        folder = episode_directory(directory, name)
        before = Journal.read(folder).starts
        note(folder, "started")
        return before

    for outcome in pool.outcomes(queue, begin):
        result = _settle(outcome, episodes, directory)
        if result is None:
            queue.again(outcome.episode_id)
        else:
            on_result(result)


def _settle(outcome: Outcome, episodes: EpisodeSequence, directory: Path) -> ResultFile | None:
    """The result of an attempt; None when the episode is to restart."""
    name, folder = outcome.episode_id, episode_directory(directory, outcome.episode_id)
    result = finished(directory, name)
    if result is not None:  # a worker may die between writing the result and saying so
        return result
    note(folder, "died", outcome.death or "it came back without a result")
    journal = Journal.read(folder)
    if journal.deaths <= MAX_DEATHS:
        return None
    failure = environment_failure(
        episodes.by_id(name),
        f"its worker died {journal.deaths} times, last: {journal.last_death}",
        restarts=journal.starts - 1,
    )
    write_file(folder / "result.json", failure, first_stands=True)
    return failure


@contextmanager
def alone(directory: Path, shard: str = "") -> Iterator[None]:
    """Be the only runner of a directory, or of one shard of it.

    Raises:
        UsageError: another one is at work.
        RecordError: the disk refuses.
    """
    path = directory / f".runner{shard}.lock"
    try:
        file = path.open("ab")
    except OSError as error:
        raise RecordError(f"Cannot write {str(path)!r} ({error.strerror}): give a writable --out.") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise UsageError(
                f"Another run is at work in {str(directory)!r}: wait for it, end it, or give another --out or --shard."
            ) from error
        yield


@contextmanager
def open_session(job_text: str, detector: Detector | None = None, /) -> Iterator[Attempt]:
    """A worker's environment (an :class:`~.pool.Opener`)."""
    job = Job.from_json(job_text)
    if not (job.directory / "run.json").exists():
        raise UsageError(
            f"{platform.node()!r} does not see the run in {str(job.directory)!r}: give an --out that all machines share."
        )
    episodes = job.selection.load()
    with Session(job.configuration, access=job.access, detector=detector) as session:

        def attempt(episode_id: str, before: int) -> None:
            folder = episode_directory(job.directory, episode_id)
            with held(folder):
                if read_result(folder) is not None:
                    return
                result = session.attempt(episodes.by_id(episode_id), folder, level=job.level, chase=job.chase, restarts=before)
            if result.status is EpisodeStatus.INTERRUPTED:
                raise KeyboardInterrupt

        yield attempt
