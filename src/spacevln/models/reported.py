"""Tells the run's listeners about every call, so that recording and display see it; changes nothing."""

from __future__ import annotations

from collections.abc import Callable

from spacevln.core import CallRetried, ChatModel, ChatReply, ChatRequest, Event, ModelCalled, ModelError, ReplyRejected, Role
from spacevln.models.dialect import UnusableReply
from spacevln.models.retry import Retried


class ReportedModel:
    """A chat model whose calls become :class:`ModelCalled` events.

    Args:
        model: that answers.
        emit: takes the events.
    """

    def __init__(self, model: ChatModel, emit: Callable[[Event], None]) -> None:
        self._model = model
        self._emit = emit

    @property
    def name(self) -> str:
        """Of the model inside."""
        return self._model.name

    def complete(self, request: ChatRequest) -> ChatReply:
        """Answer, and tell."""
        try:
            reply = self._model.complete(request)
        except ReplyRejected as refusal:
            came = refusal.reply if isinstance(refusal, UnusableReply) else None
            self._emit(ModelCalled(self.name, request, came, refusal.kind, refusal.reason))
            raise
        except ModelError as failure:
            self._emit(ModelCalled(self.name, request, None, "failed", str(failure)))
            raise
        self._emit(ModelCalled(self.name, request, reply))
        return reply


def retry_teller(role: Role, model: str, emit: Callable[[Event], None]) -> Callable[[Retried], None]:
    """A listener for retries that turns them into :class:`CallRetried` events."""

    def tell(retried: Retried) -> None:
        failure = retried.failure
        emit(CallRetried(role, model, retried.attempt, failure.kind, failure.detail, retried.wait_s))

    return tell
