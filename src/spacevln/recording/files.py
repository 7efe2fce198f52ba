"""Whole files of a record: written atomically, read with a sentence when they are damaged."""

from __future__ import annotations

import contextlib
import os
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from spacevln.core import RecordError
from spacevln.recording.record import Record
from spacevln.recording.schema import EVENT_LINE, EventLine, ResultFile

R = TypeVar("R", bound=Record)


def write_file(path: Path, content: Record, *, first_stands: bool = False) -> None:
    """Write a JSON file so that a reader sees all of it or nothing.

    Args:
        path: of the file; its folder exists.
        content: what to write.
        first_stands: an existing file is kept, as for results.

    Raises:
        RecordError: the disk refuses.
    """
    temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex}")  # not tempfile's, which others could not read
    try:
        try:
            with temporary.open("x", encoding="utf-8") as file:
                file.write(content.model_dump_json(indent=2) + "\n")
                file.flush()
                os.fsync(file.fileno())
            if first_stands:
                with contextlib.suppress(FileExistsError):
                    os.link(temporary, path)
            else:
                temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise RecordError(f"Cannot write {str(path)!r} ({error.strerror}): free space or give a writable --out.") from error


def read_file(path: Path, kind: type[R]) -> R:
    """Read a JSON file of the record.

    Raises:
        RecordError: it is missing, damaged, or of another format.
    """
    try:
        return kind.model_validate_json(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordError(f"Cannot read {str(path)!r} ({error.strerror}): give the directory of a run.") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"]) or "the file"
        raise RecordError(f"{str(path)!r} is no {kind.__name__} of this version: {place}: {first['msg']}.") from error


def read_events(directory: Path) -> Iterator[EventLine]:
    """The events of an episode, oldest first. A last line that a killed process left unfinished is left out.

    Raises:
        RecordError: the file is missing, or a line other than the last is damaged.
    """
    path = directory / "events.jsonl"
    try:
        lines = path.read_bytes().splitlines(keepends=True)  # bytes: text also breaks at U+2028, which a reply may hold
    except OSError as error:
        raise RecordError(f"Cannot read {str(path)!r} ({error.strerror}): give the directory of an episode.") from error
    for number, line in enumerate(lines, start=1):
        try:
            yield EVENT_LINE.validate_json(line)
        except ValidationError as error:
            if number == len(lines) and not line.endswith(b"\n"):
                return
            first = error.errors()[0]
            raise RecordError(f"{str(path)!r} line {number} is damaged: {first['msg']}.") from error


def episode_directory(run: Path, episode_id: str) -> Path:
    """Where an episode's record lies inside a run directory; any id gives a safe folder name."""
    safe = "".join(char if char.isalnum() or char in "-_." else f"%{ord(char):02x}" for char in episode_id).lstrip(".") or "%"
    return run / "episodes" / safe


def read_result(directory: Path) -> ResultFile | None:
    """The result of an episode, or None when there is none yet."""
    path = directory / "result.json"
    return read_file(path, ResultFile) if path.exists() else None
