"""Admissible actions, decomposition, stalls and turns."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.control import (
    AdmissibleActionControl,
    ControlSettings,
    TurnMonitor,
    decompose,
    forward_choices,
    is_stalled,
    turns_toward,
)
from spacevln.control.turns import Side
from spacevln.core import (
    Action,
    Camera,
    EnvironmentSpec,
    ExecutedDecision,
    Motion,
    MoveForward,
    ObstacleDistances,
    Stop,
    TurnLeft,
    TurnRight,
    wrap_angle,
)

SPEC = EnvironmentSpec(Camera(80, 60, 79, 0.88))
SETTINGS = ControlSettings()
OPEN = ObstacleDistances(5.0, 5.0, 5.0)


def did(action: Action, moved_m: float | None = None, turned_deg: float | None = None, stalled: bool = False) -> ExecutedDecision:
    match action:
        case MoveForward(distance_m=distance_m):
            moved = distance_m if moved_m is None else moved_m
            return ExecutedDecision(action, None, moved, 0.0, 1, stalled)
        case TurnLeft(angle_deg=angle_deg):
            turned = angle_deg if turned_deg is None else turned_deg
            return ExecutedDecision(action, None, 0.0, math.radians(turned), 1, False)
        case TurnRight(angle_deg=angle_deg):
            turned = -angle_deg if turned_deg is None else turned_deg
            return ExecutedDecision(action, None, 0.0, math.radians(turned), 1, False)
        case _:
            raise AssertionError(action)


def test_forward_choices_are_multiples_up_to_the_longest() -> None:
    assert forward_choices(5.0, SPEC, SETTINGS) == (0.25, 0.5, 0.75, 1.0, 1.25)


@pytest.mark.parametrize(
    ("front_m", "longest_m"),
    [(0.39, None), (0.4, 0.25), (0.49, 0.25), (0.64, 0.25), (0.65, 0.5), (1.0, 0.75), (1.4, 1.25), (100.0, 1.25)],
)
def test_forward_is_shortened_before_it_would_hit(front_m: float, longest_m: float | None) -> None:
    choices = forward_choices(front_m, SPEC, SETTINGS)
    assert (choices[-1] if choices else None) == longest_m


@given(st.floats(0, 20))
def test_no_forward_ever_reaches_the_obstacle(front_m: float) -> None:
    assert all(distance + SETTINGS.stand_off_m <= front_m + 1e-6 for distance in forward_choices(front_m, SPEC, SETTINGS))


def test_open_space_allows_everything_without_reasons() -> None:
    allowed = AdmissibleActionControl(SPEC, SETTINGS).admissible(OPEN)
    assert (allowed.left, allowed.right, allowed.reasons) == (True, True, ())
    assert all(allowed.allows(action) for action in (MoveForward(1.25), TurnLeft(), TurnRight(), Stop()))
    assert not allowed.allows(MoveForward(0.3))


def test_an_obstacle_masks_forward_and_says_why() -> None:
    allowed = AdmissibleActionControl(SPEC, SETTINGS).admissible(ObstacleDistances(0.3, 5, 5))
    assert allowed.forward_m == ()
    assert "0.30 m" in allowed.reasons[0]
    assert not allowed.blocked


def test_a_shortened_forward_says_why() -> None:
    allowed = AdmissibleActionControl(SPEC, SETTINGS).admissible(ObstacleDistances(1.0, 5, 5))
    assert allowed.forward_m == (0.25, 0.5, 0.75)
    assert "limited to 0.75" in allowed.reasons[0]


def test_a_stall_masks_forward_until_the_next_effective_motion() -> None:
    control = AdmissibleActionControl(SPEC, SETTINGS)
    control.observe(did(MoveForward(0.5), moved_m=0.01, stalled=True))
    assert control.admissible(OPEN).forward_m == ()
    assert control.admissible(OPEN).left
    control.observe(did(TurnLeft(), turned_deg=0.0))  # the turn did not happen: the mask stays
    assert control.admissible(OPEN).forward_m == ()
    control.observe(did(TurnLeft()))
    assert control.admissible(OPEN).forward_m


def test_three_turns_in_a_row_leave_forward_or_stop() -> None:
    control = AdmissibleActionControl(SPEC, SETTINGS)
    for _ in range(3):
        assert control.admissible(OPEN).left
        control.observe(did(TurnLeft()))
    allowed = control.admissible(OPEN)
    assert (allowed.left, allowed.right) == (False, False)
    assert allowed.forward_m
    assert allowed.allows(Stop())
    control.observe(did(MoveForward(0.25)))
    assert control.admissible(OPEN).left
    assert control.admissible(OPEN).right


def test_a_stalled_forward_after_three_turns_is_blocked() -> None:
    control = AdmissibleActionControl(SPEC, SETTINGS)
    for _ in range(3):
        control.observe(did(TurnRight()))
    assert not control.admissible(OPEN).blocked
    assert control.admissible(ObstacleDistances(0.3, 5, 5)).blocked
    control.observe(did(MoveForward(0.25), moved_m=0.0, stalled=True))
    assert control.admissible(OPEN).blocked


def test_a_turn_is_not_undone_at_once() -> None:
    control = AdmissibleActionControl(SPEC, SETTINGS)
    control.observe(did(TurnLeft()))
    assert (control.admissible(OPEN).left, control.admissible(OPEN).right) == (True, False)
    recovery = control.admissible(ObstacleDistances(0.3, 5, 5))  # nothing else is left
    assert (recovery.left, recovery.right) == (True, True)
    control.observe(did(MoveForward(0.5)))
    control.observe(did(TurnRight()))
    assert (control.admissible(OPEN).left, control.admissible(OPEN).right) == (False, True)


def test_turn_monitor_ignores_a_forward_that_stood() -> None:
    monitor = TurnMonitor(2, 0.05)
    monitor.observe(did(TurnLeft()))
    monitor.observe(did(MoveForward(0.25), moved_m=0.04, stalled=True))
    assert monitor.reversal is Side.RIGHT
    monitor.observe(did(TurnLeft()))
    assert monitor.exhausted
    monitor.observe(did(MoveForward(0.25), moved_m=0.05))
    assert not monitor.exhausted
    assert monitor.reversal is None


@pytest.mark.parametrize(("moved_m", "stalled"), [(0.0, True), (0.049, True), (0.05, False), (0.25, False)])
def test_stall_threshold(moved_m: float, stalled: bool) -> None:
    assert is_stalled(MoveForward(0.25), Motion(moved_m, 0.0, True), 0.05) is stalled
    assert not is_stalled(TurnLeft(), Motion(moved_m, 0.5, False), 0.05)


@pytest.mark.parametrize(
    ("action", "count"),
    [
        (MoveForward(0.25), 1),
        (MoveForward(1.25), 5),
        (MoveForward(0.1), 1),
        (MoveForward(0.375), 2),
        (MoveForward(0.37), 1),
        (MoveForward(9.0), 5),
        (TurnLeft(30), 1),
        (TurnLeft(44), 1),
        (TurnLeft(45), 2),
        (TurnRight(90), 3),
        (TurnRight(1), 1),
        (TurnRight(350), 6),
        (Stop(), 0),
    ],
)
def test_decomposition_and_rounding(action: Action, count: int) -> None:
    primitives = decompose(action, SPEC)
    assert len(primitives) == count
    assert all(isinstance(primitive, type(action)) for primitive in primitives)
    assert set(primitives) <= {MoveForward(0.25), TurnLeft(30.0), TurnRight(30.0)}


@given(st.floats(-20, 20))
def test_alignment_brings_a_heading_to_the_front(heading_rad: float) -> None:
    turns = turns_toward(heading_rad, SPEC)
    turned = math.radians(sum(30 if isinstance(turn, TurnLeft) else -30 for turn in turns))
    assert len(turns) <= 6
    assert abs(wrap_angle(heading_rad - turned)) <= math.radians(15) + 1e-9


def test_straight_back_turns_left() -> None:
    assert turns_toward(math.pi, SPEC) == (TurnLeft(30.0),) * 6
    assert turns_toward(-math.pi / 2, SPEC) == (TurnRight(30.0),) * 3
    assert turns_toward(0.0, SPEC) == ()
