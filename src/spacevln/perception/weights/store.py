"""The folder that holds downloaded weights, and whether its files are what they should be."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from spacevln.core import PrerequisiteError
from spacevln.perception.weights.catalogue import PublishedFile, PublishedModel, published_model

FOLDER_VARIABLE = "SPACEVLN_MODELS"
"""Environment variable that names the folder."""

SEALS = "checksums.json"
"""What was downloaded, by file name: checksum and size; beside the files."""

CHUNK = 1 << 20


class FileState(StrEnum):
    """What is known of a file."""

    PRESENT = "present"
    PARTIAL = "partial"
    MISSING = "missing"
    DAMAGED = "damaged"
    UNSEALED = "unsealed"  # there, with nothing to compare it with


@dataclass(frozen=True, slots=True)
class ModelState:
    """What is known of a model's files, by name."""

    files: Mapping[str, FileState]

    @property
    def complete(self) -> bool:
        """Whether it can be opened."""
        return all(state in (FileState.PRESENT, FileState.UNSEALED) for state in self.files.values())


@dataclass(frozen=True, slots=True)
class WeightStore:
    """A folder with one sub-folder per model.

    Args:
        root: of all models.
    """

    root: Path

    @classmethod
    def default(cls) -> WeightStore:
        """``$SPACEVLN_MODELS``, else ``spacevln/models`` in the user's cache folder."""
        named = os.environ.get(FOLDER_VARIABLE)
        cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        return cls(Path(named) if named else cache / "spacevln" / "models")

    def folder(self, model: PublishedModel) -> Path:
        """Of a model."""
        return self.root / model.name

    def path(self, model: PublishedModel, file: PublishedFile) -> Path:
        """Of a file."""
        return self.folder(model) / file.name

    def open(self, name: str) -> Path:
        """The folder of a complete model.

        Raises:
            UnknownNameError: there is no such model.
            PrerequisiteError: it was not downloaded, or not to the end.
        """
        model = published_model(name)
        missing = [file.name for file in model.files if not self.path(model, file).is_file()]
        if missing:
            raise PrerequisiteError(
                f"The weights of {name} are not in {str(self.folder(model))!r} ({missing[0]} is missing): "
                f"run spacevln models download {name}."
            )
        return self.folder(model)

    def look(self, model: PublishedModel) -> ModelState:
        """What is there, by names and sizes alone."""
        return ModelState({file.name: self._look(model, file) for file in model.files})

    def verify(self, model: PublishedModel) -> ModelState:
        """What is there, every byte of it read."""
        states = dict(self.look(model).files)
        for file in model.files:
            if states[file.name] is FileState.PRESENT:
                wanted = self.expected(model, file)
                if wanted is None:
                    states[file.name] = FileState.UNSEALED
                elif checksum(self.path(model, file)) != wanted:
                    states[file.name] = FileState.DAMAGED
        return ModelState(states)

    def expected(self, model: PublishedModel, file: PublishedFile) -> str | None:
        """The checksum that a file should have: the published one, else what was sealed when it was downloaded."""
        sealed = self._seals(model).get(file.name, {}).get("sha256")
        return file.sha256 or (None if sealed is None else str(sealed))

    def seal(self, model: PublishedModel, file: PublishedFile, sha256: str, size: int) -> None:
        """Keep what was downloaded."""
        seals = self._seals(model) | {file.name: {"sha256": sha256, "size": size}}
        path = self.folder(model) / SEALS
        partial = path.with_suffix(".part")
        partial.write_text(json.dumps(seals, indent=1, sort_keys=True), encoding="utf-8")
        partial.replace(path)

    def _look(self, model: PublishedModel, file: PublishedFile) -> FileState:
        path = self.path(model, file)
        if not path.is_file():
            return FileState.PARTIAL if partial_of(path).exists() else FileState.MISSING
        size = file.size or self._seals(model).get(file.name, {}).get("size")
        return FileState.DAMAGED if size is not None and path.stat().st_size != size else FileState.PRESENT

    def _seals(self, model: PublishedModel) -> dict[str, dict[str, str | int]]:
        path = self.folder(model) / SEALS
        if not path.is_file():
            return {}
        try:
            loaded = json.loads(path.read_text(encoding="utf-8"))
        except ValueError:
            return {}  # then its files count as unsealed
        return loaded if isinstance(loaded, dict) else {}


def partial_of(path: Path) -> Path:
    """Where a download grows."""
    return path.with_name(path.name + ".part")


def checksum(path: Path) -> str:
    """SHA-256 of a file."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(CHUNK):
            digest.update(block)
    return digest.hexdigest()
