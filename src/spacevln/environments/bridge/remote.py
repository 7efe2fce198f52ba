"""A worker that listens on another machine: the same requests over TCP, images in the answers, a token at the door."""

from __future__ import annotations

import os
import socket
from urllib.parse import urlsplit

from spacevln_bridge import messages as say
from spacevln_bridge.channel import Channel
from spacevln_bridge.images import block_bytes
from spacevln_bridge.worker import TOKEN_VARIABLE

from spacevln.core.errors import EnvironmentFailure, PrerequisiteError, UsageError
from spacevln.environments.bridge.conversation import ANSWER_S, START_S, Answer, Conversation
from spacevln.environments.bridge.worker import Worker

SCHEME = "tcp://"
CONNECT_S = 10.0


class RemoteWorker(Conversation):
    """A worker that ``python -m spacevln_bridge --listen`` started there, and that outlives its clients.

    Args:
        address: ``tcp://HOST:PORT``.
        simulator: its name, "habitat" or "gn-bench".
        size_px: width and height of the images.
        answer_s: how long a request may take, other than opening a scene.

    Raises:
        PrerequisiteError: nobody listens there, or no token is set.
        UsageError: the address is none, or the token is wrong.
        EnvironmentFailure: what listens there does not speak the protocol.
    """

    block: bytearray

    def __init__(self, address: str, simulator: str, size_px: tuple[int, int], *, answer_s: float = ANSWER_S) -> None:
        self._address = address
        self.block = bytearray(block_bytes(*size_px))
        token = os.environ.get(TOKEN_VARIABLE, "")
        if not token:
            raise PrerequisiteError(
                f"The worker at {address} wants a token: set {TOKEN_VARIABLE} to the one it was started with."
            )
        super().__init__(Channel(_connection(address)), answer_s)
        self._connected = True
        try:
            self.welcome = self.ask(say.Hello(say.PROTOCOL, token, simulator), say.Welcome, START_S)
        except UsageError:  # a wrong token or simulator: nobody will hold what could hang up later
            self.close()
            raise

    @property
    def alive(self) -> bool:
        """Whether it can be asked."""
        return self._connected

    def ask(self, request: say.Message, kind: type[Answer], deadline_s: float | None = None) -> Answer:
        """The answer to a request; a view's image is taken out of it."""
        answer = super().ask(request, kind, deadline_s)
        if isinstance(answer, say.View):
            self.block[:] = answer.image
        return answer

    def _late(self, request: str, until_s: float) -> Exception:
        return self._lost(request, f"it did not answer within {until_s:g} s")

    def _lost(self, request: str, how: str) -> Exception:
        self.close()
        return EnvironmentFailure(f"The worker at {self._address} was lost in {request} ({how}): see whether it still runs.")

    def close(self) -> None:
        """Hang up; may be called twice."""
        self._connected = False
        self._channel.close()


def connect(where: str, simulator: str, size_px: tuple[int, int], *, answer_s: float = ANSWER_S) -> Conversation:
    """The worker of a simulator in an interpreter, or at an address ``tcp://HOST:PORT``."""
    kind = RemoteWorker if where.startswith(SCHEME) else Worker
    return kind(where, simulator, size_px, answer_s=answer_s)


def _connection(address: str) -> socket.socket:
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if host is None or port is None:
        raise UsageError(f"{address!r} is no address of a worker: give tcp://HOST:PORT.")
    try:
        connection = socket.create_connection((host, port), CONNECT_S)
    except OSError as error:
        raise PrerequisiteError(
            f"Nobody answers at {address} ({error.strerror or error}): start `python -m spacevln_bridge --listen` there."
        ) from error
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection
