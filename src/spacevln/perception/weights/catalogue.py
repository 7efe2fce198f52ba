"""The models that perception can use, from ``data/models.toml``: files, addresses, licences, checksums."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from types import MappingProxyType
from typing import Any, Literal

from spacevln.core import UnknownNameError

Role = Literal["grounder", "segmenter"]


@dataclass(frozen=True, slots=True)
class PublishedFile:
    """One file of a model.

    Args:
        name: in the model's folder.
        url: where it is published.
        size: bytes; None where only the server knows.
        sha256: as published; None where the server's own statement is all there is.
    """

    name: str
    url: str
    size: int | None = None
    sha256: str | None = None


@dataclass(frozen=True, slots=True)
class PublishedModel:
    """A model.

    Args:
        name: of the model and of its folder.
        role: what it does.
        about: in a line.
        licence: of the weights.
        source: web address that people can look at.
        files: all that it needs.
    """

    name: str
    role: Role
    about: str
    licence: str
    source: str
    files: tuple[PublishedFile, ...]

    @property
    def size(self) -> int | None:
        """Bytes as far as they are known; None when nothing is."""
        known = [file.size for file in self.files if file.size is not None]
        return sum(known) if known else None


@lru_cache(maxsize=1)
def catalogue() -> Mapping[str, PublishedModel]:
    """Every model by its name, in the order of the file."""
    text = resources.files("spacevln.perception.weights").joinpath("data/models.toml").read_text(encoding="utf-8")
    return MappingProxyType({name: _model(name, entry) for name, entry in tomllib.loads(text).items()})


def published_model(name: str) -> PublishedModel:
    """A model.

    Raises:
        UnknownNameError: there is none of this name.
    """
    models = catalogue()
    if name not in models:
        raise UnknownNameError("model", name, models)
    return models[name]


def _model(name: str, entry: Mapping[str, Any]) -> PublishedModel:
    address = f"{entry['site']}/{entry['path']}"
    files = [PublishedFile(file, f"{address}/{file}") for file in entry.get("small", ())]
    files += [
        PublishedFile(file["name"], f"{address}/{file['name']}", file.get("size"), file.get("sha256")) for file in entry["files"]
    ]
    source = f"{entry['site']}/{'/'.join(entry['path'].split('/')[:2])}"
    return PublishedModel(name, entry["what"], entry["about"], entry["licence"], source, tuple(files))
