"""The chat seam: what identifies a request, and which JSON is read out of a reply."""

from __future__ import annotations

from typing import Any

import pytest

from spacevln.core import (
    ChatRequest,
    ContractError,
    Found,
    ImagePart,
    Message,
    ReplyRejected,
    ReplySchema,
    Role,
    Speaker,
    TextPart,
    Usage,
    UsageError,
    read_object,
)

JPEG = b"\xff\xd8\xff\xe0 picture"


def request(text: str = "Where?", **changes: Any) -> ChatRequest:
    messages = (
        Message(Speaker.SYSTEM, (TextPart("You navigate."),), static=True),
        Message(Speaker.USER, (TextPart(text), ImagePart(JPEG, "front"))),
    )
    return ChatRequest(**{"role": Role.PLANNER, "messages": messages, **changes})


def test_a_digest_tells_requests_apart_by_everything_the_model_reads() -> None:
    assert request().digest == request().digest
    others = [
        request("There?"),
        request(role=Role.EXECUTOR),
        request(max_tokens=1),
        request(reply_schema=ReplySchema("r", {"type": "object"})),
        request(messages=(*request().messages, Message(Speaker.USER, (ImagePart(JPEG + b"2"),)))),
    ]
    assert len({request().digest, *(other.digest for other in others)}) == 6


def test_a_digest_is_the_same_on_every_machine() -> None:
    assert request().digest == "717ceff16e3dbe523ef0be81a230550982413f85c98f8017854a8fb412b3d59f"


def test_the_order_of_schema_properties_counts() -> None:
    first = request(reply_schema=ReplySchema("r", {"properties": {"thought": {}, "action": {}}}))
    second = request(reply_schema=ReplySchema("r", {"properties": {"action": {}, "thought": {}}}))
    assert first.digest != second.digest


def test_static_messages_come_first() -> None:
    static, other = request().messages
    with pytest.raises(ContractError, match="static messages before"):
        ChatRequest(Role.PLANNER, (other, static))
    with pytest.raises(ContractError, match="at least one"):
        ChatRequest(Role.PLANNER, ())


def test_only_jpeg_and_png_are_pictures() -> None:
    assert ImagePart(JPEG).media_type == "image/jpeg"
    assert ImagePart(b"\x89PNG\r\n\x1a\n...").media_type == "image/png"
    with pytest.raises(UsageError, match="JPEG or PNG"):
        ImagePart(b"GIF89a", "map")


def test_usage_adds_up() -> None:
    assert sum([Usage(1, 2, 3, 4, 5), Usage(10, 20, 30, 40, 50)], Usage()) == Usage(11, 22, 33, 44, 55)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('{"a": 1}', Found.WHOLE),
        ('  {"a": 1}\n', Found.WHOLE),
        ('<think>{"a": 2}?</think>{"a": 1}', Found.WHOLE),
        ('Sure!\n```json\n{"a": 1}\n```\nDone.', Found.FENCED),
        ('I choose {"a": 1} because of the sofa.', Found.PROSE),
        ('{"a": 1}\n{"a": 1}', Found.PROSE),
    ],
)
def test_the_one_object_is_found(text: str, found: Found) -> None:
    reply = read_object(text)
    assert (reply.value, reply.found) == ({"a": 1}, found)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "empty"),
        ("Go left.", "no JSON object"),
        ('["a"]', "no JSON object"),
        ('{"a": "kit', "cut off"),
        ('{"a": [1, 2', "cut off"),
        ('{"a": 1,}', "malformed at character"),
        ("{'a': 1}", "malformed"),
        ('{"a": NaN}', "no JSON number"),
        ('{"a": 1} or {"a": 2}', "2 different"),
        ('{"a":' * 100_000, "nested|cut off"),
    ],
)
def test_anything_else_is_refused_with_a_reason(text: str, reason: str) -> None:
    with pytest.raises(ReplyRejected, match=reason) as refusal:
        read_object(text)
    assert refusal.value.kind == "parse"
