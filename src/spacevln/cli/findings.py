"""One line of what ``spacevln doctor`` says."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the report: ``ok``, ``note`` (works, could be better) or ``missing`` (something will not work)."""

    state: str
    what: str
    mend: str = ""
