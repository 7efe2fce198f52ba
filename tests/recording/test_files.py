"""Files of a record: atomic, first result stands, damage is told in a sentence."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from spacevln.core import RecordError
from spacevln.recording import SummaryFile, episode_directory, read_events, read_file, write_file
from spacevln.recording.schema import FallbackUsedLine


def summary(episodes: int) -> SummaryFile:
    return SummaryFile(
        episodes=episodes,
        metrics={"SR": 50.0, "NE": None},
        statuses={},
        stop_reasons={},
        rejections=0,
        fallbacks=0,
        unreachable=0,
    )


def test_a_file_comes_back_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    write_file(path, summary(3))
    assert read_file(path, SummaryFile) == summary(3)
    write_file(path, summary(4))
    assert read_file(path, SummaryFile).episodes == 4
    assert [each.name for each in tmp_path.iterdir()] == ["summary.json"]


def test_the_first_result_stands(tmp_path: Path) -> None:
    path = tmp_path / "result.json"
    write_file(path, summary(1), first_stands=True)
    write_file(path, summary(2), first_stands=True)
    assert read_file(path, SummaryFile).episodes == 1
    assert [each.name for each in tmp_path.iterdir()] == ["result.json"]


def test_others_may_read_it_as_the_umask_says(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "result.json", summary(1), first_stands=True)
        write_file(tmp_path / "summary.json", summary(1))
    finally:
        os.umask(before)
    assert [stat.S_IMODE(each.stat().st_mode) for each in tmp_path.iterdir()] == [0o640, 0o640]


@pytest.mark.parametrize("content", ["", "{", '{"episodes": "many"}', '{"episodes": 1, "surprise": 2}'])
def test_a_damaged_file_is_refused_with_its_place(tmp_path: Path, content: str) -> None:
    path = tmp_path / "summary.json"
    path.write_text(content)
    with pytest.raises(RecordError, match=r"summary\.json"):
        read_file(path, SummaryFile)


def test_a_missing_directory_is_told(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="Cannot write"):
        write_file(tmp_path / "no" / "summary.json", summary(1))
    with pytest.raises(RecordError, match="Cannot read"):
        read_file(tmp_path / "summary.json", SummaryFile)


def test_an_unfinished_last_line_is_left_out_and_a_damaged_one_is_told(tmp_path: Path) -> None:
    line = FallbackUsedLine(time_s=0.5, stage=1, kind="k", detail="d").model_dump_json()
    (tmp_path / "events.jsonl").write_text(f"{line}\n{line[:20]}")
    assert [event.event for event in read_events(tmp_path)] == ["fallback_used"]
    (tmp_path / "events.jsonl").write_text(f"{line[:20]}\n{line}\n")
    with pytest.raises(RecordError, match="line 1"):
        list(read_events(tmp_path))


def test_any_text_of_a_model_is_read_back(tmp_path: Path) -> None:
    told = FallbackUsedLine(time_s=0.5, stage=1, kind="k", detail="a\u2028b\x85c\r\n\x0cd")
    line = told.model_dump_json().encode()
    (tmp_path / "events.jsonl").write_bytes(line + b"\n" + line[: line.index(b"\x80") + 1])  # killed inside a character
    assert list(read_events(tmp_path)) == [told]


@pytest.mark.parametrize("episode_id", ["../../etc", ".hidden", "a/b", "", "é 1", "plain-1"])
def test_any_id_gives_a_folder_inside_the_run(tmp_path: Path, episode_id: str) -> None:
    folder = episode_directory(tmp_path, episode_id)
    assert folder.parent == tmp_path / "episodes"
    assert folder.resolve().parent == (tmp_path / "episodes").resolve()
