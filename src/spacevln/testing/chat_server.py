"""A local OpenAI-compatible server that plays scripts and faults: for tests of everything between a prompt and its reply."""

from __future__ import annotations

import contextlib
import json
import socket
import struct
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any, Self

from spacevln.core import ReplyMode

Body = dict[str, Any]


@dataclass(frozen=True)
class Say:
    """A proper reply.

    Args:
        content: text, or a mapping written as JSON.
        finish: finish reason.
        usage: merged into the usage that is told; None = no usage.
        message: further fields of the message, e.g. ``reasoning_content``.
        after_s: delay before it, cut short when the server closes.
    """

    content: str | Mapping[str, Any]
    finish: str = "stop"
    usage: Mapping[str, Any] | None = field(default_factory=dict)
    message: Mapping[str, Any] = field(default_factory=dict)
    after_s: float = 0.0


@dataclass(frozen=True)
class Refuse:
    """An HTTP error."""

    status: int
    message: str = "refused"
    code: str = ""
    headers: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Raw:
    """Any bytes as the body of HTTP 200."""

    data: bytes


@dataclass(frozen=True)
class Reset:
    """The connection breaks; in the middle of the reply, or before its first byte."""

    mid_reply: bool = True


@dataclass(frozen=True)
class Hang:
    """Nothing comes until the server closes; with ``drip_s`` a byte now and then, so that no single read times out."""

    drip_s: float | None = None


Turn = Say | Refuse | Raw | Reset | Hang | str
ServerLine = Turn | Callable[[Body], Turn]


class ScriptedServer:
    """Serves ``/v1/chat/completions`` and ``/v1/models`` on a free port of 127.0.0.1. A context manager.

    Args:
        script: one line per request; the last is repeated. A function is given the request's body.
        modes: reply shapes that it has; others are refused with HTTP 400, as servers do.
        models: names that it offers.
    """

    def __init__(
        self, script: Sequence[ServerLine], modes: Sequence[ReplyMode] = tuple(ReplyMode), models: Sequence[str] = ("scripted",)
    ) -> None:
        self.script = list(script)
        self.modes = frozenset(modes)
        self.models = tuple(models)
        self.bodies: list[Body] = []
        self.headers: list[dict[str, str]] = []
        self.closing = threading.Event()
        self._lock = threading.Lock()
        self._played = 0
        self._server = _Server(("127.0.0.1", 0), _Handler)
        self._server.owner = self
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    @property
    def url(self) -> str:
        """Base URL for a client."""
        return f"http://127.0.0.1:{self._server.server_address[1]}/v1"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.closing.set()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def turn(self, body: Body, headers: Mapping[str, str]) -> Turn:
        """What is answered to a request."""
        with self._lock:
            self.bodies.append(body)
            self.headers.append({name.lower(): value for name, value in headers.items()})
            asked = body.get("response_format", {}).get("type", ReplyMode.TEXT)
            if asked not in self.modes:
                return Refuse(400, f"response_format of type {asked!r} is not supported by this server")
            line = self.script[min(self._played, len(self.script) - 1)]
            self._played += 1
        return line(body) if callable(line) else line


def closed_url() -> str:
    """A URL at which every connection is refused."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"http://127.0.0.1:{probe.getsockname()[1]}/v1"


class _Server(ThreadingHTTPServer):
    owner: ScriptedServer
    daemon_threads = True
    block_on_close = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that has given up is no error of the server."""


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    protocol_version = "HTTP/1.0"  # one request per connection, so that a broken one harms no other

    def do_GET(self) -> None:
        self._json(200, {"object": "list", "data": [{"id": name, "object": "model"} for name in self.server.owner.models]})

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        turn = self.server.owner.turn(body, dict(self.headers))
        match turn:
            case str():
                self._json(200, completion(body, Say(turn)))
            case Say():
                self.server.owner.closing.wait(turn.after_s)
                self._json(200, completion(body, turn))
            case Refuse():
                error = {"message": turn.message, "code": turn.code or None, "type": turn.code or None}
                self._json(turn.status, {"error": error}, turn.headers)
            case Raw(data=data):
                self._start(200, len(data))
                self.wfile.write(data)
            case Reset(mid_reply=mid_reply):
                self._reset(body, mid_reply=mid_reply)
            case Hang(drip_s=drip_s):
                self._hang(drip_s)

    def _start(self, status: int, length: int, headers: Mapping[str, str] | None = None) -> None:
        self.send_response(status)
        for name, value in {"Content-Type": "application/json", "Content-Length": str(length), **(headers or {})}.items():
            self.send_header(name, value)
        self.end_headers()

    def _json(self, status: int, content: Any, headers: Mapping[str, str] | None = None) -> None:
        data = json.dumps(content).encode()
        self._start(status, len(data), headers)
        self.wfile.write(data)

    def _reset(self, body: Body, *, mid_reply: bool) -> None:
        if mid_reply:
            data = json.dumps(completion(body, Say("{}"))).encode()
            self._start(200, len(data))
            self.wfile.write(data[: len(data) // 2])
            self.wfile.flush()
        # linger 0: closing sends RST instead of FIN
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        with contextlib.suppress(OSError):
            self.connection.close()

    def _hang(self, drip_s: float | None) -> None:
        if drip_s is None:
            self.server.owner.closing.wait()
            return
        self._start(200, 1_000_000)
        with contextlib.suppress(OSError):  # the client has had enough
            while not self.server.owner.closing.wait(drip_s):
                self.wfile.write(b" ")
                self.wfile.flush()

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the name in the base class
        """Tests read ``bodies``, not a log."""


def completion(body: Body, say: Say) -> Body:
    """A chat completion as OpenAI's servers write it."""
    text = say.content if isinstance(say.content, str) else json.dumps(say.content, ensure_ascii=False)
    reply: Body = {
        "id": "chatcmpl-scripted",
        "object": "chat.completion",
        "created": 0,
        "model": body["model"],
        "choices": [
            {"index": 0, "finish_reason": say.finish, "message": {"role": "assistant", "content": text, **say.message}},
        ],
    }
    if say.usage is not None:
        told = {"prompt_tokens": len(json.dumps(body["messages"])) // 4, "completion_tokens": len(text) // 4, **say.usage}
        reply["usage"] = {**told, "total_tokens": told["prompt_tokens"] + told["completion_tokens"]}
    return reply
