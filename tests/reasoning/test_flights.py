"""Stairs: told by how they rise, entered before the first step, walked to the other storey."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from plain_space import PlainSpace, context

from spacevln.core import Feedback, ObjectGoalTask, Pose, StageEnd, StageRecord
from spacevln.reasoning.rules import RulePlanner
from spacevln.reasoning.rules.flights import BEFORE_M, BEYOND_M, STOREY_M, Crossing, Flight, flight_of, leads_of, open_end
from spacevln.reasoning.rules.sightings import Thing

RUN_M, RISE_M, STEPS = 0.28, 0.187, 15
Relief = list[tuple[float, float, float, float, float, float]]


def turned(relief: Relief, angle: float) -> Relief:
    c, s = math.cos(angle), math.sin(angle)
    return [(c * x - s * y, s * x + c * y, z, c * a - s * b, s * a + c * b, n) for x, y, z, a, b, n in relief]


def steps_up(count: int = STEPS, floor_m: float = 0.0) -> Relief:
    """Treads and risers of a flight that begins at x = 1 and climbs along x."""
    relief: Relief = []
    for i in range(count):
        for y in (-0.4, 0.0, 0.4):
            relief.append((1.0 + (i + 0.5) * RUN_M, y, floor_m + (i + 1) * RISE_M, 0.0, 0.0, 1.0))
            relief.append((1.0 + i * RUN_M, y, floor_m + (i + 0.5) * RISE_M, -1.0, 0.0, 0.0))
    return relief


def steps_down(count: int = STEPS) -> Relief:
    """Treads of a flight that begins at x = 1 and descends along x; risers are not seen from above."""
    return [(1.0 + (i + 0.5) * RUN_M, y, -(i + 1) * RISE_M, 0.0, 0.0, 1.0) for i in range(count) for y in (-0.4, 0.0, 0.4)]


def railing(x: float, y: float) -> Relief:
    return [(x, y, 0.1 + 0.2 * k, 0.0, -1.0, 0.0) for k in range(5)]


def stairs(relief: Relief) -> Thing:
    return Thing(0, "stairs", (), 0, (1.0, 0.0), 0.3, 4.0, relief=relief)


@given(st.floats(-math.pi, math.pi), st.integers(9, STEPS))
def test_a_flight_up_begins_before_its_first_step_however_the_house_stands(angle: float, count: int) -> None:
    flight = flight_of(stairs(turned(steps_up(count), angle)), 0.0, angle)
    assert flight is not None
    assert flight.leads == "up"
    c, s = math.cos(angle), math.sin(angle)
    assert flight.entry == pytest.approx(((1 - BEFORE_M) * c, (1 - BEFORE_M) * s), abs=0.25)
    far = 1.0 + STEPS * RUN_M + BEYOND_M
    assert flight.far == pytest.approx((far * c, far * s), abs=0.6)


def test_treads_below_the_floor_lead_down() -> None:
    flight = flight_of(stairs(steps_down()), 0.0, 0.0)
    assert flight is not None
    assert flight.leads == "down"
    assert flight.entry == pytest.approx((1 - BEFORE_M, 0.0), abs=0.3)
    assert flight.far[0] > 1.0 + STEPS * RUN_M


def test_the_floor_that_one_stands_on_counts() -> None:
    assert leads_of(stairs(steps_up(floor_m=2.8)), 2.8) == "up"
    assert leads_of(stairs(steps_up(floor_m=-2.8)), 0.0) == "down"


def test_neither_a_corner_nor_the_closed_side_is_a_flight() -> None:
    assert flight_of(stairs([]), 0.0, 0.0) is None
    side = [(1.0 + 0.1 * k, 0.5, 0.2 * j, 0.0, 1.0, 0.0) for k in range(20) for j in range(1, 10)]
    assert flight_of(stairs(side), 0.0, 0.0) is None


def test_a_railing_alone_tells_where_the_well_is_open() -> None:
    long_side = [point for k in range(22) for point in railing(0.2 * k, 0.0)]
    far_end = [point for k in range(6) for point in railing(4.2, 0.2 * k)]
    end = open_end(stairs(long_side + far_end), 0.0, 0.0)
    assert end is not None
    assert end == pytest.approx((-BEFORE_M, 0.5), abs=0.1)
    assert open_end(stairs(long_side), 0.0, 0.0) is None


def test_one_steps_onto_a_flight_from_straight_before_it() -> None:
    flight = flight_of(stairs(steps_up()), 0.0, 0.0)
    assert flight is not None
    x, y = flight.entry
    assert flight.is_before((x, y + 0.2))
    assert not flight.is_before((x, y + 0.5))
    assert not flight.is_before((x - 1.0, y))


def crossing(far: tuple[float, float]) -> Crossing:
    return Crossing(far, "down", 0, Pose(0.0, 0.0), Pose(0.0, 0.0))


def test_on_the_steps_the_flight_leads_where_one_has_gone() -> None:
    down = crossing((4.0, 1.0))
    assert down.target_m == (4.0, 1.0, -STOREY_M)
    assert down.go_on(Pose(1.2, 0.0, -0.8))
    assert down.far[0] > 3.5
    assert down.far[1] == pytest.approx(0.0)
    assert down.go_on(Pose(4.0, 0.0, -2.7))
    assert not down.go_on(Pose(4.8, 0.0, -2.8))


def test_what_does_not_climb_is_given_up() -> None:
    assert not crossing((1.0, 0.0)).go_on(Pose(0.9, 0.0))


def test_near_the_end_what_stands_in_the_way_ends_the_flight() -> None:
    flight = crossing((5.0, 0.0))
    assert flight.go_on(Pose(3.5, 0.0, -2.4, 0.0))
    assert not flight.go_on(Pose(3.5, 0.0, -2.4, 0.0))


def test_the_entry_that_a_stage_was_for_is_entered_though_its_steps_are_out_of_the_image() -> None:
    hall, start = PlainSpace([(-2, -2, 2, 2)]), Pose(0.0, 0.0, 0.0, 0.0)
    planner = RulePlanner()
    first = planner.plan(context(ObjectGoalTask("sofa"), start, hall, [])).subtask
    planner._state.entering, planner._state.target = Flight((1.0, 0.0), (6.0, 0.0), "up"), (0, (1.0, 0.0))
    there = Pose(0.9, 0.0, 0.0, 0.0)
    feedback = Feedback(first, StageRecord(start=start), (), StageEnd.ARRIVAL)
    second = planner.plan(
        context(ObjectGoalTask("sofa"), there, hall, [], stage=1, last_subtask=first, feedback=feedback)
    ).subtask
    assert second.target_m == (6.0, 0.0, STOREY_M)
    assert planner._state.entering is None


def test_a_flight_on_which_one_stands_still_is_none() -> None:
    flight = crossing((5.0, 0.0))
    assert flight.go_on(Pose(1.2, 0.0, -0.8))
    assert not flight.go_on(Pose(1.2, 0.0, -0.8))
