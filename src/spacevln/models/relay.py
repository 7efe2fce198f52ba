"""Asks through a folder: readable requests out, replies read from files (docs/relay.md).

For human baselines, for trying prompts by hand, and for whatever is no HTTP server.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from spacevln.core import ChatReply, ChatRequest, ImagePart, ModelError, RecordError, ReplyMode, TextPart

POLL_S = 0.25
REPLY, STOP = "reply.txt", "stop"


class RelayModel:
    """Writes each request into a numbered folder and waits for ``reply.txt`` in it.

    Args:
        directory: of the conversation; further requests are numbered on.
        timeout_s: how long to wait for a reply; None = for ever.
        sleep, clock: injected by tests.

    Raises:
        RecordError: the folder cannot be written.
    """

    def __init__(
        self,
        directory: Path,
        timeout_s: float | None = None,
        sleep: Callable[[float], None] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._directory = directory
        self._timeout_s = timeout_s
        self._sleep, self._clock = sleep, clock

    @property
    def name(self) -> str:
        """``relay:FOLDER``."""
        return f"relay:{self._directory}"

    def complete(self, request: ChatRequest) -> ChatReply:
        """Write the request, wait, read the reply."""
        begin = self._clock()
        try:
            folder = self._next_folder(request)
            write_request(folder, request)
        except OSError as error:
            raise RecordError(
                f"Cannot write the relay {str(self._directory)!r} ({error.strerror}): give a writable folder."
            ) from error
        text = self._await(folder, begin)
        return ChatReply(text=text, model="relay", mode=ReplyMode.TEXT, latency_s=self._clock() - begin, usd=0.0)

    def _next_folder(self, request: ChatRequest) -> Path:
        self._directory.mkdir(parents=True, exist_ok=True)
        taken = [int(path.name[:4]) for path in self._directory.iterdir() if path.name[:4].isdigit()]
        folder = self._directory / f"{max(taken, default=0) + 1:04d}_{request.role}"
        folder.mkdir()
        return folder

    def _await(self, folder: Path, begin: float) -> str:
        before: bytes | None = None
        while True:
            now = _content(folder / REPLY)
            if now and now == before:  # the same twice: the writer has finished
                return now.decode("utf-8", "replace").strip()
            before = now
            if (self._directory / STOP).exists():
                raise ModelError(f"The relay was stopped by the file {str(self._directory / STOP)!r}.")
            if self._timeout_s is not None and self._clock() - begin > self._timeout_s:
                raise ModelError(f"No {REPLY} came into {str(folder)!r} within {self._timeout_s:.0f} s.")
            self._sleep(POLL_S)


def write_request(folder: Path, request: ChatRequest) -> None:
    """Write ``request.md`` with its pictures, and ``schema.json``, into an existing folder. ``request.md`` comes last: once it is
    there, all is there.
    """
    lines = [f"# Request to the {request.role}", ""]
    number = 0
    for message in request.messages:
        lines += [f"## {message.speaker}" + (" (the same in every call)" if message.static else ""), ""]
        for part in message.parts:
            if isinstance(part, TextPart):
                lines += [part.text, ""]
                continue
            number += 1
            name = picture_name(number, part)
            (folder / name).write_bytes(part.data)
            lines += [f"![{part.name or name}]({name})", ""]
    if request.reply_schema is not None:
        (folder / "schema.json").write_text(request.reply_schema.text + "\n", encoding="utf-8")
        lines += [f"Write one JSON object that matches `schema.json` into `{REPLY}` beside this file.", ""]
    else:
        lines += [f"Write the answer into `{REPLY}` beside this file.", ""]
    unfinished = folder / ".request.md"
    unfinished.write_text("\n".join(lines), encoding="utf-8")
    unfinished.replace(folder / "request.md")


def picture_name(number: int, picture: ImagePart) -> str:
    """A file name that sorts as the model sees the pictures, e.g. ``"02_view-left-30.jpg"``."""
    words = "-".join("".join(char if char.isalnum() else " " for char in picture.name).split()) or "image"
    return f"{number:02d}_{words}{'.png' if picture.media_type == 'image/png' else '.jpg'}"


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
