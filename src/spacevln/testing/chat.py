"""A scripted chat model: what a test lets a model say, and what it was asked."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from spacevln.core import ChatReply, ChatRequest, ReplyMode, Usage

Said = str | Mapping[str, Any] | ChatReply
ChatLine = Said | Exception | Callable[[ChatRequest], Said]


@dataclass
class ScriptedChatModel:
    """Replies line by line; the last line is repeated.

    A string or a mapping (written as JSON) is said, an exception is raised, a function is called with the request.

    Args:
        script: at least one line.
        name: of the model.
        requests: every request it was given, for the test to read.
    """

    script: Sequence[ChatLine]
    name: str = "scripted"
    requests: list[ChatRequest] = field(default_factory=list)

    def complete(self, request: ChatRequest) -> ChatReply:
        """The next line."""
        line = self.script[min(len(self.requests), len(self.script) - 1)]
        self.requests.append(request)
        if isinstance(line, Exception):
            raise line
        said = line(request) if callable(line) else line
        if isinstance(said, ChatReply):
            return said
        text = said if isinstance(said, str) else json.dumps(said, ensure_ascii=False)
        return ChatReply(text=text, model=self.name, mode=ReplyMode.TEXT, usage=estimated_usage(request, text), usd=0.0)


def estimated_usage(request: ChatRequest, reply: str) -> Usage:
    """Tokens as a rule of thumb: four characters each, 85 for a picture."""
    words = sum(len(message.text) for message in request.messages)
    return Usage(input_tokens=words // 4 + 85 * len(request.images), output_tokens=len(reply) // 4)
