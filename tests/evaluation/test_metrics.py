"""The worked examples of the benchmark notes, one test each, and properties of the definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from spacevln.control import StepBudget
from spacevln.core import Camera, Pose, UsageError
from spacevln.evaluation import metrics

REFERENCE = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])


@pytest.mark.parametrize(
    ("distance", "path", "expected"),
    [(2.9, 12.5, (True, 0.8)), (2.9, 8.0, (True, 1.0)), (3.0, 12.5, (False, 0.0))],
)
def test_success_is_strict_and_weighted_by_path_length(distance: float, path: float, expected: tuple[bool, float]) -> None:
    reached = metrics.success(True, distance, 3.0)
    assert (reached, metrics.spl(reached, 10.0, path)) == (expected[0], pytest.approx(expected[1]))


def test_a_time_out_near_the_goal_is_no_success() -> None:
    assert not metrics.success(False, 1.0, 3.0)


@pytest.mark.parametrize(("series", "expected"), [([9, 2.9, 5], True), ([9, 3.0, 5], False), ([2.5, 4.0], True), ([], False)])
def test_oracle_success_counts_every_time_from_the_reset_on(series: list[float], expected: bool) -> None:
    assert metrics.oracle_success(series, 3.0) is expected


@pytest.mark.parametrize("distance", [math.nan, math.inf])
def test_unreachable_is_a_failure_and_never_nan(distance: float) -> None:
    assert not metrics.success(True, distance, 3.0)
    assert metrics.spl(False, math.inf, 4.0) == 0.0
    assert metrics.spl(True, math.inf, 4.0) == 0.0
    assert metrics.soft_spl(math.inf, math.inf, 3.0) == 0.0


def test_a_start_on_the_target() -> None:
    assert metrics.spl(True, 0.0, 0.0) == 1.0
    assert metrics.spl(False, 0.0, 0.0) == 0.0
    assert metrics.spl(True, 0.0, 1.0) == 0.0


@pytest.mark.parametrize(
    ("distance", "path", "expected"), [(3.0, 12.5, (True, 0.8)), (1.0, 12.0, (True, 0.8333)), (3.01, 12.0, (False, 0.0))]
)
def test_the_rule_without_stop_is_inclusive(distance: float, path: float, expected: tuple[bool, float]) -> None:
    """Worked examples 2 and 3 under CA-Nav's rule."""
    near = metrics.success_without_stop(distance, 3.0)
    assert (near, metrics.spl(near, 10.0, path)) == (expected[0], pytest.approx(expected[1], abs=1e-4))


def test_the_oracle_error_is_the_least_distance() -> None:
    assert metrics.oracle_error_m([9, 2.9, 5]) == 2.9
    assert metrics.oracle_error_m([9, math.inf, 5]) == 5
    assert metrics.oracle_error_m([]) == math.inf


@pytest.mark.parametrize(
    ("distance", "radius", "expected"),
    [(0.24, 0.25, True), (0.25, 0.25, False), (0.24, 1.0, True), (0.25, 1.0, True), (0.25, 0.5, True), (0.24, 0.1, False)],
)
def test_object_goals_at_several_radii(distance: float, radius: float, expected: bool) -> None:
    """Worked example 19."""
    assert metrics.success(True, distance, radius) is expected


def test_mean_of_three_episodes() -> None:
    assert np.mean([0.8, 0, 1.0]) * 100 == pytest.approx(60.0)
    assert np.mean([1, 0, 1]) * 100 == pytest.approx(66.7, abs=0.05)


@pytest.mark.parametrize(("final", "path", "expected"), [(4, 8, 0.6), (4, 20, 0.3), (12, 8, 0.0)])
def test_soft_spl(final: float, path: float, expected: float) -> None:
    assert metrics.soft_spl(10, final, path) == pytest.approx(expected)


def test_path_length_ignores_turns_and_blocked_moves() -> None:
    path = [[0, 0, 0], [0.25, 0, 0], [0.25, 0, 0], [0.25, 0, 0], [0.25, 0, -0.25]]
    length = metrics.path_length_m(path)
    assert length == pytest.approx(0.5)
    assert metrics.spl(True, math.hypot(0.25, 0.25), length) == pytest.approx(0.7071, abs=1e-4)


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        (REFERENCE, 1.0),
        (REFERENCE[:1], 0.7165),
        (REFERENCE[:2], 0.8948),
        (REFERENCE + np.array([0, 0, 1]), 0.7165),
        (np.vstack([REFERENCE, [[3, 0, 0]]]), 0.8948),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, 0], [2, 0, 0]], 0.8948),
        ([[0, 0, 0], [0, 0, 0], [1, 0, 0]], 0.8948),
    ],
)
def test_ndtw(path: np.ndarray, expected: float) -> None:
    assert metrics.ndtw(path, REFERENCE, 3.0) == pytest.approx(expected, abs=5e-5)
    assert metrics.sdtw(False, path, REFERENCE, 3.0) == 0.0
    assert metrics.sdtw(True, path, REFERENCE, 3.0) == metrics.ndtw(path, REFERENCE, 3.0)


@pytest.mark.parametrize(("actions", "accepted"), [("FFFFS", True), ("FFFFF", False)])
def test_stop_must_be_within_the_budget(actions: str, accepted: bool) -> None:
    """Worked example 11: with N = 5, STOP as the fifth step counts; five forwards leave no step for it."""
    budget = StepBudget(5)
    for _ in actions.rstrip("S"):
        budget.spend()
    assert (budget.left > 0) is accepted
    assert budget.can_move is False  # the last step is held for STOP


@pytest.mark.parametrize(
    ("width", "height", "hfov", "focal", "vfov"),
    [(640, 480, 79.0, 388.19, 63.45), (360, 640, 42.0, 468.9, 68.62), (480, 360, 86.07, 257.07, 70.0)],
)
def test_the_cameras_of_the_benchmarks(width: int, height: int, hfov: float, focal: float, vfov: float) -> None:
    """Worked example 23: the paper's, HM3D-OVON's Stretch, and GN-Bench's with 70 degrees as its vertical field of view."""
    camera = Camera(width_px=width, height_px=height, hfov_deg=hfov, height_m=0.88)
    assert (camera.fx_px, camera.fy_px) == pytest.approx((focal, focal), abs=0.05)
    assert (camera.cx_px, camera.cy_px) == (width / 2, height / 2)  # pixel edges
    assert camera.vfov_deg == pytest.approx(vfov, abs=0.005)


def test_a_look_around_returns_to_its_heading() -> None:
    """Worked example 24: twelve turns of 30 degrees."""
    pose = Pose(1.0, 2.0, 0.0, 0.7)
    for _ in range(12):
        pose = pose.turned(math.radians(30))
    assert math.cos(pose.yaw_rad - 0.7) == pytest.approx(1.0, abs=1e-6)


WHOLE = st.integers(-50, 50).map(float)  # exact sums, so that equal positions stay equal


@given(hnp.arrays(float, (5, 3), elements=WHOLE), hnp.arrays(float, 3, elements=WHOLE))
def test_ndtw_is_bounded_and_does_not_depend_on_the_origin(path: np.ndarray, shift: np.ndarray) -> None:
    value = metrics.ndtw(path, REFERENCE)
    assert 0.0 <= value <= 1.0
    assert metrics.ndtw(path + shift, REFERENCE + shift) == pytest.approx(value, abs=1e-6)


@given(st.floats(0.1, 50), st.floats(0, 200))
def test_spl_is_between_zero_and_success(shortest: float, path: float) -> None:
    assert 0.0 <= metrics.spl(True, shortest, path) <= 1.0


@pytest.mark.parametrize("path", [[], [1.0, 2.0, 3.0], [[1.0, 2.0]]])
def test_a_wrong_shape_is_refused_with_a_sentence(path: list[float]) -> None:
    with pytest.raises(UsageError, match="shape"):
        metrics.path_length_m(path)
