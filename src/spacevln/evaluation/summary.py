"""Means over every attempted episode (DESIGN 5.8)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from spacevln.evaluation.statistics import interval
from spacevln.recording import ResultFile, SummaryFile, total

PERCENT = ("SR", "SPL", "OSR", "nDTW", "SDTW", "SoftSPL", "SR_no_stop", "SPL_no_stop", "SR_viewpoint", "SR_viewpoint_1m")
MEANS = ("NE", "oracle_NE", "path_length", "steps", "lookaround_steps", "align_steps", "collisions", "stages")


def summarise(results: Sequence[ResultFile]) -> SummaryFile:
    """The summary of a run.

    Every attempted episode counts, failures of models and environments included. ``NE`` is the mean over episodes with a
    finite distance; how many are left out is ``unreachable``. ``SR_unforced`` is SR over the episodes whose STOP was not forced.
    """
    means: dict[str, float | None] = {}
    for name in PERCENT:
        means[name] = _mean([getattr(result.metrics, name) for result in results], scale=100.0)
    for name in MEANS:
        means[name] = _mean([getattr(result.metrics, name) for result in results])
    means["SR_unforced"] = _mean([result.metrics.SR for result in results if not result.forced_stop], scale=100.0)
    judged = [result for result in results if result.truth is not None]
    found = [result.diagnosis for result in results if result.diagnosis is not None]
    return SummaryFile(
        episodes=len(results),
        metrics=means,
        statuses=dict(sorted(Counter(str(result.status) for result in results).items())),
        stop_reasons=dict(sorted(Counter(str(result.stop_reason) for result in results).items())),
        rejections=sum(result.metrics.rejections for result in results),
        fallbacks=sum(result.metrics.fallbacks for result in results),
        unreachable=sum(result.metrics.NE is None for result in judged),
        intervals=_intervals(results),
        diagnoses=_counted(diagnosis.name for diagnosis in found),
        diagnoses_paper=_counted(diagnosis.paper for diagnosis in found),
        usage=total(result.usage for result in results),
    )


def _intervals(results: Sequence[ResultFile]) -> dict[str, tuple[float, float]]:
    """The 95 % bootstrap intervals of the means that have one."""
    spreads: dict[str, tuple[float, float]] = {}
    for name in (*PERCENT, *MEANS):
        scale = 100.0 if name in PERCENT else 1.0
        values = [getattr(result.metrics, name) for result in results]
        spread = interval([scale * value for value in values if value is not None])
        if spread.low is not None and spread.high is not None:
            spreads[name] = (round(spread.low, 4), round(spread.high, 4))
    return spreads


def _counted(names: Iterable[str]) -> dict[str, int]:
    return dict(sorted(Counter(names).items()))


def _mean(values: Sequence[float | None], scale: float = 1.0) -> float | None:
    present = [value for value in values if value is not None]
    return round(scale * float(np.mean(present)), 4) if present else None
