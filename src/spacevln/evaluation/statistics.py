"""Intervals and paired comparisons over episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLES = 2000
PERMUTATIONS = 9999


@dataclass(frozen=True, slots=True)
class Interval:
    """A mean and its 95 % percentile bootstrap interval over episodes.

    Args:
        mean: nan for no values.
        low, high: None where fewer than two values say nothing about the spread.
        count: values.
    """

    mean: float
    low: float | None
    high: float | None
    count: int


def interval(values: Sequence[float], *, seed: int = 0) -> Interval:
    """The mean of some values with its interval; the same values give the same interval."""
    if not values:
        return Interval(float("nan"), None, None, 0)
    data = np.asarray(values, dtype=float)
    mean = float(data.mean())
    if len(data) < 2:
        return Interval(mean, None, None, len(data))
    if np.all(data == data[0]):  # resampling cannot differ
        return Interval(mean, mean, mean, len(data))
    from scipy.stats import bootstrap  # slow to import, and not needed to run episodes

    found = bootstrap((data,), np.mean, n_resamples=RESAMPLES, method="percentile", rng=np.random.default_rng(seed))
    return Interval(mean, float(found.confidence_interval.low), float(found.confidence_interval.high), len(data))


@dataclass(frozen=True, slots=True)
class Paired:
    """A metric of two runs on the same episodes.

    Args:
        count: episodes that have it in both.
        first, second: means.
        difference: of second and first, with its interval.
        p_value: two-sided; exact McNemar test for a metric of two values, such as success, else a sign-flip permutation test;
            None for no episodes.
        gained, lost: episodes in which second is larger, and smaller.
    """

    count: int
    first: float
    second: float
    difference: Interval
    p_value: float | None
    gained: tuple[str, ...]
    lost: tuple[str, ...]


def paired(first: Mapping[str, float], second: Mapping[str, float]) -> Paired:
    """Compare the values of two runs by episode id; episodes that only one of them has are left out."""
    names = [name for name in first if name in second]
    a, b = np.array([first[name] for name in names]), np.array([second[name] for name in names])
    steps = b - a
    return Paired(
        count=len(names),
        first=float(a.mean()) if names else float("nan"),
        second=float(b.mean()) if names else float("nan"),
        difference=interval(steps.tolist()),
        p_value=_p_value(a, b) if names else None,
        gained=tuple(name for name, step in zip(names, steps, strict=True) if step > 0),
        lost=tuple(name for name, step in zip(names, steps, strict=True) if step < 0),
    )


def _p_value(a: np.ndarray, b: np.ndarray) -> float:
    from scipy.stats import binomtest, permutation_test

    steps = b - a
    gained, lost = int((steps > 0).sum()), int((steps < 0).sum())
    if gained + lost == 0:
        return 1.0
    if len(np.unique(np.concatenate([a, b]))) <= 2:
        return float(binomtest(gained, gained + lost).pvalue)
    if len(steps) < 2:
        return 1.0  # one episode says nothing
    found = permutation_test(
        (steps,), np.mean, permutation_type="samples", n_resamples=PERMUTATIONS, rng=np.random.default_rng(0)
    )
    return float(found.pvalue)
