"""Stairs and floors on a synthetic house: a room, a straight flight of 15 steps, a room above."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worlds import Box, look, look_around, room

from spacevln.core import Camera, Pose
from spacevln.mapping import Incline, MetricMap

RISE, RUN, STEPS = 0.18, 0.27, 15
FOOT_X, TOP_X, TOP_Z = 2.0, 2.0 + RUN * STEPS, RISE * STEPS
CAMERA = Camera(320, 240, 79.0, 0.88)


def house() -> list[Box]:
    lower = [box for box in room(-3, -2, TOP_X, 2) if box[2] < 2.0][:1]
    walls: list[Box] = [
        (-3.2, -2.2, 0, -3, 2.2, 5.5),
        (-3.2, -2.2, 0, 10, -2, 5.5),
        (-3.2, 2, 0, 10, 2.2, 5.5),
        (10, -2.2, 0, 10.2, 2.2, 5.5),
        (FOOT_X, 0.5, 0, TOP_X, 0.6, 5.5),
        (FOOT_X, -0.6, 0, TOP_X, -0.5, 5.5),
    ]
    steps: list[Box] = [(FOOT_X + k * RUN, -0.5, 0, FOOT_X + (k + 1) * RUN, 0.5, (k + 1) * RISE) for k in range(STEPS)]
    upper: list[Box] = [(TOP_X, -2, TOP_Z - 0.2, 10, 2, TOP_Z), (8.0, -1.5, TOP_Z, 8.5, -1.0, TOP_Z + 0.9)]
    return [*lower, *walls, *steps, *upper, (-1.0, 1.0, 0, -0.5, 1.5, 0.9)]


HOUSE = house()


def height(x: float) -> float:
    """Height of the ramp through the steps."""
    return min(TOP_Z, max(0.0, (x - FOOT_X) / RUN * RISE))


def walk(world_map: MetricMap, start: float, end: float, yaw: float = 0.0) -> None:
    for x in np.linspace(start, end, round(abs(end - start) / 0.25) + 1):
        world_map.integrate(look(HOUSE, Pose(float(x), 0.0, height(float(x)), yaw), CAMERA))


@pytest.fixture(scope="module")
def climbed() -> MetricMap:
    world_map = MetricMap()
    for frame in look_around(HOUSE, Pose(0, 0), CAMERA):
        world_map.integrate(frame)
    walk(world_map, 0.0, 7.5)
    for frame in look_around(HOUSE, Pose(7.5, 0, TOP_Z), CAMERA):
        world_map.integrate(frame)
    return world_map


def test_stairs_ahead_are_no_obstacle_and_the_walls_beside_are() -> None:
    world_map = MetricMap()
    for x in (0.0, 0.25, 0.5):
        world_map.integrate(look(HOUSE, Pose(x, 0), CAMERA))
    treads = np.array([(FOOT_X + 0.1 + 0.05 * k, y) for k in range(18) for y in (-0.3, 0.0, 0.3)])
    assert world_map.is_obstacle(treads).mean() < 0.05
    assert world_map.is_obstacle([(FOOT_X + 0.02, 0.53), (FOOT_X + 0.02, -0.53)]).any()
    assert world_map.geodesic_m((0, 0), (FOOT_X + 0.6, 0)) == pytest.approx(FOOT_X + 0.6, rel=0.05)


@pytest.mark.parametrize("before_m", [0.3, 0.6, 0.9])
def test_the_flight_that_is_being_taken_is_walked_on_even_where_its_foot_was_never_seen(before_m: float) -> None:
    world_map = MetricMap()
    foot = Pose(FOOT_X - before_m, 0.0)
    from_the_side = [look(HOUSE, Pose(foot.x_m, 0.0, 0.0, yaw), CAMERA) for yaw in (-math.pi / 2, -math.pi / 3, math.pi / 3)]
    for frame in from_the_side:
        world_map.integrate(frame)
    ahead = look(HOUSE, foot, CAMERA)
    incline = Incline((foot.x_m, foot.y_m, 0.0), (TOP_X + 0.3, 0.0, TOP_Z))
    assert world_map.sector_distance_m(ahead, 0.0, incline) > 1.5
    assert world_map.obstacle_distances(ahead, incline).front_m >= world_map.obstacle_distances(ahead).front_m
    post = look([*HOUSE, (FOOT_X + 0.3, -0.05, 0.0, FOOT_X + 0.4, 0.05, 1.6)], foot, CAMERA)
    assert world_map.sector_distance_m(post, 0.0, incline) == pytest.approx(before_m + 0.3, abs=0.06)


def test_an_incline_covers_its_own_width_and_length() -> None:
    incline = Incline((0.0, 0.0, 0.0), (4.0, 0.0, 2.8))
    heights = incline.heights_m(np.array([2.0, 2.0, 2.0, -0.1, 4.1]), np.array([0.0, 0.3, 0.5, 0.0, 0.0]))
    assert heights[:2] == pytest.approx(1.4)
    assert np.isnan(heights[2:]).all()
    assert np.isnan(Incline((1.0, 1.0, 0.0), (1.0, 1.0, 2.0)).heights_m(np.array([1.0]), np.array([1.0]))).all()


def test_every_forward_on_the_stairs_is_open() -> None:
    world_map = MetricMap()
    for x in np.arange(0.0, 7.0, 0.25):
        frame = look(HOUSE, Pose(float(x), 0.0, height(float(x))), CAMERA)
        world_map.integrate(frame)
        assert world_map.obstacle_distances(frame).front_m > 0.6, x


def test_a_low_box_stays_an_obstacle() -> None:
    world = [
        *room(-3, -2, 4, 2),
        (1.8, -0.4, 0, 2.4, 0.4, 0.19),
        (1.8, -1.8, 0, 3.2, -0.9, 0.2),
        (1.9, -1.7, 0.2, 3.1, -1.0, 0.4),
    ]
    world_map = MetricMap()
    for x in (0.0, 0.25):
        world_map.integrate(look(world, Pose(x, 0), Camera(640, 480, 79, 0.88)))
    assert world_map.is_obstacle([(1.85, 0.02), (2.0, 0.2), (1.87, -1.2), (2.5, -1.4)]).all()


def test_a_new_floor_is_opened_and_joined(climbed: MetricMap) -> None:
    assert climbed.floor == 1
    assert climbed.floors == (0, 1)
    (stairs,) = climbed.connectors
    assert (stairs.from_floor, stairs.to_floor) == (0, 1)
    assert abs(stairs.start.x_m - FOOT_X) < 0.5
    assert abs(stairs.end.x_m - TOP_X) < 1.1
    assert stairs.end.z_m == pytest.approx(TOP_Z)
    assert set(climbed.travelled[:, 2]) == {0.0, 1.0}


def test_floors_are_never_mixed(climbed: MetricMap) -> None:
    assert climbed.is_obstacle([(8.02, -1.2)])[0]
    assert not climbed.is_explored([(-0.9, 1.02)])[0]
    lower = climbed.crop((-0.75, 1.25), 1.0, floor=0)
    assert lower.obstacle.any()
    assert not climbed.crop((8.25, -1.25), 1.0, floor=0).explored.any()


def test_the_upper_room_is_free_and_its_way_known(climbed: MetricMap) -> None:
    assert climbed.is_free([(7.5, 1.0), (7.5, -1.0), (9.0, 0.5)]).all()
    assert climbed.geodesic_m((7.5, 0), (9.0, 1.0)) == pytest.approx(math.hypot(1.5, 1.0), rel=0.05)


def test_ways_across_floors(climbed: MetricMap) -> None:
    flight = math.hypot(TOP_X - FOOT_X, TOP_Z)
    exact = FOOT_X + flight + 9.0 - TOP_X
    assert climbed.cross_floor_m((0, 0), 0, (9.0, 0.0), 1) == pytest.approx(exact, rel=0.06)
    assert climbed.cross_floor_m((9.0, 0.0), 1, (0, 0), 0) == pytest.approx(exact, rel=0.06)
    assert climbed.cross_floor_m((0, 0), 0, (9.0, 0.0), 5) == math.inf
    assert climbed.cross_floor_m((0, 0), 0, (1.0, 0.0), 0) == pytest.approx(1.0, abs=0.05)


def test_going_down_again_is_the_first_floor_again() -> None:
    world_map = MetricMap()
    walk(world_map, 0.0, 7.5)
    assert world_map.floor == 1
    walk(world_map, 7.5, 0.0, math.pi)
    assert world_map.floor == 0
    assert world_map.floors == (0, 1)
    assert len(world_map.connectors) == 2
    assert world_map.is_free([(0.0, 0.0), (1.0, 0.0)]).all()


def test_starting_upstairs_the_lower_floor_counts_down() -> None:
    world_map = MetricMap()
    for x in np.arange(7.5, -0.1, -0.25):
        pose = Pose(float(x), 0.0, height(float(x)) - TOP_Z, math.pi)
        frame = look(HOUSE, Pose(pose.x_m, 0.0, height(float(x)), math.pi), CAMERA)
        world_map.integrate(type(frame)(frame.rgb, frame.depth_m, pose, frame.camera))
    assert world_map.floor == -1


def test_turning_on_the_stairs_opens_no_floor() -> None:
    world_map = MetricMap()
    walk(world_map, 0.0, 4.6)
    for frame in look_around(HOUSE, Pose(4.6, 0.0, height(4.6)), CAMERA):
        world_map.integrate(frame)
    assert height(4.6) > 1.5
    assert world_map.floors == (0,)
