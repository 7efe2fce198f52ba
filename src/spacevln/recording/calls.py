"""How a call of a chat model is recorded: the request by its parts, pictures and static texts once, by their hashes."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from spacevln.core import (
    CallRetried,
    ChatReply,
    ImagePart,
    Message,
    ModelCalled,
    Part,
    ReplyRejected,
    Role,
    Speaker,
    TextPart,
    read_object,
)
from spacevln.recording.record import Record

FOLDER = "prompts"


class TextLine(Record):
    """Words, as they were sent."""

    kind: Literal["text"] = "text"
    text: str


class TextFileLine(Record):
    """Words that many calls share; ``file`` holds them and is named by their SHA-256."""

    kind: Literal["text_file"] = "text_file"
    file: str


class ImageLine(Record):
    """A picture; ``file`` is None at level light, where only its SHA-256 is kept."""

    kind: Literal["image"] = "image"
    name: str
    sha256: str
    file: str | None


PartLine = Annotated[TextLine | TextFileLine | ImageLine, Field(discriminator="kind")]


class MessageLine(Record):
    """One message of a request."""

    speaker: Speaker
    static: bool
    parts: tuple[PartLine, ...]


class ModelCalledLine(Record):
    """A chat model was asked.

    ``digest`` identifies the request; ``parsed`` is the JSON object of the reply where there is one; ``problem`` is empty for a
    usable reply.
    """

    event: Literal["model_called"] = "model_called"
    time_s: float
    call: int
    stage: int
    role: Role
    model: str
    digest: str
    messages: tuple[MessageLine, ...]
    schema_name: str | None
    schema_file: str | None
    max_tokens: int
    reply: ChatReply | None
    parsed: dict[str, Any] | None
    problem: str
    detail: str


class CallRetriedLine(Record):
    """A request failed and is sent again."""

    event: Literal["call_retried"] = "call_retried"
    time_s: float
    role: Role
    model: str
    attempt: int
    kind: str
    detail: str
    wait_s: float


class CallRecorder:
    """Writes the files of an episode's calls and makes their lines.

    Args:
        directory: of the episode.
        pictures: whether pictures are kept; their hashes always are.
    """

    def __init__(self, directory: Path, *, pictures: bool) -> None:
        self._directory = directory
        self._pictures = pictures
        self._count = 0

    def called(self, event: ModelCalled, stage: int, time_s: float) -> ModelCalledLine:
        """The line of a call; its files are written."""
        self._count += 1
        request, schema = event.request, event.request.reply_schema
        return ModelCalledLine(
            time_s=time_s,
            call=self._count,
            stage=stage,
            role=request.role,
            model=event.model,
            digest=request.digest,
            messages=tuple(map(self._message, request.messages)),
            schema_name=None if schema is None else schema.name,
            schema_file=None if schema is None else self._keep(schema.text.encode(), ".json"),
            max_tokens=request.max_tokens,
            reply=event.reply,
            parsed=_parsed(event.reply),
            problem=event.problem,
            detail=event.detail,
        )

    def retried(self, event: CallRetried, time_s: float) -> CallRetriedLine:
        """The line of a retry."""
        return CallRetriedLine(
            time_s=time_s,
            role=event.role,
            model=event.model,
            attempt=event.attempt,
            kind=event.kind,
            detail=event.detail,
            wait_s=event.wait_s,
        )

    def _message(self, message: Message) -> MessageLine:
        parts = tuple(self._part(part, static=message.static) for part in message.parts)
        return MessageLine(speaker=message.speaker, static=message.static, parts=parts)

    def _part(self, part: Part, *, static: bool) -> PartLine:
        match part:
            case TextPart(text=text):
                clean = text.encode("utf-8", "replace")  # a lone surrogate is no text that a file can hold
                return TextFileLine(file=self._keep(clean, ".txt")) if static else TextLine(text=clean.decode())
            case ImagePart(data=data, name=name):
                suffix = ".png" if part.media_type == "image/png" else ".jpg"
                file = self._keep(data, suffix) if self._pictures else None
                return ImageLine(name=name, sha256=part.sha256, file=file)

    def _keep(self, data: bytes, suffix: str) -> str:
        name = f"{FOLDER}/{hashlib.sha256(data).hexdigest()}{suffix}"
        path = self._directory / name
        if not path.exists():
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(data)
        return name


def _parsed(reply: ChatReply | None) -> dict[str, Any] | None:
    if reply is None:
        return None
    try:
        return read_object(reply.text).value
    except ReplyRejected:
        return None
