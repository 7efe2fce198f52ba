"""Between a :class:`ChatRequest` and the JSON that an OpenAI-compatible server reads and writes."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spacevln.core import ChatReply, ChatRequest, ImagePart, Message, ReplyMode, ReplyRejected, Speaker, TextPart, Usage
from spacevln.models.choice import ModelChoice
from spacevln.models.profiles import Profile

MAX_REPLY_CHARS = 100_000
"""Longer replies are refused: no plan is that long."""

CACHE_MARKER = {"type": "ephemeral"}


class UnusableReply(ReplyRejected):
    """A reply came, but not one that can be used.

    Args:
        reply: what came, for the record and the bill.
    """

    def __init__(self, kind: str, reason: str, reply: ChatReply) -> None:
        super().__init__(kind, reason)
        self.reply = reply


def request_body(request: ChatRequest, choice: ModelChoice, profile: Profile, mode: ReplyMode) -> dict[str, Any]:
    """The body of ``POST /chat/completions``; byte-identical for the same arguments."""
    body: dict[str, Any] = {"model": choice.model, "messages": _messages(request, profile, mode)}
    body[profile.limit_field] = request.max_tokens + (choice.thinking or 0)
    if choice.temperature is not None and profile.temperature:
        body["temperature"] = choice.temperature
    if choice.seed is not None:
        body["seed"] = choice.seed
    if request.reply_schema is not None and mode is not ReplyMode.TEXT:
        body["response_format"] = _response_format(request, mode)
    if choice.thinking is not None:
        body |= profile.thinking(choice.thinking)
    return body | profile.extra


def _messages(request: ChatRequest, profile: Profile, mode: ReplyMode) -> list[dict[str, Any]]:
    messages = list(request.messages)
    last_static = sum(message.static for message in messages) - 1
    if request.reply_schema is not None and mode is not ReplyMode.JSON_SCHEMA:
        shape = TextPart(
            "Reply with exactly one JSON object and nothing else. It must match this JSON Schema, fields in this order:\n"
            + json.dumps(request.reply_schema.schema, ensure_ascii=False)
        )
        if last_static < 0:
            messages.insert(0, Message(Speaker.SYSTEM, (shape,)))
        else:  # at the end of the static prefix, so that it is cached with it
            end = messages[last_static]
            messages[last_static] = Message(end.speaker, (*end.parts, shape), static=True)
    marked = last_static if profile.cache_marker else -1
    return [_message(message, mark=index == marked) for index, message in enumerate(messages)]


def _message(message: Message, *, mark: bool) -> dict[str, Any]:
    if not mark and all(isinstance(part, TextPart) for part in message.parts):  # the plain form is understood by every server
        return {"role": message.speaker.value, "content": message.text}
    content = [_part(part) for part in message.parts]
    if mark:
        content[-1]["cache_control"] = CACHE_MARKER
    return {"role": message.speaker.value, "content": content}


def _part(part: TextPart | ImagePart) -> dict[str, Any]:
    if isinstance(part, TextPart):
        return {"type": "text", "text": part.text}
    data = base64.b64encode(part.data).decode("ascii")
    return {"type": "image_url", "image_url": {"url": f"data:{part.media_type};base64,{data}"}}


def _response_format(request: ChatRequest, mode: ReplyMode) -> dict[str, Any]:
    if request.reply_schema is None or mode is ReplyMode.JSON_OBJECT:
        return {"type": "json_object"}
    schema = {"name": request.reply_schema.name, "schema": strict_schema(request.reply_schema.schema), "strict": True}
    return {"type": "json_schema", "json_schema": schema}


def strict_schema(schema: Mapping[str, Any]) -> dict[str, Any]:
    """The schema as strict servers want it: objects closed, every property required, no titles and defaults."""
    strict: dict[str, Any] = {}
    for key, value in schema.items():
        if key in ("properties", "$defs"):
            strict[key] = {name: strict_schema(inner) for name, inner in value.items()}
        elif key in ("title", "default") and not isinstance(value, Mapping):
            continue
        elif isinstance(value, Mapping):
            strict[key] = strict_schema(value)
        elif isinstance(value, list | tuple):
            strict[key] = [strict_schema(each) if isinstance(each, Mapping) else each for each in value]
        else:
            strict[key] = value
    if "properties" in strict:
        strict["required"] = list(strict["properties"])
        strict["additionalProperties"] = False
    return strict


@dataclass(frozen=True, slots=True)
class Answer:
    """What a server's JSON says.

    Args:
        text, thought: of the first choice.
        finish: why it ended: ``stop``, ``length``, ``content_filter`` ...
        model: its own name.
        usage: None when the server tells none.
        usd: what the server says that it cost.
    """

    text: str
    thought: str
    finish: str
    model: str
    usage: Usage | None
    usd: float | None


def read_answer(data: Any, profile: Profile) -> Answer:
    """The answer in a server's JSON.

    Raises:
        ValueError: it is no chat completion.
    """
    choices = data.get("choices") if isinstance(data, dict) else None
    choice = choices[0] if isinstance(choices, list) and choices else None
    message = choice.get("message") if isinstance(choice, dict) else None
    if not isinstance(choice, dict) or not isinstance(message, dict):
        raise ValueError("its JSON holds no choices[0].message")
    told = data.get("usage")
    return Answer(
        text=_text(message.get("content")) or _text(message.get("refusal")),
        thought=_text(message.get("reasoning_content")) or _text(message.get("reasoning")),
        finish="content_filter" if message.get("refusal") else str(choice.get("finish_reason") or "stop"),
        model=_text(data.get("model")),
        usage=_usage(told) if isinstance(told, dict) else None,
        usd=_number(told.get("cost")) if profile.tells_usd and isinstance(told, dict) else None,
    )


def _text(value: Any) -> str:
    if isinstance(value, list):  # some servers answer in parts
        return "".join(_text(part.get("text")) for part in value if isinstance(part, dict))
    return value.encode("utf-8", "replace").decode() if isinstance(value, str) else ""  # no lone surrogates


def _usage(told: Mapping[str, Any]) -> Usage:
    read = told.get("prompt_tokens_details")
    written = told.get("completion_tokens_details")
    read = read if isinstance(read, dict) else {}
    written = written if isinstance(written, dict) else {}
    return Usage(
        input_tokens=_count(told.get("prompt_tokens")),
        cached_tokens=_count(read.get("cached_tokens", told.get("cached_tokens"))),
        cache_write_tokens=_count(read.get("cache_creation_input_tokens", read.get("cache_write_tokens"))),
        output_tokens=_count(told.get("completion_tokens")),
        reasoning_tokens=_count(written.get("reasoning_tokens")),
    )


def _count(value: Any) -> int:
    return value if isinstance(value, int) and value >= 0 else 0


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and value >= 0 else None


def usable(answer: Answer, reply: ChatReply, max_tokens: int) -> ChatReply:
    """The reply, if it can be used.

    Raises:
        UnusableReply: it is withheld, cut off, empty or far too long; the reason goes back to the model.
    """
    if answer.finish == "content_filter":
        raise UnusableReply("withheld", "The reply was withheld by a content filter: describe the scene in neutral words.", reply)
    if answer.finish == "length":
        raise UnusableReply("cut_off", f"The reply was cut off after {max_tokens} tokens: write shorter fields.", reply)
    if not answer.text.strip():
        raise UnusableReply("empty", "The reply is empty: answer with one JSON object.", reply)
    if len(answer.text) > MAX_REPLY_CHARS:
        reason = f"The reply has {len(answer.text):,} characters, at most {MAX_REPLY_CHARS:,} are read: write shorter fields."
        raise UnusableReply("too_long", reason, reply)
    return reply
