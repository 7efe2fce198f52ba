"""Means over every attempted episode (DESIGN 5.8)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

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
    return SummaryFile(
        episodes=len(results),
        metrics=means,
        statuses=dict(sorted(Counter(str(result.status) for result in results).items())),
        stop_reasons=dict(sorted(Counter(str(result.stop_reason) for result in results).items())),
        rejections=sum(result.metrics.rejections for result in results),
        fallbacks=sum(result.metrics.fallbacks for result in results),
        unreachable=sum(result.metrics.NE is None for result in judged),
        usage=total(result.usage for result in results),
    )


def _mean(values: Sequence[float | None], scale: float = 1.0) -> float | None:
    present = [value for value in values if value is not None]
    return round(scale * float(np.mean(present)), 4) if present else None
