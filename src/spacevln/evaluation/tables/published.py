"""The published rows of the paper's tables (``published.json``), with their source."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from pydantic import BaseModel, ConfigDict, Field


class _Published(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class PublishedRow(_Published):
    """A row as it is printed.

    Args:
        method: its name.
        citation: BibTeX key in the paper; ``""`` for the paper's own method.
        group: heading over the row; ``""`` for none.
        own: it is a row of the paper's method.
        flags: its check marks, e.g. TF (training-free) and ZS (zero-shot).
        values: by ``"<block>:<metric>"``, a block being a benchmark or an area; what the paper does not give is missing.
    """

    method: str
    citation: str
    group: str
    own: bool
    flags: dict[str, bool] = Field(default_factory=dict)
    values: dict[str, float]


class PublishedTable(_Published):
    """A table as it is printed.

    Args:
        paper: its place.
        label: its LaTeX label there.
        caption: what it shows.
        totals: episodes by block, where the table gives counts.
        rows: in order.
    """

    paper: str
    label: str
    caption: str
    totals: dict[str, int] = Field(default_factory=dict)
    rows: tuple[PublishedRow, ...]


class _File(_Published):
    source: str
    tables: dict[str, PublishedTable]


@cache
def _file() -> _File:
    return _File.model_validate_json(files(__package__).joinpath("published.json").read_text(encoding="utf-8"))


def published(name: str) -> PublishedTable | None:
    """The published table of a shape; None where the paper has none."""
    return _file().tables.get(name)


def source() -> str:
    """Where the published rows come from."""
    return _file().source
