"""Stairs: entered at the open end, walked to the other one."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from spacevln.core import Pose
from spacevln.reasoning.rules.flights import BEFORE_M, USUAL_RUN_M, flight_of
from spacevln.reasoning.rules.sightings import Thing
from spacevln.reasoning.rules.state import Crossing


class Floor:
    """A floor with an obstacle beyond x = 5, where the closed end of the flight is."""

    def is_obstacle(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return np.asarray(xy_m)[:, 0] > 5.0

    def is_explored(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return np.ones(len(np.asarray(xy_m)), dtype=bool)


def stairs(points: list[tuple[float, float]], seen_from: tuple[float, float]) -> Thing:
    return Thing(0, "stairs", (), 0, points[0], 0.3, 4.0, points, seen_from=seen_from)


def test_a_flight_is_entered_at_its_open_end_and_left_behind_its_last_step() -> None:
    points = [(x, y) for x in np.linspace(1.0, 5.0, 8) for y in (-0.5, 0.5)]
    flight = flight_of(stairs(points, (0.0, 0.0)), Floor(), (0.0, 0.0))  # type: ignore[arg-type]
    assert flight is not None
    assert flight.entry == pytest.approx((1.0 - BEFORE_M, 0.0), abs=0.05)
    assert flight.far[0] > 5.0
    assert flight.far[1] == pytest.approx(0.0, abs=0.05)


def test_first_steps_alone_lead_away_from_the_eye() -> None:
    points = [(x, y) for x in (1.0, 1.2) for y in np.linspace(-0.5, 0.5, 5)]
    flight = flight_of(stairs(points, (-1.0, 0.1)), Floor(), (-1.0, 0.1))  # type: ignore[arg-type]
    assert flight is not None
    assert flight.entry[0] < 1.0
    assert flight.far[0] > 1.0 + USUAL_RUN_M


def test_too_few_points_say_nothing() -> None:
    assert flight_of(stairs([(1.0, 0.0)], (0.0, 0.0)), Floor(), (0.0, 0.0)) is None  # type: ignore[arg-type]


def test_on_the_steps_the_flight_leads_where_one_has_gone() -> None:
    start = Pose(0.0, 0.0)
    crossing = Crossing((4.0, 1.0), start, start)
    assert crossing.go_on(Pose(1.2, 0.0, -0.8))
    assert crossing.far[0] > 3.5
    assert crossing.far[1] == pytest.approx(0.0)
    assert crossing.go_on(Pose(4.0, 0.0, -2.7))
    assert not crossing.go_on(Pose(4.8, 0.0, -2.8))


def test_what_is_no_flight_is_given_up() -> None:
    start = Pose(0.0, 0.0)
    assert not Crossing((1.0, 0.0), start, start).go_on(Pose(0.9, 0.0))
