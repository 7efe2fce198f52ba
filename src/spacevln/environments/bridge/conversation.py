"""Asking a worker, wherever it runs: one request, one answer of the expected kind, or one typed error."""

from __future__ import annotations

import mmap
from abc import ABC, abstractmethod
from typing import TypeVar

from spacevln_bridge import messages as say
from spacevln_bridge.channel import Channel, ChannelError, ChannelLate

from spacevln.core.errors import EnvironmentFailure, PrerequisiteError, UsageError

START_S = 60.0
"""How long a worker may take to import its simulator."""
PING_S = 10.0
"""How long an idle worker may take to answer."""
OPEN_S = 900.0
"""How long a scene and its navigation mesh may take; large buildings need minutes."""
ANSWER_S = 60.0
"""How long a step, a picture or a path may take."""

Answer = TypeVar("Answer")


class Conversation(ABC):
    """A worker that can be asked. Any failure ends it: a late answer cannot be told from that to the next request.

    Args:
        channel: to the worker; owned.
        answer_s: how long a request may take, other than opening a scene.
    """

    welcome: say.Welcome
    block: mmap.mmap | bytearray
    """The image of the last view; valid until the next Place or Act."""

    def __init__(self, channel: Channel, answer_s: float) -> None:
        self._channel = channel
        self._answer_s = answer_s

    @property
    @abstractmethod
    def alive(self) -> bool:
        """Whether it can be asked."""

    @abstractmethod
    def close(self) -> None:
        """Let it end; may be called twice."""

    @abstractmethod
    def _lost(self, request: str, how: str) -> Exception:
        """What to raise when the worker is gone or not understood; it is ended."""

    @abstractmethod
    def _late(self, request: str, until_s: float) -> Exception:
        """What to raise when the worker did not answer in time; it is ended."""

    def ask(self, request: say.Message, kind: type[Answer], deadline_s: float | None = None) -> Answer:
        """The answer to a request.

        Raises:
            PrerequisiteError, UsageError: the worker says so.
            EnvironmentFailure: the simulator failed, died, hung, or talked nonsense; the worker is ended.
        """
        until_s = deadline_s or self._answer_s
        name = type(request).__name__
        try:
            self._channel.send(request, until_s)
            answer = self._channel.receive(until_s)
        except ChannelLate as error:
            raise self._late(name, until_s) from error
        except ChannelError as error:
            raise self._lost(name, str(error)) from error
        if isinstance(answer, say.Failed):
            refusal = _refusal(answer)
            if not isinstance(refusal, UsageError):
                self.close()
            raise refusal
        if not isinstance(answer, kind):
            raise self._lost(name, f"it answered {type(answer).__name__}")
        return answer


def _refusal(answer: say.Failed) -> Exception:
    """The error that a worker's answer stands for."""
    match answer.kind:
        case "prerequisite":
            return PrerequisiteError(answer.sentence)
        case "usage":
            return UsageError(answer.sentence)
        case _:
            return EnvironmentFailure(answer.sentence)
