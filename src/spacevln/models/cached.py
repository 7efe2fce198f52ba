"""A content-addressed cache of replies: a run that changed one thing asks only the calls that this thing changes."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from spacevln.core import ChatModel, ChatReply, ChatRequest, RecordError, ReplySource
from spacevln.models.choice import ModelChoice

_REPLY = TypeAdapter(ChatReply)


class CachedModel:
    """Answers from files where the same call was answered before, else asks and keeps the reply.

    The key is everything that decides the reply: server, model, sampling settings, the request's digest, and how often this
    episode has asked exactly this before, so that asking again after a refusal does not bring the refused reply back.

    Args:
        model: asked for what is not known.
        choice: of that model.
        directory: of the files; shared by runs and workers.
    """

    def __init__(self, model: ChatModel, choice: ModelChoice, directory: Path) -> None:
        self._model = model
        self._directory = directory
        fixed = choice.model_copy(update={"base_url": choice.url, "price": None, "retry": None})
        self._identity = fixed.model_dump_json()
        self._asked: Counter[str] = Counter()

    @property
    def name(self) -> str:
        """Of the model inside."""
        return self._model.name

    def complete(self, request: ChatRequest) -> ChatReply:
        """The kept reply, at no cost and no time, or a fresh one."""
        digest = request.digest
        self._asked[digest] += 1
        key = hashlib.sha256(f"{self._identity} {digest} {self._asked[digest]}".encode()).hexdigest()
        path = self._directory / key[:2] / f"{key}.json"
        known = _load(path)
        if known is not None:
            return replace(known, source=ReplySource.CACHE, usd=0.0, latency_s=0.0, attempts=0)
        reply = self._model.complete(request)
        _save(path, reply)
        return reply


def _load(path: Path) -> ChatReply | None:
    try:
        return _REPLY.validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValidationError) as error:
        raise RecordError(f"The kept reply {str(path)!r} cannot be read: delete it or give another --reply-cache.") from error


def _save(path: Path, reply: ChatReply) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("wb", dir=path.parent, delete=False) as file:
            file.write(json.dumps(_REPLY.dump_python(reply, mode="json"), ensure_ascii=False, indent=1).encode())
            os.fsync(file.fileno())
        Path(file.name).replace(path)
    except OSError as error:
        raise RecordError(
            f"Cannot keep a reply in {str(path.parent)!r} ({error.strerror}): give a writable --reply-cache."
        ) from error
