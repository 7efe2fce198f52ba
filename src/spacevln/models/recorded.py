"""Answers an episode's calls from its record: the offline replay at the model boundary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from spacevln.core import ChatReply, ChatRequest, ModelError, ReplySource, Role
from spacevln.models.dialect import UnusableReply


class ReplayDiverged(ModelError):  # noqa: N818 - the word of the report
    """The replay asks something that the record does not answer."""


@dataclass(frozen=True, slots=True)
class RecordedCall:
    """One call of a record.

    Args:
        role: who asked.
        digest: of the request.
        reply: what came; None when nothing did.
        problem: ``""``, the kind of a refused reply, or ``"failed"``.
        detail: reason of the refusal, or message of the failure.
    """

    role: Role
    digest: str
    reply: ChatReply | None
    problem: str = ""
    detail: str = ""


class RecordedModel:
    """Replays one role's calls in their order.

    Args:
        role: planner or executor.
        calls: of the whole episode.
        model: name of the model that answered.
        strict: whether a request that differs from the recorded one is refused; otherwise the next reply is given whatever is
            asked (for records whose prompts were made by another version).
    """

    def __init__(self, role: Role, calls: Sequence[RecordedCall], model: str = "recorded", *, strict: bool = True) -> None:
        self._role = role
        self._calls = [call for call in calls if call.role is role]
        self._model = model
        self._strict = strict
        self._next = 0
        self.differing = 0

    @property
    def name(self) -> str:
        """Of the model that answered."""
        return self._model

    def complete(self, request: ChatRequest) -> ChatReply:
        """The recorded reply, refusal or failure of this call.

        Raises:
            ReplayDiverged: the record holds no such call.
        """
        number = self._next + 1
        if self._next >= len(self._calls):
            raise ReplayDiverged(f"The replay asks the {self._role} a {number}. time, the record holds {len(self._calls)} calls.")
        call = self._calls[self._next]
        self._next += 1
        if call.digest != request.digest:
            self.differing += 1
            if self._strict:
                raise ReplayDiverged(
                    f"The replay's {self._role} call {number} differs from the recorded one (request {request.digest[:12]} "
                    f"instead of {call.digest[:12]}): replay with the recorded version, or allow other requests with --loose."
                )
        if call.reply is None:
            raise ModelError(call.detail)
        reply = replace(call.reply, source=ReplySource.RECORD, usd=0.0, latency_s=0.0, attempts=0)
        if call.problem:
            raise UnusableReply(call.problem, call.detail, reply)
        return reply
