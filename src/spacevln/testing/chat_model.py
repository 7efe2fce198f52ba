"""What every chat model must do.

Run it on an own one in five lines::

    from spacevln.testing.chat_model import ChatModelConformance

    class TestMine(ChatModelConformance):
        def make_model(self): return MyModel()
"""

from __future__ import annotations

import contextlib

import pytest

from spacevln.core import ChatModel, ChatReply, ChatRequest, Message, ReplyRejected, ReplySchema, Role, Speaker, TextPart


class ChatModelConformance:
    """What every chat model must do. Subclass it, give the maker, and let pytest collect it."""

    def make_model(self) -> ChatModel:
        """A new model, ready to answer a short question."""
        raise NotImplementedError("Give make_model() in your subclass: it returns the chat model under test.")

    @pytest.fixture
    def model(self) -> ChatModel:
        """The model under test."""
        return self.make_model()

    def test_it_has_a_name(self, model: ChatModel) -> None:
        """Records and tables need one."""
        assert model.name

    @pytest.mark.parametrize("role", Role)
    def test_it_answers_a_complete_request(self, model: ChatModel, role: Role) -> None:
        """With a reply in the types of the seam, or a refusal that says why."""
        request = _question(role)
        before = request.digest
        try:
            reply = model.complete(request)
        except ReplyRejected as refusal:
            if not (refusal.kind and refusal.reason):
                pytest.fail("A refusal needs a kind and a reason.")
            return
        assert isinstance(reply, ChatReply)
        assert reply.text
        assert reply.latency_s >= 0
        assert reply.usd is None or reply.usd >= 0
        assert reply.usage.cached_tokens <= reply.usage.input_tokens
        assert request.digest == before

    def test_requests_are_independent(self, model: ChatModel) -> None:
        """There is no hidden conversation: a second request is answered as well."""
        for role in Role:
            with contextlib.suppress(ReplyRejected):
                assert isinstance(model.complete(_question(role)), ChatReply)


def _question(role: Role) -> ChatRequest:
    schema = {"type": "object", "properties": {"side": {"enum": ["left", "right"]}}, "required": ["side"]}
    words = "A sofa stands on your left. On which side is it? Answer with one JSON object with the field side: left or right."
    messages = (
        Message(Speaker.SYSTEM, (TextPart("You answer in JSON."),), static=True),
        Message(Speaker.USER, (TextPart(words),)),
    )
    return ChatRequest(role, messages, ReplySchema("side", schema), max_tokens=100)
