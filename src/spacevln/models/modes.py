"""Which reply shapes a server can promise: found out once, remembered on this machine, shown by ``spacevln doctor``."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from spacevln.core import ReplyMode

LADDER = (ReplyMode.JSON_SCHEMA, ReplyMode.JSON_OBJECT, ReplyMode.TEXT)


def memory_path() -> Path:
    """Where it is remembered: ``SPACEVLN_CACHE_DIR``, else the user's cache folder."""
    root = os.environ.get("SPACEVLN_CACHE_DIR")
    if root:
        return Path(root) / "reply-modes.json"
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "spacevln" / "reply-modes.json"


class ModeMemory:
    """Modes by server and model.

    Args:
        path: of the file; None = :func:`memory_path`.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or memory_path()
        self._here: dict[str, str] = {}  # of this process, should the file not be writable

    def recall(self, url: str, model: str) -> ReplyMode | None:
        """The mode that worked before; None when the server is new."""
        try:
            return ReplyMode((self._load() | self._here)[f"{url} {model}"])
        except (KeyError, ValueError):
            return None

    def remember(self, url: str, model: str, mode: ReplyMode) -> None:
        """Keep it for the next process. A folder that cannot be written only means that it is found out again."""
        self._here[f"{url} {model}"] = mode.value
        known = self._load()
        if known.get(f"{url} {model}") != mode.value:
            self._save(known | {f"{url} {model}": mode.value})

    def forget(self, url: str, model: str) -> None:
        """Find it out again at the next call."""
        self._here.pop(f"{url} {model}", None)
        known = self._load()
        if known.pop(f"{url} {model}", None) is not None:
            self._save(known)

    def _save(self, known: dict[str, str]) -> None:
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile("w", dir=self._path.parent, delete=False, encoding="utf-8") as file:
                json.dump(known, file, indent=1, sort_keys=True)
            Path(file.name).replace(self._path)
        except OSError:
            return

    def _load(self) -> dict[str, str]:
        try:
            known = json.loads(self._path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return known if isinstance(known, dict) else {}


def steps_down(start: ReplyMode) -> Iterator[ReplyMode]:
    """The mode and the looser ones after it."""
    yield from LADDER[LADDER.index(start) :]
