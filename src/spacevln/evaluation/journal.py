"""How often an episode was begun and how often its worker died: ``attempts.jsonl`` in its directory, only ever appended.

The file is also the lock of the attempt: whoever runs the episode holds it, so that a worker whose runner was killed cannot write
into the record of the attempt that replaces it.
"""

from __future__ import annotations

import fcntl
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from spacevln.core import RecordError
from spacevln.recording.record import Record

NAME = "attempts.jsonl"


class AttemptLine(Record):
    """An attempt began, or the worker in it died."""

    event: Literal["started", "died"]
    at: str
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Journal:
    """The attempts at one episode so far.

    Args:
        starts: attempts that were begun, whatever became of them.
        deaths: of workers inside them.
        last_death: how the last one died; ``""`` for none.
    """

    starts: int = 0
    deaths: int = 0
    last_death: str = ""

    @classmethod
    def read(cls, folder: Path) -> Journal:
        """The journal of an episode's directory; empty where there is none.

        A line that a killed process left unfinished counts as a start: that is the line that is written most.
        """
        path = folder / NAME
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.exists() else []
        starts = deaths = 0
        last = ""
        for text in lines:
            try:
                line = AttemptLine.model_validate_json(text)
            except ValidationError:
                starts += 1
                continue
            if line.event == "died":
                deaths, last = deaths + 1, line.detail
            else:
                starts += 1
        return cls(starts, deaths, last)


def note(folder: Path, event: Literal["started", "died"], detail: str = "") -> None:
    """Append a line.

    Raises:
        RecordError: the disk refuses.
    """
    line = AttemptLine(event=event, at=datetime.now(UTC).isoformat(timespec="milliseconds"), detail=detail)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / NAME).open("a+b") as file:
            file.seek(0, 2)
            if file.tell():
                file.seek(-1, 2)
                if file.read(1) != b"\n":
                    file.write(b"\n")
            file.write(line.model_dump_json().encode() + b"\n")
    except OSError as error:
        raise RecordError(f"Cannot write in {str(folder)!r} ({error.strerror}): free space or give a writable --out.") from error


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold an episode's directory for one attempt, and clear away what an unfinished one left.

    Waits for a worker that still holds it: one whose runner was killed ends within a moment.

    Raises:
        RecordError: the disk refuses.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / NAME).open("ab") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            if not (folder / "result.json").exists():
                for left in folder.iterdir():
                    if left.is_dir():
                        shutil.rmtree(left)
                    elif left.name != NAME:
                        left.unlink()
            yield
    except OSError as error:
        raise RecordError(f"Cannot write in {str(folder)!r} ({error.strerror}): free space or give a writable --out.") from error
