"""A worker that listens on another machine: the same requests over TCP, images in the answers, a token at the door."""

from __future__ import annotations

import os
import socket
from urllib.parse import urlsplit

from spacevln_bridge import messages as say
from spacevln_bridge.channel import Channel, ChannelError
from spacevln_bridge.images import block_bytes
from spacevln_bridge.worker import TOKEN_VARIABLE

from spacevln.core.errors import EnvironmentFailure, PrerequisiteError, UsageError
from spacevln.environments.habitat.process import ANSWER_S, START_S, Answer, Worker, refusal

SCHEME = "tcp://"
CONNECT_S = 10.0


class RemoteWorker:
    """A worker that ``python -m spacevln_bridge --listen`` started there, and that outlives its clients.

    Args:
        address: ``tcp://HOST:PORT``.
        size_px: width and height of the images.
        answer_s: how long a request may take, other than opening a scene.

    Raises:
        PrerequisiteError: nobody listens there, or no token is set.
        UsageError: the address is none, or the token is wrong.
        EnvironmentFailure: what listens there does not speak the protocol.
    """

    def __init__(self, address: str, size_px: tuple[int, int], *, answer_s: float = ANSWER_S) -> None:
        self._address, self._answer_s = address, answer_s
        self.block = bytearray(block_bytes(*size_px))
        token = os.environ.get(TOKEN_VARIABLE, "")
        if not token:
            raise PrerequisiteError(
                f"The worker at {address} wants a token: set {TOKEN_VARIABLE} to the one it was started with."
            )
        self._channel = Channel(_connected(address))
        self.alive = True
        try:
            self.welcome: say.Welcome = self.ask(say.Hello(say.PROTOCOL, token), say.Welcome, START_S)
        except UsageError:  # a wrong token: nobody will hold what could hang up later
            self.close()
            raise

    def ask(self, request: say.Message, kind: type[Answer], deadline_s: float | None = None) -> Answer:
        """The answer to a request.

        Raises:
            PrerequisiteError, UsageError: the worker says so.
            EnvironmentFailure: the simulator failed, or the connection was lost; it is closed.
        """
        until, name = deadline_s or self._answer_s, type(request).__name__
        try:
            self._channel.send(request, until)
            answer = self._channel.receive(until)
        except ChannelError as error:
            self.close()
            raise EnvironmentFailure(
                f"The worker at {self._address} was lost in {name} ({error}): see whether it still runs."
            ) from error
        if isinstance(answer, say.Failed):
            error_told = refusal(answer)
            if not isinstance(error_told, UsageError):
                self.close()
            raise error_told
        if not isinstance(answer, kind):
            self.close()
            raise EnvironmentFailure(f"The worker at {self._address} answered {name} with {type(answer).__name__}.")
        if isinstance(answer, say.View):
            self.block[:] = answer.image
        return answer

    def close(self) -> None:
        """Hang up; may be called twice."""
        self.alive = False
        self._channel.close()


def connect(where: str, size_px: tuple[int, int], *, answer_s: float = ANSWER_S) -> Worker | RemoteWorker:
    """The worker in an interpreter, or at an address ``tcp://HOST:PORT``."""
    kind = RemoteWorker if where.startswith(SCHEME) else Worker
    return kind(where, size_px, answer_s=answer_s)


def _connected(address: str) -> socket.socket:
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
