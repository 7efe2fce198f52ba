"""Workers as processes of this machine, spoken to in JSON over a pipe."""

from __future__ import annotations

import json
import multiprocessing
import os
import threading
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from spacevln.evaluation.pool import CARRIED, END_S, Message, Opener, WorkerLost


@dataclass(slots=True)
class ProcessWorker:
    """A :class:`~.pool.Worker`."""

    process: BaseProcess
    connection: Connection

    def hand_out(self, episode_id: str, before: int) -> None:
        """See :class:`~.pool.Worker`."""
        try:
            self.connection.send_bytes(json.dumps([episode_id, before]).encode())
        except OSError:  # the process died while it waited; heard() sees that
            return

    def heard(self) -> Message | None:
        """See :class:`~.pool.Worker`."""
        try:
            return Message(**json.loads(self.connection.recv_bytes())) if self.connection.poll() else None
        except (EOFError, OSError) as error:
            self.process.join(timeout=END_S)
            self.kill()
            raise WorkerLost(f"exit code {self.process.exitcode}") from error

    def kill(self) -> None:
        """See :class:`~.pool.Worker`."""
        self.connection.close()
        self.process.kill()
        self.process.join()


class Processes:
    """A :class:`~.pool.Workplace` on this machine."""

    def start(self, opener: Opener, job: str) -> ProcessWorker:
        """See :class:`~.pool.Workplace`."""
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=work, args=(theirs, opener, job), daemon=True)
        process.start()
        theirs.close()
        return ProcessWorker(process, ours)

    def wait(self, workers: Sequence[ProcessWorker], timeout_s: float) -> None:
        """See :class:`~.pool.Workplace`."""
        wait([worker.connection for worker in workers], timeout=timeout_s)

    def end(self, workers: Sequence[ProcessWorker]) -> None:
        """See :class:`~.pool.Workplace`."""
        for worker in workers:
            worker.connection.close()
        deadline = time.monotonic() + END_S
        for worker in workers:
            worker.process.join(timeout=max(0.0, deadline - time.monotonic()))
            worker.kill()


def work(connection: Connection, opener: Opener, job: str) -> None:
    """Body of a worker process: one environment, one episode at a time, until the runner hangs up or is gone."""
    threading.Thread(target=_die_with_parent, daemon=True).start()
    try:
        try:
            with opener(job) as attempt:
                _say(connection, Message("ready"))
                while True:
                    episode_id, before = json.loads(connection.recv_bytes())
                    attempt(episode_id, before)
                    _say(connection, Message("done"))
        except tuple(CARRIED.values()) as error:
            _say(connection, Message.of(error))
    except (EOFError, BrokenPipeError, KeyboardInterrupt):  # the runner hung up, or the terminal's Ctrl-C reached us as well
        return


def _say(connection: Connection, message: Message) -> None:
    connection.send_bytes(json.dumps(asdict(message)).encode())


def _die_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)  # the runner was killed: what we would write, its successor writes
