"""Episodes of every benchmark and suite as one type, ground truth kept apart (DESIGN 5.8)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from spacevln.core import UnknownNameError
from spacevln.evaluation.datasets.files import DatasetError
from spacevln.evaluation.datasets.filters import Filters
from spacevln.evaluation.datasets.selection import BENCHMARKS, HOUSES_SUITES, SPLITS, SUITES, Probe, Selection
from spacevln.evaluation.datasets.sequence import EpisodeSequence, Source

__all__ = [
    "BENCHMARKS",
    "HOUSES_SUITES",
    "SPLITS",
    "SUITES",
    "DatasetError",
    "EpisodeSequence",
    "Filters",
    "Probe",
    "Selection",
    "Source",
    "load",
]


def load(name: str, path: str | Path | None = None, *, split: str | None = None, **filters: Any) -> EpisodeSequence:
    """The episodes of a benchmark or suite.

    >>> load("houses-vln", split="dev", slice="0:2").ids
    ('houses-vln_dev-000', 'houses-vln_dev-001')

    Args:
        name: one of :data:`SUITES`.
        path: file or folder of the data; the houses suites need none.
        split: one of the suite's :data:`SPLITS`, by default the first; ``"paper"`` is the subset of the paper's tables.
        filters: fields of :class:`Filters`, and ``seeds``, ``episodes``, ``probe`` of :class:`Selection`.

    Raises:
        UsageError: a name or filter is unknown, the selection is empty, or a file is damaged (:class:`DatasetError`).
        PrerequisiteError: the data, or the library that reads it, is missing.
    """
    own = {key: filters.pop(key) for key in ("seeds", "episodes", "probe") if key in filters}
    unknown = sorted(set(filters) - set(Filters.model_fields))
    if unknown:
        raise UnknownNameError("filter", unknown[0], (*Filters.model_fields, "seeds", "episodes", "probe"))
    chosen = Selection(suite=name, split=split, path=Path(path) if path is not None else None, filters=Filters.of(filters), **own)
    return chosen.load()
