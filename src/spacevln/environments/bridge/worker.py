"""The worker process in the simulator's interpreter: started, spoken to, given up, never left behind."""

from __future__ import annotations

import contextlib
import mmap
import os
import signal
import socket
import subprocess
import tempfile
from pathlib import Path
from typing import IO

import spacevln_bridge
from spacevln_bridge import messages as say
from spacevln_bridge.channel import Channel, ChannelError
from spacevln_bridge.images import block_bytes, shared_block

from spacevln.core.errors import EnvironmentFailure, PrerequisiteError
from spacevln.environments.bridge.conversation import ANSWER_S, START_S, Conversation

END_S = 5.0
"""How long a worker may take to end by itself."""
_ERROR_LINES = 3
_ERROR_BYTES = 2000


class Worker(Conversation):
    """A worker process of this machine. It dies with the thread that made it, also if that is killed; use it in one thread.

    Args:
        python: interpreter that has the simulator, numpy and msgpack.
        simulator: its name, "habitat" or "gn-bench".
        size_px: width and height of the images.
        answer_s: how long a request may take, other than opening a scene.

    Raises:
        PrerequisiteError: the interpreter, or something in it, is missing.
        EnvironmentFailure: it does not start, or there is no memory for images.
    """

    def __init__(self, python: str, simulator: str, size_px: tuple[int, int], *, answer_s: float = ANSWER_S) -> None:
        self._python = python
        self._errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the worker
        ours, theirs = socket.socketpair()
        super().__init__(Channel(ours), answer_s)
        descriptor = -1
        try:
            descriptor, self.block = _image_block(size_px)
            self._process = self._start(theirs.fileno(), descriptor)
        except (PrerequisiteError, EnvironmentFailure):
            self._channel.close()
            self._errors.close()
            raise
        finally:
            theirs.close()
            if descriptor >= 0:
                os.close(descriptor)
        self._ended = False
        self.welcome = self.ask(say.Hello(say.PROTOCOL, "", simulator), say.Welcome, START_S)

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it can be asked."""
        return not self._ended and self._process.poll() is None

    def _late(self, request: str, until_s: float) -> Exception:
        self._give_up()
        return EnvironmentFailure(
            f"The simulator's worker did not answer {request} within {until_s:g} s and was ended: "
            "see `spacevln doctor --habitat-python`."
        )

    def _lost(self, request: str, how: str) -> Exception:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=1.0)
        code, said = self._process.poll(), self._last_words()
        self._give_up()
        if "No module named" in said and code == 1:
            missing = said.rpartition("No module named")[2].strip(" '\n")
            return PrerequisiteError(
                f"The simulator's Python has no {missing}: install it there with `{self._python} -m pip install {missing}`."
            )
        ended = "" if code is None else f", {_end_of(code)}"
        return EnvironmentFailure(f"The simulator's worker was lost in {request} ({how}{ended}): {said or 'it said nothing'}.")

    def _last_words(self) -> str:
        size = self._errors.seek(0, os.SEEK_END)
        self._errors.seek(max(0, size - _ERROR_BYTES))
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return "; ".join(line.strip() for line in lines[-_ERROR_LINES:]).rstrip(".")

    def _start(self, channel: int, block: int) -> subprocess.Popen[bytes]:
        command = [self._python, str(Path(spacevln_bridge.__file__).parent), "--channel", str(channel), "--block", str(block)]
        environment = {"HABITAT_SIM_LOG": "quiet", "MAGNUM_LOG": "quiet", "GLOG_minloglevel": "2", **os.environ}
        try:
            return subprocess.Popen(  # noqa: S603 - the interpreter that the user named
                command,
                stdin=subprocess.DEVNULL,
                stdout=self._errors,
                stderr=self._errors,
                pass_fds=(channel, block),
                env=environment,
                process_group=0,
            )
        except OSError as error:
            raise PrerequisiteError(
                f"The simulator's Python {self._python!r} cannot be started ({error.strerror}): "
                "give --habitat-python the path of an interpreter, or conda:NAME."
            ) from error

    def _give_up(self) -> None:
        """End it whatever it does, and all that it started."""
        if not self._ended:
            self._ended = True
            self._channel.close()
            if self._process.poll() is None:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._errors.close()

    def close(self) -> None:
        """Let it end; may be called twice."""
        if self._ended:
            return
        with contextlib.suppress(ChannelError):
            self._channel.send(say.Bye(), END_S)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=END_S)
        self._give_up()


def _image_block(size_px: tuple[int, int]) -> tuple[int, mmap.mmap]:
    """An anonymous file in shared memory, its pages reserved: a full memory is noticed here, not in a picture's middle."""
    needed, descriptor = block_bytes(*size_px), -1
    try:
        descriptor = os.memfd_create("spacevln-image")
        os.posix_fallocate(descriptor, 0, needed)
        return descriptor, shared_block(descriptor, *size_px)
    except OSError as error:
        if descriptor >= 0:
            os.close(descriptor)
        raise EnvironmentFailure(
            f"There is no shared memory for images of {needed / 1e6:.1f} MB ({error.strerror}): free memory."
        ) from error


def _end_of(code: int) -> str:
    """How a process ended, in words."""
    return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
