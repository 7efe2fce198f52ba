"""Classes of failed episodes, from their results alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from spacevln.recording import ResultFile

NEAR_M = 6.0
"""A STOP that misses a route's 3 m by less than as much again was near."""

CLASSES = (
    "model failure",
    "environment failure",
    "safety stop",
    "goal unreachable",
    "passed the goal",
    "out of steps",
    "stopped near the goal",
    "stopped elsewhere",
)


def failure_class(result: ResultFile) -> str | None:
    """Why an episode counts as failed; None for a success, and where there is no truth.

    The first that applies, in the order of :data:`CLASSES`; ``"passed the goal"`` is an oracle success.
    """
    metrics = result.metrics
    if metrics.SR is None or metrics.SR == 1.0:
        return None
    by_status = {"model_failure": CLASSES[0], "environment_failure": CLASSES[1], "safety": CLASSES[2]}
    if result.status in by_status:
        return by_status[result.status]
    if metrics.NE is None:
        return CLASSES[3]
    if metrics.OSR == 1.0:
        return CLASSES[4]
    if result.stop_reason == "budget":
        return CLASSES[5]
    return CLASSES[6] if metrics.NE < NEAR_M else CLASSES[7]


def count_failures(results: Iterable[ResultFile]) -> dict[str, int]:
    """Failed episodes by class, every class named."""
    found = Counter(name for result in results if (name := failure_class(result)) is not None)
    return {name: found[name] for name in CLASSES}
