"""Every chat model passes the suite of its seam."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from chatting import asking

from spacevln.core import ChatModel
from spacevln.models import RelayModel
from spacevln.testing.chat import ScriptedChatModel
from spacevln.testing.chat_model import ChatModelConformance
from spacevln.testing.chat_server import Say, ScriptedServer


class TestScripted(ChatModelConformance):
    def make_model(self) -> ChatModel:
        return ScriptedChatModel([{"side": "left"}])


class TestRelay(ChatModelConformance):
    @pytest.fixture
    def model(self, tmp_path: Path) -> ChatModel:
        def reply(_seconds: float) -> None:
            for folder in tmp_path.iterdir():
                (folder / "reply.txt").write_text('{"side": "left"}')

        return RelayModel(tmp_path, sleep=reply)


@pytest.mark.allow_hosts(["127.0.0.1"])
class TestOverHTTP(ChatModelConformance):
    @pytest.fixture
    def model(self, tmp_path: Path) -> Iterator[ChatModel]:
        with ScriptedServer([Say({"side": "left"})]) as server, asking(server.url, tmp_path) as setting:
            yield setting.planner
