"""Runs the episodes of a suite in worker processes, survives their death, and resumes (DESIGN 5.8).

An episode whose worker dies has no result yet: it restarts from its start on a fresh worker, and a second death makes it an
environment failure. What has a result is never run again; an interrupted episode is no result.
"""

from __future__ import annotations

import json
import multiprocessing
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from spacevln.assembly import Configuration
from spacevln.core import EpisodeStatus, UsageError
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.datasets import Selection
from spacevln.evaluation.episode import Episode
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

POLL_S = 0.5


@dataclass(frozen=True, slots=True)
class Job:
    """What a worker needs to know, as plain text across the process boundary."""

    selection: Selection
    configuration: Configuration
    directory: Path
    level: RecordLevel
    access: RunAccess = UNLIMITED

    def to_json(self) -> str:
        """Encode."""
        return json.dumps(
            {
                "selection": self.selection.model_dump(mode="json"),
                "configuration": self.configuration.model_dump(mode="json"),
                "directory": str(self.directory),
                "level": self.level.value,
                "access": self.access.to_json(),
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
        )


def claim_directory(directory: Path, run: RunFile) -> None:
    """Write ``run.json``, or check that the directory belongs to the same suite and configuration.

    Raises:
        UsageError: it holds another run: configurations are never mixed.
        RecordError: it cannot be written.
    """
    path = directory / "run.json"
    if not path.exists():
        write_file(path, run)
        return
    before = read_file(path, RunFile)
    if (before.suite, before.configuration_hash) != (run.suite, run.configuration_hash):
        raise UsageError(
            f"{str(directory)!r} holds a run of {before.suite} with configuration {before.configuration_hash}, "
            f"this is {run.suite} with {run.configuration_hash}: give another --out."
        )


def finished(directory: Path, episode_id: str) -> ResultFile | None:
    """The standing result of an episode; an interrupted attempt is none, and its file is removed."""
    folder = episode_directory(directory, episode_id)
    result = read_result(folder)
    if result is not None and result.status is EpisodeStatus.INTERRUPTED:
        (folder / "result.json").unlink()
        return None
    return result


def bench(job: Job, workers: int, on_result: Callable[[ResultFile], None]) -> SummaryFile:
    """Run every episode that has no result, then write ``summary.json``.

    Args:
        job: what to run and where.
        workers: number of processes.
        on_result: called for every result, those of an earlier call included.

    Returns:
        The summary of all results.

    Raises:
        KeyboardInterrupt: after the workers were told to end; the directory can be resumed.
    """
    episodes = job.selection.load()
    results: dict[str, ResultFile] = {}
    open_ids: list[str] = []
    for episode_id in episodes.ids:
        result = finished(job.directory, episode_id)
        if result is None:
            open_ids.append(episode_id)
        else:
            results[episode_id] = result
            on_result(result)
    if open_ids:
        pool = _Pool(job, min(workers, len(open_ids)), episodes.by_id)
        for result in pool.run(open_ids):
            results[result.episode_id] = result
            on_result(result)
    summary = summarise([results[episode_id] for episode_id in episodes.ids])
    write_file(job.directory / "summary.json", summary)
    return summary


@dataclass(slots=True)
class _Worker:
    process: BaseProcess
    connection: Connection
    episode_id: str | None = None


@dataclass(slots=True)
class _Pool:
    """Hands out episode ids one at a time, in order, and watches the processes."""

    job: Job
    size: int
    episode_of: Callable[[str], Episode]
    deaths: dict[str, int] = field(default_factory=dict)

    def run(self, episode_ids: Sequence[str]) -> Iterator[ResultFile]:
        """Yield results as they come."""
        waiting = deque(episode_ids)
        workers = [self._start() for _ in range(self.size)]
        try:
            open_count = len(waiting)
            while open_count:
                for worker in workers:
                    if worker.episode_id is None and waiting:
                        self._assign(worker, waiting.popleft())
                wait([worker.connection for worker in workers], timeout=POLL_S)
                for index, worker in enumerate(workers):
                    result = self._collect(worker, waiting)
                    if result is not None:
                        open_count -= 1
                        yield result
                    if not worker.process.is_alive() and waiting:
                        workers[index] = self._start()
        finally:
            _end(workers)

    def _start(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=worker_main, args=(theirs, self.job.to_json()), daemon=True)
        process.start()
        theirs.close()
        return _Worker(process, ours)

    def _assign(self, worker: _Worker, episode_id: str) -> None:
        worker.episode_id = episode_id
        try:
            worker.connection.send_bytes(json.dumps([episode_id, self.deaths.get(episode_id, 0)]).encode())
        except OSError:  # the process died before it got work; _collect sees that
            return

    def _collect(self, worker: _Worker, waiting: deque[str]) -> ResultFile | None:
        episode_id = worker.episode_id
        if episode_id is None:
            return None
        try:
            if not worker.connection.poll():
                return None
            worker.connection.recv_bytes()
        except (EOFError, OSError):
            worker.process.join()
            worker.episode_id = None
            return self._died(episode_id, worker.process.exitcode, waiting)
        worker.episode_id = None
        return finished(self.job.directory, episode_id)

    def _died(self, episode_id: str, exit_code: int | None, waiting: deque[str]) -> ResultFile | None:
        done = finished(self.job.directory, episode_id)
        if done is not None:  # it died between writing the result and saying so
            return done
        self.deaths[episode_id] = self.deaths.get(episode_id, 0) + 1
        if self.deaths[episode_id] <= MAX_DEATHS:
            waiting.appendleft(episode_id)
            return None
        episode = self.episode_of(episode_id)
        result = environment_failure(
            episode, f"its worker died twice, last with exit code {exit_code}", restarts=self.deaths[episode_id]
        )
        folder = episode_directory(self.job.directory, episode_id)
        folder.mkdir(parents=True, exist_ok=True)
        write_file(folder / "result.json", result, first_stands=True)
        return result


def _end(workers: Sequence[_Worker]) -> None:
    for worker in workers:
        worker.connection.close()
    for worker in workers:
        worker.process.join(timeout=2)
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()


def worker_main(connection: Connection, job_text: str) -> None:
    """Body of a worker process: one environment, one episode at a time, until the runner hangs up."""
    job = Job.from_json(job_text)
    episodes = job.selection.load()
    try:
        with Session(job.configuration, access=job.access) as session:
            while True:
                episode_id, restarts = json.loads(connection.recv_bytes())
                folder = episode_directory(job.directory, episode_id)
                result = session.attempt(episodes.by_id(episode_id), folder, level=job.level, restarts=restarts)
                if result.status is EpisodeStatus.INTERRUPTED:
                    return
                connection.send_bytes(b"done")
    except (EOFError, BrokenPipeError, KeyboardInterrupt):  # the runner hung up, or the terminal's Ctrl-C reached us as well
        return
