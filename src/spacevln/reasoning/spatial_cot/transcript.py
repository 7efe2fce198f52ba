"""Asking a chat model, with the refused replies of the question, so that it is told what it wrote and why that cannot be used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from spacevln.core import ChatModel, ChatRequest, Message, Part, Speaker, TextPart
from spacevln.reasoning.spatial_cot.templating import render

MAX_SHOWN_CHARS = 6000  # of a refused reply; a longer one is no use to anybody


@dataclass(frozen=True, slots=True)
class Refusal:
    """One refused reply.

    Args:
        text: as it was written; ``""`` when none came through.
        reasons: what the model is told.
    """

    text: str
    reasons: tuple[str, ...]


class Transcript:
    """Asks a chat model, and remembers its replies to the same query for as long as they are refused.

    Args:
        model: answers.
    """

    def __init__(self, model: ChatModel) -> None:
        self._model = model
        self._replies: list[tuple[str, int]] = []  # text, and how many reasons there were before it

    def ask(self, request: Callable[[tuple[Refusal, ...]], ChatRequest], rejections: tuple[str, ...]) -> str:
        """The reply's text.

        Args:
            request: makes the question from what was refused so far.
            rejections: of the context, oldest first; none begins a new query.

        Raises:
            ReplyRejected, ModelError, SpendingLimit: of the model.
        """
        question = request(self._refusals(rejections))
        self._replies.append(("", len(rejections)))  # stays empty where no reply comes through
        text = self._model.complete(question).text
        self._replies[-1] = (text, len(rejections))
        return text

    def _refusals(self, rejections: tuple[str, ...]) -> tuple[Refusal, ...]:
        if not rejections:
            self._replies.clear()
            return ()
        if not self._replies:
            return (Refusal("", rejections),)
        ends = [*(start for _, start in self._replies[1:]), len(rejections)]
        return tuple(Refusal(text, rejections[start:end]) for (text, start), end in zip(self._replies, ends, strict=True))

    def clear(self) -> None:
        """Forget everything."""
        self._replies.clear()


def conversation(static: tuple[Part, ...], call: tuple[Part, ...], refusals: tuple[Refusal, ...]) -> tuple[Message, ...]:
    """The messages of a request: the static part, the call, then every refused reply with its reasons.

    What came before stays byte-identical from one re-asking to the next, so that prompt caches hold the pictures.
    """
    messages = [Message(Speaker.SYSTEM, static, static=True), Message(Speaker.USER, call)]
    for refusal in refusals:
        answer = render("refused", reasons=refusal.reasons)
        if refusal.text:
            shown = refusal.text if len(refusal.text) <= MAX_SHOWN_CHARS else refusal.text[:MAX_SHOWN_CHARS] + " ..."
            messages += [Message(Speaker.ASSISTANT, (TextPart(shown),)), Message(Speaker.USER, answer)]
        else:
            messages[-1] = Message(Speaker.USER, (*messages[-1].parts, *answer))
    return tuple(messages)
