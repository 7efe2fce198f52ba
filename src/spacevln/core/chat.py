"""What is said to a chat model and what comes back: the values of the :class:`~spacevln.core.interfaces.ChatModel` seam.

A request is complete in itself (no hidden history) and identified by :attr:`ChatRequest.digest`, which names the same request in
every process and on every machine: records, replays and the reply cache find calls by it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from spacevln.core.errors import ContractError, UsageError


class Role(StrEnum):
    """Who asks; planner and executor may be different models."""

    PLANNER = "planner"
    EXECUTOR = "executor"


class Speaker(StrEnum):
    """Who says a message."""

    SYSTEM = "system"
    USER = "user"
    ASSISTANT = "assistant"


@dataclass(frozen=True, slots=True)
class TextPart:
    """Words."""

    text: str


_SIGNATURES = ((b"\xff\xd8\xff", "image/jpeg"), (b"\x89PNG\r\n\x1a\n", "image/png"))


@dataclass(frozen=True, slots=True)
class ImagePart:
    """An encoded picture, sent as it is.

    Args:
        data: JPEG or PNG bytes.
        name: for people, e.g. ``"view left 30"``; not sent.

    Raises:
        UsageError: the bytes are neither.
    """

    data: bytes
    name: str = ""

    def __post_init__(self) -> None:
        if not any(self.data.startswith(signature) for signature, _ in _SIGNATURES):
            raise UsageError(f"Image {self.name!r} begins with {self.data[:8]!r}: give JPEG or PNG bytes.")

    @property
    def media_type(self) -> str:
        """``"image/jpeg"`` or ``"image/png"``."""
        return next(kind for signature, kind in _SIGNATURES if self.data.startswith(signature))

    @property
    def sha256(self) -> str:
        """Hex digest of the bytes: the picture's name in records."""
        return hashlib.sha256(self.data).hexdigest()


Part = TextPart | ImagePart


@dataclass(frozen=True, slots=True)
class Message:
    """One message of a conversation.

    Args:
        speaker: who says it.
        parts: text and pictures in the order in which the model reads them.
        static: byte-identical in every call of this role. Static messages come first, so that a provider can cache them; the
            last of them carries the provider's cache marker where one is needed.
    """

    speaker: Speaker
    parts: tuple[Part, ...]
    static: bool = False

    @property
    def text(self) -> str:
        """Its words without the pictures, parts joined by line ends."""
        return "\n".join(part.text for part in self.parts if isinstance(part, TextPart))


@dataclass(frozen=True, slots=True)
class ReplySchema:
    """The JSON object that is expected.

    Args:
        name: letters, digits, ``_`` and ``-``, e.g. ``"planner_reply"``.
        schema: JSON Schema of an object; the order of its properties is the order in which the model writes them.
    """

    name: str
    schema: Mapping[str, Any]

    @property
    def text(self) -> str:
        """The schema as JSON, readable."""
        return json.dumps(self.schema, ensure_ascii=False, indent=2)


@dataclass(frozen=True, slots=True)
class ChatRequest:
    """One complete question.

    Args:
        role: who asks.
        messages: static ones first.
        reply_schema: what the reply must look like; None = free text.
        max_tokens: bound of the reply.

    Raises:
        ContractError: no message, or a static message after another.
    """

    role: Role
    messages: tuple[Message, ...]
    reply_schema: ReplySchema | None = None
    max_tokens: int = 2048

    def __post_init__(self) -> None:
        statics = [message.static for message in self.messages]
        if not statics or statics != sorted(statics, reverse=True):
            raise ContractError("A chat request needs at least one message, and static messages before all others.")

    @property
    def images(self) -> tuple[ImagePart, ...]:
        """Every picture, in order."""
        return tuple(part for message in self.messages for part in message.parts if isinstance(part, ImagePart))

    @property
    def digest(self) -> str:
        """SHA-256 of everything that the model reads, pictures by their own digests; hex."""
        content = {
            "role": self.role,
            "messages": [
                [message.speaker, message.static, [_identity(part) for part in message.parts]] for message in self.messages
            ],
            "reply_schema": None if self.reply_schema is None else [self.reply_schema.name, self.reply_schema.schema],
            "max_tokens": self.max_tokens,
        }
        return hashlib.sha256(json.dumps(content, ensure_ascii=False).encode("utf-8", "surrogatepass")).hexdigest()


def _identity(part: Part) -> dict[str, str]:
    return {"text": part.text} if isinstance(part, TextPart) else {"image": part.sha256}


@dataclass(frozen=True, slots=True)
class Usage:
    """Tokens of one call, or of several together.

    Args:
        input_tokens: all that was read, cached ones included.
        cached_tokens: of these, found in the provider's cache.
        cache_write_tokens: of these, written into it (billed apart by some providers).
        output_tokens: all that was written, reasoning included.
        reasoning_tokens: of these, thought that is not part of the reply.
    """

    input_tokens: int = 0
    cached_tokens: int = 0
    cache_write_tokens: int = 0
    output_tokens: int = 0
    reasoning_tokens: int = 0

    def __add__(self, other: Usage) -> Usage:
        return Usage(
            self.input_tokens + other.input_tokens,
            self.cached_tokens + other.cached_tokens,
            self.cache_write_tokens + other.cache_write_tokens,
            self.output_tokens + other.output_tokens,
            self.reasoning_tokens + other.reasoning_tokens,
        )


class ReplyMode(StrEnum):
    """How the shape of the reply was asked for."""

    JSON_SCHEMA = "json_schema"  # the server constrains the reply to the schema
    JSON_OBJECT = "json_object"  # the server promises some JSON object
    TEXT = "text"  # the prompt alone asks for it


class ReplySource(StrEnum):
    """Where a reply came from."""

    MODEL = "model"
    CACHE = "cache"  # the content-addressed cache: the same call was answered before
    RECORD = "record"  # a replay


@dataclass(frozen=True, slots=True)
class ChatReply:
    """An answer.

    Args:
        text: of the reply, without thoughts.
        model: the name that the server gave itself.
        mode: how the shape was asked for.
        usage: tokens; zeros when the server tells none.
        latency_s: from the request to the whole reply, waits and retries included.
        usd: what it cost; None when the price is not known. A cached or replayed reply costs nothing.
        thought: reasoning that the server handed out beside the reply.
        attempts: requests that it took.
        source: where it came from.
    """

    text: str
    model: str = ""
    mode: ReplyMode = ReplyMode.TEXT
    usage: Usage = Usage()
    latency_s: float = 0.0
    usd: float | None = None
    thought: str = ""
    attempts: int = 1
    source: ReplySource = ReplySource.MODEL
