"""Intervals and paired comparisons."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.evaluation.statistics import interval, paired


def test_an_interval_holds_its_mean_and_shrinks_with_episodes() -> None:
    rng = np.random.default_rng(3)
    few, many = (interval(rng.binomial(1, 0.6, size).astype(float).tolist()) for size in (30, 3000))
    for found in (few, many):
        assert found.low is not None
        assert found.high is not None
        assert found.low <= found.mean <= found.high
    assert few.high - few.low > 4 * (many.high - many.low)
    assert many.high - many.low == pytest.approx(2 * 1.96 * math.sqrt(0.24 / 3000), rel=0.15)


def test_few_values_claim_no_interval() -> None:
    assert math.isnan(interval([]).mean)
    assert interval([1.0]).low is None
    assert interval([1.0, 1.0]).low == interval([1.0, 1.0]).high == 1.0


@given(st.lists(st.floats(0, 1), min_size=2, max_size=12))
def test_intervals_repeat_and_stay_in_range(values: list[float]) -> None:
    found = interval(values)
    assert found == interval(values)
    assert found.low is not None
    assert found.high is not None
    assert min(values) - 1e-12 <= found.low <= found.high <= max(values) + 1e-12


def test_pairs_are_compared_episode_by_episode() -> None:
    first = {f"e{n}": float(n < 5) for n in range(20)}
    second = {f"e{n}": float(n < 14) for n in range(20)} | {"only here": 1.0}
    found = paired(first, second)
    assert found.count == 20
    assert found.difference.mean == pytest.approx(0.45)
    assert len(found.gained) == 9
    assert found.lost == ()
    assert found.p_value == pytest.approx(2 * 0.5**9)  # McNemar, exact: nine of nine discordant pairs
    assert paired(second, first).difference.mean == pytest.approx(-0.45)


def test_equal_runs_differ_in_nothing() -> None:
    run = {"a": 0.3, "b": 0.9}
    found = paired(run, run)
    assert (found.difference.mean, found.p_value, found.gained) == (0.0, 1.0, ())
    assert paired(run, {}).p_value is None


def test_continuous_metrics_are_tested_by_permutation() -> None:
    rng = np.random.default_rng(1)
    first = {str(n): float(value) for n, value in enumerate(rng.normal(5, 1, 40))}
    near = {name: value + float(rng.normal(0, 1)) for name, value in first.items()}
    far = {name: value - 2 + float(rng.normal(0, 1)) for name, value in first.items()}
    assert paired(first, near).p_value > 0.05
    assert paired(first, far).p_value < 0.001


def test_success_in_percent_is_compared_as_success_is_and_one_episode_says_nothing() -> None:
    first = {f"e{k}": float(k % 3 == 0) for k in range(30)}
    second = {f"e{k}": float(k % 2 == 0) for k in range(30)}
    percent = paired({name: 100 * value for name, value in first.items()}, {name: 100 * value for name, value in second.items()})
    assert percent.p_value == paired(first, second).p_value
    assert paired({"a": 0.0}, {"a": 100.0}).p_value == 1.0
    assert paired({"a": 1.5}, {"a": 2.5}).p_value == 1.0
