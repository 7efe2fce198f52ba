"""Workers as actors of a Ray cluster, for runs beyond one machine (``--ray``); detectors may be actors that workers share.

Nodes may die: a worker on one is lost as a killed process is (:mod:`.pool`), and its successor starts on a node that lives. What
an attempt writes lies where the run directory lies, so all nodes see it, under the same path.
"""

from __future__ import annotations

import importlib
import logging
import os
import platform
import socket
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spacevln import __version__
from spacevln.assembly import Configuration
from spacevln.core import PrerequisiteError
from spacevln.evaluation.pool import CARRIED, END_S, Message, Opener, WorkerLost
from spacevln.evaluation.shared_detector import DetectorActor, SharedDetector

if TYPE_CHECKING:
    import ray

ANSWER_S = 10.0
"""How long a cluster's head may take to answer."""


@dataclass(slots=True)
class RayWorker:
    """A :class:`~.pool.Worker`."""

    actor: Any
    answer: ray.ObjectRef | None

    def hand_out(self, episode_id: str, before: int) -> None:
        """See :class:`~.pool.Worker`."""
        self.answer = self.actor.attempt.remote(episode_id, before)

    def heard(self) -> Message | None:
        """See :class:`~.pool.Worker`."""
        import ray

        if self.answer is None or not ray.wait([self.answer], timeout=0)[0]:
            return None
        answer, self.answer = self.answer, None
        try:
            return Message(**ray.get(answer))
        except ray.exceptions.RayError as error:
            self.kill()
            raise WorkerLost(_briefly(error)) from error

    def kill(self) -> None:
        """See :class:`~.pool.Worker`."""
        import ray

        ray.kill(self.actor)


@dataclass(slots=True)
class RayCluster:
    """A :class:`~.pool.Workplace`: one CPU for each worker, wherever one is free.

    Args:
        address: of the cluster's head, ``"auto"`` for the one of this machine, ``"local"`` for a new one that ends with the run.
        configuration: names the detector that is shared.
        detectors: how many actors detect for all workers, each with its share of the GPUs; 0 = every worker has its own.
    """

    address: str
    configuration: Configuration
    detectors: int = 0
    _shared: list[Any] = field(default_factory=list, init=False)
    _started: int = field(default=0, init=False)
    _connected: bool = field(default=False, init=False)

    def start(self, opener: Opener, job: str) -> RayWorker:
        """See :class:`~.pool.Workplace`.

        Raises:
            PrerequisiteError: Ray is not installed, or there is no cluster at the address.
        """
        import ray

        if not self._connected:
            self._connect()
        shared = self._shared[self._started % self.detectors] if self.detectors else None
        self._started += 1
        actor = ray.remote(_WorkerActor).options(num_cpus=1, max_restarts=0).remote()
        name = f"{opener.__module__}:{opener.__qualname__}"  # type: ignore[attr-defined]  # a function has one
        return RayWorker(actor, actor.open.remote(name, job, __version__, str(Path.cwd()), shared))

    def wait(self, workers: Sequence[RayWorker], timeout_s: float) -> None:
        """See :class:`~.pool.Workplace`."""
        import ray

        ray.wait([worker.answer for worker in workers if worker.answer is not None], timeout=timeout_s)

    def end(self, workers: Sequence[RayWorker]) -> None:
        """See :class:`~.pool.Workplace`."""
        import ray

        if not self._connected:
            return
        closing = [worker.actor.close.remote() for worker in workers]
        if closing:
            ray.wait(closing, num_returns=len(closing), timeout=END_S)
        for actor in (*(worker.actor for worker in workers), *self._shared):
            ray.kill(actor)
        self._shared.clear()
        self._connected = False
        ray.shutdown()

    def _connect(self) -> None:
        import ray

        try:
            if self.address not in ("auto", "local"):
                _refuse_silence(self.address)
            ray.init(
                self.address,
                log_to_driver=False,
                logging_level=logging.WARNING,
                include_dashboard=False if self.address == "local" else None,
            )
        except (OSError, ValueError) as error:  # Ray's are a ConnectionError, which is an OSError, and a ValueError
            raise PrerequisiteError(
                f"There is no Ray cluster at --ray {self.address!r}: give HOST:PORT of its head, 'auto' for the one of this "
                "machine (`ray start --head`), or 'local' for a new one."
            ) from error
        self._connected = True
        if self.detectors:
            gpus = min(1.0, ray.cluster_resources().get("GPU", 0.0) / self.detectors)
            options = {"num_cpus": 0, "num_gpus": gpus, "max_restarts": -1, "max_task_retries": -1, "max_concurrency": 1000}
            actor = ray.remote(DetectorActor).options(**options)
            self._shared += [actor.remote(self.configuration.model_dump_json()) for _ in range(self.detectors)]


def require_ray() -> None:
    """Check that Ray is there.

    Raises:
        PrerequisiteError: it is not.
    """
    try:
        import ray  # noqa: F401 - only whether it is there
    except ImportError as error:
        raise PrerequisiteError("Running on a cluster needs Ray: pip install 'spacevln[ray]' on all of its machines.") from error


class _WorkerActor:
    """Body of a worker on a node."""

    def __init__(self) -> None:
        self._stack = ExitStack()

    def open(self, opener: str, job: str, version: str, directory: str, shared: Any) -> dict[str, str]:
        """Open the environment; answers with a :class:`Message`."""
        try:
            _check_node(version, directory)
            module, _, name = opener.partition(":")
            open_attempts: Opener = getattr(importlib.import_module(module), name)
            detector = None if shared is None else SharedDetector(shared)
            self._attempt = self._stack.enter_context(open_attempts(job, detector))
        except tuple(CARRIED.values()) as error:
            return asdict(Message.of(error))
        return asdict(Message("ready"))

    def attempt(self, episode_id: str, before: int) -> dict[str, str]:
        """Attempt an episode; answers with a :class:`Message`."""
        try:
            self._attempt(episode_id, before)
        except tuple(CARRIED.values()) as error:
            return asdict(Message.of(error))
        return asdict(Message("done"))

    def close(self) -> None:
        """Close the environment."""
        self._stack.close()


def _check_node(version: str, directory: str) -> None:
    """See that this node is like the runner's."""
    here = platform.node()
    if version != __version__:
        raise PrerequisiteError(f"Node {here!r} has spacevln {__version__}, the runner {version}: install the same everywhere.")
    if not Path(directory).is_dir():
        raise PrerequisiteError(f"Node {here!r} does not see {directory!r}: run from a directory that all nodes share.")
    os.chdir(directory)  # relative paths mean there what they mean here


def _briefly(error: Exception) -> str:
    """One line: the worker's own error where it had one, else the first that Ray says."""
    cause = getattr(error, "cause", None) or error
    lines = (line.strip() for line in str(cause).splitlines())
    return f"{type(cause).__name__}: {next((line for line in lines if line), 'no message')}"


def _refuse_silence(address: str) -> None:
    """See that somebody answers at HOST:PORT, because Ray itself would try for minutes.

    Raises:
        OSError: nobody does.
        ValueError: it is no HOST:PORT.
    """
    host, _, port = address.rpartition(":")
    socket.create_connection((host, int(port)), timeout=ANSWER_S).close()
