"""One scene after the other in a worker that is started when it is needed and restarted when it was lost."""

from __future__ import annotations

import mmap
from pathlib import Path

from spacevln_bridge import messages as say

from spacevln.core.errors import ContractError, EnvironmentFailure, PrerequisiteError
from spacevln.environments.bridge.conversation import ANSWER_S, OPEN_S, PING_S, Answer, Conversation
from spacevln.environments.bridge.remote import SCHEME, connect
from spacevln.environments.bridge.setup import BridgeSetup

Opened = say.Opened | say.SplatsOpened


class BridgedSimulator:
    """A simulator with one scene open, in a worker of its own.

    Args:
        setup: how.
        answer_s, open_s: how long a request, and opening a scene, may take.
    """

    def __init__(self, setup: BridgeSetup, *, answer_s: float = ANSWER_S, open_s: float = OPEN_S) -> None:
        self.setup = setup
        self._open_s = open_s
        self.starts = 0
        self.opened: Opened | None = None
        self._answer_s = answer_s
        self._worker: Conversation | None = None
        self._scene: str | None = None

    @property
    def worker(self) -> Conversation:
        """The running worker; started if there is none.

        Raises:
            PrerequisiteError: its interpreter, or something in it, is missing.
            EnvironmentFailure: it does not start.
        """
        if self._worker is None or not self._worker.alive:
            self.close()
            size_px = (self.setup.width_px, self.setup.height_px)
            self._worker = connect(self.setup.python, self.setup.simulator, size_px, answer_s=self._answer_s)
            self.starts += 1
        return self._worker

    def open(self, scene: str) -> Opened:
        """Load a scene unless it is open; a worker that no longer answers is replaced first.

        Raises:
            PrerequisiteError: the scene is missing.
            EnvironmentFailure: the simulator cannot load it.
        """
        if self._worker is not None and self._worker.alive and self.opened is not None and self._scene == scene:
            return self.opened
        setup, path = self.setup, Path(self.setup.scenes) / scene
        there = setup.python.startswith(SCHEME)  # scenes, dataset and cache are then that machine's
        if not (there or path.exists()):
            raise PrerequisiteError(f"Scene {str(path)!r} is missing: give the folder of all scenes with --scenes.")
        self._scene = None
        request = setup.request(path if there else path.resolve())
        answer: type[Opened] = say.Opened if isinstance(request, say.Open) else say.SplatsOpened
        self.opened = self.worker.ask(request, answer, self._open_s)
        self._scene = scene
        return self.opened

    def check(self) -> None:
        """Make sure that the worker answers.

        Raises:
            EnvironmentFailure: it hung; the next use starts another.
        """
        if self._worker is not None and self._worker.alive:
            self._worker.ask(say.Ping(), say.Pong, min(PING_S, self._answer_s))

    def ask(self, request: say.Message, kind: type[Answer]) -> Answer:
        """The answer to a request about the open scene.

        Raises:
            EnvironmentFailure: the simulator failed, or was lost before.
        """
        if self._worker is None or self._scene is None or not self._worker.alive:
            raise EnvironmentFailure(f"The worker of {self.setup.title} was lost: reset to an episode, which starts another.")
        return self._worker.ask(request, kind)

    @property
    def image(self) -> mmap.mmap | bytearray:
        """The shared image of the last view, which outlives the worker that drew it."""
        if self._worker is None:
            raise ContractError("BridgedSimulator.image was read before a scene was open: open one first.")
        return self._worker.block

    def close(self) -> None:
        """End the worker; may be called twice."""
        if self._worker is not None:
            self._worker.close()
        self._worker, self._scene, self.opened = None, None, None
