"""Finds the one JSON object in what a chat model wrote. Strict: what is ambiguous is refused, nothing is repaired."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from spacevln.core.errors import ReplyRejected

_FENCE = re.compile(r"```[a-zA-Z]*\s*\n(.*?)```", re.DOTALL)
_THOUGHT = re.compile(r"\A\s*<think>.*?</think>", re.DOTALL)
_DECODER = json.JSONDecoder(
    parse_constant=lambda name: _refuse(f"the reply contains {name}, which is no JSON number: write a finite number")
)


class Found(StrEnum):
    """Where in the reply the object stood; all but ``WHOLE`` are worth counting."""

    WHOLE = "whole"
    FENCED = "fenced"
    PROSE = "prose"


@dataclass(frozen=True, slots=True)
class JsonReply:
    """A JSON object and where it was found."""

    value: dict[str, Any]
    found: Found


def read_object(text: str) -> JsonReply:
    """The JSON object in a reply: the whole text, else the one fenced block, else the one object in the prose.

    Raises:
        ReplyRejected: of kind ``parse``: there is none, it is cut off or malformed, or there is more than one.
    """
    body = _THOUGHT.sub("", text).strip().removeprefix("\ufeff")
    if not body:
        _refuse("the reply is empty: answer with one JSON object")
    if body.startswith("{"):
        value, end = _decode(body, 0)
        if not body[end:].strip():
            return JsonReply(value, Found.WHOLE)
    blocks = [block.strip() for block in _FENCE.findall(body)]
    objects = [block for block in blocks if block.startswith("{")]
    if len(objects) == 1:
        value, end = _decode(objects[0], 0)
        if not objects[0][end:].strip():
            return JsonReply(value, Found.FENCED)
    return JsonReply(_only_object(body), Found.PROSE)


def _only_object(body: str) -> dict[str, Any]:
    found: list[dict[str, Any]] = []
    position = body.find("{")
    while position >= 0:
        value, position = _decode(body, position)
        if value not in found:
            found.append(value)
        position = body.find("{", position)
    if not found:
        _refuse("the reply holds no JSON object: answer with one JSON object and nothing else")
    if len(found) > 1:
        _refuse(f"the reply holds {len(found)} different JSON objects: answer with exactly one")
    return found[0]


def _decode(body: str, position: int) -> tuple[dict[str, Any], int]:
    try:
        value, end = _DECODER.raw_decode(body, position)
    except json.JSONDecodeError as error:
        cut = error.pos >= len(body.rstrip()) or error.msg.startswith("Unterminated")
        what = "is cut off" if cut else f"is malformed at character {error.pos} ({error.msg})"
        _refuse(f"the JSON object {what}: answer with one complete JSON object")
    except RecursionError:
        _refuse("the JSON object is nested too deeply: answer with the fields that were asked for")
    return value, end


def _refuse(reason: str) -> Any:
    raise ReplyRejected("parse", reason[0].upper() + reason[1:] + ".")
