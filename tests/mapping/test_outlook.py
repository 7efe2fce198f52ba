"""Where unknown floor begins around a place."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worlds import look, room

from spacevln.core import Pose
from spacevln.mapping import MetricMap, unknown_bearings

HERE = Pose(0.0, 0.0)
CLOSED = room(-2.0, -2.0, 2.0, 2.0)


def seen(boxes: list[tuple[float, ...]], headings_deg: range) -> MetricMap:
    known = MetricMap()
    for heading in headings_deg:
        known.integrate(look(boxes, Pose(0.0, 0.0, 0.0, math.radians(heading))))
    return known


def test_all_around_is_unknown_before_the_first_image() -> None:
    bearings = unknown_bearings(MetricMap(), HERE)
    assert len(bearings) == 72
    assert bearings.min() > -math.pi
    assert bearings.max() == pytest.approx(math.pi)


def test_one_image_leaves_what_is_beside_and_behind() -> None:
    known = seen(CLOSED, range(0, 30, 30))
    degrees = np.degrees(unknown_bearings(known, HERE))
    assert np.abs(degrees).min() == pytest.approx(40.0, abs=5.0)
    assert 180.0 in np.round(degrees, 6)
    turned = np.degrees(unknown_bearings(known, Pose(0.0, 0.0, 0.0, math.pi / 2)))
    np.testing.assert_allclose(np.sort((turned + 90.0) % 360), np.sort(degrees % 360), atol=1e-6)


def test_nothing_is_unknown_in_a_room_that_was_looked_around_in() -> None:
    known = seen(CLOSED, range(0, 360, 30))
    assert unknown_bearings(known, HERE).size == 0
    assert unknown_bearings(known, Pose(0.8, 0.5, 0.0, 1.0)).size == 0


def test_a_gap_in_the_wall_shows_unknown_floor_behind_it_from_beside() -> None:
    gap = [*CLOSED[:3], (2.0, -2.2, 0, 2.2, -0.5, 2.6), (2.0, 0.5, 0, 2.2, 2.2, 2.6), *CLOSED[4:], *room(2.2, -4.0, 6.0, 4.0)[:2]]
    known = seen(gap, range(0, 360, 30))
    assert unknown_bearings(known, HERE).size == 0  # straight through it the floor is seen
    degrees = np.degrees(unknown_bearings(known, Pose(1.7, -0.4)))
    assert degrees.size
    assert np.all(np.abs(degrees) < 90)
    assert degrees.max() > 50
