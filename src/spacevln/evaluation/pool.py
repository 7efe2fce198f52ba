"""Worker processes that attempt episodes: one environment each, watched, replaced when they die or take too long."""

from __future__ import annotations

import json
import multiprocessing
import os
import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Protocol

from spacevln.core import EnvironmentFailure, PrerequisiteError, RecordError, SpaceVLNError, SpendingLimit, UsageError

POLL_S = 0.5
END_S = 5.0
"""How long workers may take to end by themselves."""

MAX_FALSE_STARTS = 10
"""Workers in a row that may die before they are ready."""

Attempt = Callable[[str, int], None]
"""Attempts an episode, given its id and how often it was begun before; the result is on the disk when it returns."""

Opener = Callable[[str], AbstractContextManager[Attempt]]
"""Opens a worker's environment from a job in JSON; a function of a module, because other processes find it by its name."""

CARRIED: dict[str, type[SpaceVLNError]] = {
    error.__name__: error for error in (UsageError, PrerequisiteError, RecordError, SpendingLimit)
}
"""Errors of a worker that end the whole run with their sentence."""


class Queue:
    """Episodes that wait, handed out so that a worker stays in a building.

    Args:
        episodes: (id, building) in order.
    """

    def __init__(self, episodes: Sequence[tuple[str, str]]) -> None:
        self._scene_of = dict(episodes)
        self._waiting: OrderedDict[str, deque[str]] = OrderedDict()
        for name, scene in episodes:
            self._waiting.setdefault(scene, deque()).append(name)

    def __len__(self) -> int:
        return sum(map(len, self._waiting.values()))

    def take(self, scene: str | None = None, taken: Sequence[str | None] = ()) -> str:
        """The next episode: of the same building, else of one where no other worker is, else the first."""
        if scene not in self._waiting:
            scene = next((each for each in self._waiting if each not in taken), next(iter(self._waiting)))
        assert scene is not None  # noqa: S101 - a key of the table
        group = self._waiting[scene]
        name = group.popleft()
        if not group:
            del self._waiting[scene]
        return name

    def again(self, name: str) -> None:
        """Put an episode back, to come next."""
        scene = self._scene_of[name]
        self._waiting.setdefault(scene, deque()).appendleft(name)
        self._waiting.move_to_end(scene, last=False)

    def scene_of(self, name: str) -> str:
        """The building of an episode."""
        return self._scene_of[name]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an attempt.

    Args:
        episode_id: of what.
        death: how the worker died in it; None when it came back.
    """

    episode_id: str
    death: str | None = None


class Pool(Protocol):
    """Attempts episodes somewhere."""

    def outcomes(self, queue: Queue, begin: Callable[[str], int]) -> Iterator[Outcome]:
        """Attempt everything in the queue, what is put back while this runs included.

        Args:
            queue: what waits.
            begin: called right before an episode is handed out; says how often it was begun before.

        Raises:
            SpaceVLNError: a worker met an error that concerns the whole run.
        """


@dataclass(slots=True)
class _Worker:
    process: BaseProcess
    connection: Connection
    ready: bool = False
    episode_id: str | None = None
    scene: str | None = None
    begun_s: float = 0.0


@dataclass(slots=True)
class ProcessPool:
    """Workers on this machine.

    Args:
        opener, job: what each of them opens.
        size: how many.
        deadline_s: a worker that takes longer for one episode is killed, which counts as its death; None waits for ever.
    """

    opener: Opener
    job: str
    size: int
    deadline_s: float | None = None
    _false_starts: int = field(default=0, init=False)

    def outcomes(self, queue: Queue, begin: Callable[[str], int]) -> Iterator[Outcome]:
        """See :class:`Pool`."""
        workers = [self._start() for _ in range(min(self.size, len(queue)))]
        try:
            while queue or any(worker.episode_id is not None for worker in workers):
                for worker in workers:
                    if worker.ready and worker.episode_id is None and queue:
                        self._assign(worker, queue, [other.scene for other in workers], begin)
                wait([worker.connection for worker in workers], timeout=POLL_S)
                for index, worker in enumerate(workers):
                    outcome = self._collect(worker)
                    if outcome is not None:
                        yield outcome
                    if not worker.process.is_alive() and worker.episode_id is None:
                        workers[index] = self._replace(worker)
        finally:
            _end(workers)

    def _start(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=work, args=(theirs, self.opener, self.job), daemon=True)
        process.start()
        theirs.close()
        return _Worker(process, ours)

    def _replace(self, worker: _Worker) -> _Worker:
        worker.connection.close()
        self._false_starts += not worker.ready
        if self._false_starts == MAX_FALSE_STARTS:
            raise EnvironmentFailure(
                f"{MAX_FALSE_STARTS} workers in a row died before they were ready, the last with exit code "
                f"{worker.process.exitcode}: run with --workers 1 and `spacevln doctor`."
            )
        return self._start()

    def _assign(self, worker: _Worker, queue: Queue, taken: Sequence[str | None], begin: Callable[[str], int]) -> None:
        worker.episode_id = queue.take(worker.scene, taken)
        worker.scene = queue.scene_of(worker.episode_id)
        worker.begun_s = time.monotonic()
        try:
            worker.connection.send_bytes(json.dumps([worker.episode_id, begin(worker.episode_id)]).encode())
        except OSError:  # the process died while it waited; _collect sees that
            return

    def _collect(self, worker: _Worker) -> Outcome | None:
        try:
            if worker.connection.poll():
                return self._heard(worker, json.loads(worker.connection.recv_bytes()))
        except (EOFError, OSError):
            worker.process.join()
            return self._lost(worker, f"exit code {worker.process.exitcode}")
        late = self.deadline_s is not None and time.monotonic() - worker.begun_s > self.deadline_s
        if worker.episode_id is not None and late:
            worker.process.kill()
            worker.process.join()
            return self._lost(worker, f"it took longer than {self.deadline_s:g} s")
        return None

    def _heard(self, worker: _Worker, message: dict[str, str]) -> Outcome | None:
        if "error" in message:
            raise CARRIED[message["error"]](message["sentence"])
        worker.ready = True
        self._false_starts = 0
        if worker.episode_id is None:
            return None
        done = Outcome(worker.episode_id)
        worker.episode_id = None
        return done

    @staticmethod
    def _lost(worker: _Worker, how: str) -> Outcome | None:
        if worker.episode_id is None:
            return None
        outcome = Outcome(worker.episode_id, how)
        worker.episode_id = None
        return outcome


def _end(workers: Sequence[_Worker]) -> None:
    for worker in workers:
        worker.connection.close()
    deadline = time.monotonic() + END_S
    for worker in workers:
        worker.process.join(timeout=max(0.0, deadline - time.monotonic()))
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()


def work(connection: Connection, opener: Opener, job: str) -> None:
    """Body of a worker process: one environment, one episode at a time, until the runner hangs up or is gone."""
    threading.Thread(target=_die_with_parent, daemon=True).start()
    try:
        try:
            with opener(job) as attempt:
                connection.send_bytes(json.dumps({"ready": ""}).encode())
                while True:
                    episode_id, before = json.loads(connection.recv_bytes())
                    attempt(episode_id, before)
                    connection.send_bytes(json.dumps({"done": episode_id}).encode())
        except tuple(CARRIED.values()) as error:
            name = next(name for name, kind in CARRIED.items() if isinstance(error, kind))
            connection.send_bytes(json.dumps({"error": name, "sentence": str(error)}).encode())
    except (EOFError, BrokenPipeError, KeyboardInterrupt):  # the runner hung up, or the terminal's Ctrl-C reached us as well
        return


def _die_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)  # the runner was killed: what we would write, its successor writes
