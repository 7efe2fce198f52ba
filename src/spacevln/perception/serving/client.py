"""A detector that lives in a server's process: starts the server when it is not there, and again when it died."""

from __future__ import annotations

import fcntl
import hashlib
import json
import mmap
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spacevln.core import Detection, EnvironmentFailure, Observation, PrerequisiteError, UsageError
from spacevln.perception.open_vocabulary.detector import Image
from spacevln.perception.serving.wire import receive, send, unpack

RETRIES = 2
"""How often a request is sent again when the server died under it."""

START_S = 300.0
"""How long a server may take to open its models."""

POLL_S = 0.05

_started: list[subprocess.Popen[bytes]] = []
"""Servers that this process started; they outlive their clients, and are reaped when another one is started."""


@dataclass(slots=True)
class ServerCounts:
    """What a client met."""

    requests: int = 0
    starts: int = 0
    retries: int = 0


class SharedDetector:
    """Implements :class:`spacevln.core.Detector` and ``ImageDetector`` by a server that every process of this user shares.

    Clients that ask for the same factory and settings find the same server. It has to be used from one thread.

    Args:
        factory: ``module:function`` that makes the detector in the server.
        settings: its keyword arguments; JSON values.
        folder: of the socket; by default one of this user's in the folder for temporary files.
    """

    def __init__(self, factory: str, settings: dict[str, Any], folder: Path | None = None) -> None:
        self._factory, self._settings = factory, json.dumps(settings, sort_keys=True)
        name = hashlib.sha256(f"{factory} {self._settings}".encode()).hexdigest()[:16]
        self._path = (folder or Path(tempfile.gettempdir()) / f"spacevln-{os.getuid()}") / f"{name}.socket"
        self._connection: socket.socket | None = None
        self._descriptor: int | None = None
        self._memory: mmap.mmap | None = None
        self.counts = ServerCounts()

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        """See :meth:`spacevln.core.Detector.detect`."""
        return self.detect_images([observation.rgb for observation in observations], queries)

    def detect_images(self, images: Sequence[Image], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        """Detections of any of the phrases, one tuple per image, in order.

        Raises:
            UsageError, PrerequisiteError: what the server's detector says.
            EnvironmentFailure: the server fails, or died under every retry.
        """
        if not images:
            return []
        self.counts.requests += 1
        for attempt in range(RETRIES + 1):
            try:
                return self._ask(images, phrases)
            except (ConnectionError, BrokenPipeError, TimeoutError):
                self._disconnect()
                self.counts.retries += attempt < RETRIES
        raise EnvironmentFailure(f"The detector server died {RETRIES + 1} times under one request: see {self._log}.")

    def close(self) -> None:
        """Let go of the server; it ends by itself. May be called twice."""
        self._disconnect()
        if self._memory is not None:
            self._memory.close()
            self._memory = None
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    @property
    def _log(self) -> Path:
        return self._path.with_suffix(".log")

    def _ask(self, images: Sequence[Image], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        grown = self._write(images)
        fresh = self._connection is None
        connection = self._connection or self._connect()
        number = self.counts.requests
        header = {"id": number, "phrases": list(phrases), "sizes": [image.shape[:2] for image in images]}
        send(connection, header, descriptor=self._descriptor if grown or fresh else None)
        reply, bits, _ = receive(connection)
        if reply["id"] != number:
            raise ConnectionError("the answer belongs to another request")
        if "error" in reply:
            kinds = {"usage": UsageError, "prerequisite": PrerequisiteError}
            raise kinds.get(reply["error"], EnvironmentFailure)(reply["message"])
        return unpack(reply["found"], bits)

    def _write(self, images: Sequence[Image]) -> bool:
        """Put the images into the shared memory; whether it is a new one."""
        needed = sum(image.nbytes for image in images)
        grown = self._memory is None or len(self._memory) < needed
        if grown:
            if self._memory is not None:
                self._memory.close()
            if self._descriptor is not None:
                os.close(self._descriptor)
            self._descriptor = os.memfd_create("spacevln-images")
            os.ftruncate(self._descriptor, needed)
            self._memory = mmap.mmap(self._descriptor, needed)
        assert self._memory is not None  # noqa: S101 - made above
        at = 0
        for image in images:
            np.frombuffer(self._memory, np.uint8, image.nbytes, at)[:] = image.reshape(-1)
            at += image.nbytes
        return grown

    def _connect(self) -> socket.socket:
        """A connection to the server, which is started when nobody answers; one client starts, the others wait for it."""
        self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        if self._path.parent.stat().st_uid != os.getuid() or self._path.parent.stat().st_mode & 0o077:
            raise PrerequisiteError(
                f"{str(self._path.parent)!r} is open to other users: remove it, or set TMPDIR to another folder."
            )
        connection = self._try()
        if connection is None:
            with self._path.with_suffix(".lock").open("w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                connection = self._try() or self._start()
        self._connection = connection
        return connection

    def _try(self) -> socket.socket | None:
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            connection.connect(str(self._path))
        except OSError:
            connection.close()
            return None
        return connection

    def _start(self) -> socket.socket:
        self.counts.starts += 1
        _started[:] = [process for process in _started if process.poll() is None]
        command = [sys.executable, "-m", "spacevln.perception.serving.server", str(self._path), self._factory, self._settings]
        with self._log.open("wb") as log:
            process = subprocess.Popen(  # noqa: S603 - our own interpreter and module
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True
            )
        _started.append(process)
        deadline = time.monotonic() + START_S
        while time.monotonic() < deadline:
            connection = self._try()
            if connection is not None:
                return connection
            if process.poll() is not None:
                said = self._log.read_text(errors="replace").strip().splitlines()
                raise PrerequisiteError(said[-1] if said else f"The detector server ended at once: see {self._log}.")
            time.sleep(POLL_S)
        process.kill()
        raise PrerequisiteError(f"The detector server did not answer within {START_S:.0f} s: see {self._log}.")

    def _disconnect(self) -> None:
        if self._connection is not None:
            self._connection.close()
            self._connection = None
