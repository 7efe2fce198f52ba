"""The turns of a look-around."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.control import turns_to_see, whole_turn
from spacevln.core import Action, Camera, EnvironmentSpec, TurnLeft, TurnRight

SPEC = EnvironmentSpec(Camera(640, 480, 79, 0.88))
LEFT, RIGHT = TurnLeft(30.0), TurnRight(30.0)
EVERYWHERE = np.radians(np.arange(-180, 180, 5) + 5.0)


def see(*bearings_deg: float) -> tuple[Action, ...]:
    return turns_to_see(np.radians(np.array(bearings_deg, float)), SPEC)


def shown(bearing_rad: float, turns: tuple[Action, ...]) -> bool:
    """Whether one of the images, the first without a turn, shows a bearing, a degree from its edge at least."""
    faced = np.cumsum([0.0, *(30.0 if isinstance(turn, TurnLeft) else -30.0 for turn in turns)])
    return any(abs(math.remainder(bearing_rad - math.radians(facing), math.tau)) <= math.radians(38.5) for facing in faced)


def test_a_whole_turn_is_twelve_turns_or_eight_of_a_robot() -> None:
    assert whole_turn(SPEC) == (LEFT,) * 12
    assert whole_turn(EnvironmentSpec(Camera(640, 480, 79, 0.88), turn_deg=45.0)) == (TurnLeft(45.0),) * 8


@pytest.mark.parametrize(
    ("bearings_deg", "turns"),
    [
        ((), ()),
        ((0.0, 35.0, -35.0), ()),
        ((60.0,), (LEFT,)),
        ((-60.0,), (RIGHT,)),
        ((70.0, -60.0), (RIGHT, LEFT, LEFT, LEFT)),
        ((180.0,), (LEFT,) * 5),
        ((-150.0, -90.0), (RIGHT,) * 4),
    ],
)
def test_turns_go_no_further_than_to_what_is_hidden(bearings_deg: tuple[float, ...], turns: tuple[Action, ...]) -> None:
    assert see(*bearings_deg) == turns


def test_all_around_takes_ten_turns_of_twelve() -> None:
    assert turns_to_see(EVERYWHERE, SPEC) == (LEFT,) * 10


@given(st.lists(st.sampled_from(list(EVERYWHERE)), max_size=12))
def test_every_bearing_is_shown_and_by_no_fewer_turns(bearings_rad: list[float]) -> None:
    turns = turns_to_see(np.array(bearings_rad, float), SPEC)
    assert all(shown(bearing, turns) for bearing in bearings_rad)
    assert len(turns) <= 10
    fewer = range(len(turns))
    shorter = [(a,) * m + (b,) * (n - m) for a, b in ((LEFT, RIGHT), (RIGHT, LEFT)) for n in fewer for m in range(n + 1)]
    assert not any(all(shown(bearing, way) for bearing in bearings_rad) for way in shorter)
