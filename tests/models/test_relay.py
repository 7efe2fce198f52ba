"""The relay: a request is a folder that a person can read, a reply is a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from chatting import JPEG, SCHEMA, request

from spacevln.core import ModelError, ReplyMode, Role
from spacevln.models import RelayModel


class Writer:
    """Writes the reply, in two halves, while the model sleeps."""

    def __init__(self, directory: Path, text: str) -> None:
        self.directory, self.text, self.polls = directory, text, 0

    def sleep(self, _seconds: float) -> None:
        self.polls += 1
        (folder,) = [path.parent for path in self.directory.glob("*/request.md") if not (path.parent / "done").exists()]
        half = len(self.text) // 2
        if self.polls == 2:
            (folder / "reply.txt").write_text(self.text[:half])
        elif self.polls == 3:
            (folder / "reply.txt").write_text(self.text)
        elif self.polls == 4:
            (folder / "done").touch()


def test_a_request_is_readable_and_complete(tmp_path: Path) -> None:
    writer = Writer(tmp_path, '{"action": "left"}')
    reply = RelayModel(tmp_path, sleep=writer.sleep).complete(request("Where is the sofa?"))
    assert reply.text == '{"action": "left"}'  # not the half that was there first
    assert (reply.mode, reply.usd, reply.model) == (ReplyMode.TEXT, 0.0, "relay")
    folder = tmp_path / "0001_planner"
    text = (folder / "request.md").read_text()
    assert text.index("You navigate.") < text.index("Where is the sofa?") < text.index("![view front](01_view-front.jpg)")
    assert "the same in every call" in text
    assert (folder / "01_view-front.jpg").read_bytes() == JPEG
    assert json.loads((folder / "schema.json").read_text()) == SCHEMA.schema


def test_requests_are_numbered_on_in_a_folder_that_is_used_again(tmp_path: Path) -> None:
    for number, role in enumerate([Role.PLANNER, Role.EXECUTOR], start=1):
        RelayModel(tmp_path, sleep=Writer(tmp_path, "yes").sleep).complete(request(role=role, reply_schema=None))
        assert (tmp_path / f"{number:04d}_{role}" / "request.md").exists()
    assert "Write the answer into" in (tmp_path / "0002_executor" / "request.md").read_text()


def test_a_stop_file_ends_the_episode_in_a_controlled_way(tmp_path: Path) -> None:
    model = RelayModel(tmp_path, sleep=lambda _: (tmp_path / "stop").touch())
    with pytest.raises(ModelError, match="stopped by the file"):
        model.complete(request())


def test_a_silent_relay_times_out(tmp_path: Path) -> None:
    now = [0.0]

    def sleep(seconds: float) -> None:
        now[0] += seconds

    with pytest.raises(ModelError, match="within 5 s"):
        RelayModel(tmp_path, timeout_s=5, sleep=sleep, clock=lambda: now[0]).complete(request())
