"""Regions against the truth of furnished houses: purity, cover, one region a room, no two rooms in one."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from explored_house import CAMERA, Explored, Quality, explore, place_of, quality

from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.memory import BuildingMemory, EdgeKind
from spacevln.memory.map_marks import OBSTACLE, REGIONS
from spacevln.viewer.plan_sheet import floor_sheet

SEEDS = range(30)


@pytest.fixture(scope="module")
def environment() -> Iterator[HousesEnvironment]:
    environment = HousesEnvironment(CAMERA, load=place_of)
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def ground_floor(environment: HousesEnvironment) -> Explored:
    return explore(3, environment, rooms=5)


@pytest.fixture(scope="module")
def two_floors(environment: HousesEnvironment) -> Explored:
    return explore(10, environment)


def assert_good(total: Quality) -> None:
    assert total.purity >= 0.90
    assert total.cover >= 0.70
    assert total.regions_per_room <= 1.3
    assert total.merged_share <= 0.05


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_regions_of_thirty_houses(environment: HousesEnvironment) -> None:
    cases = [quality(explore(seed, environment)) for seed in SEEDS]
    total = sum(cases, Quality())
    assert_good(total)
    assert total.rooms >= 280
    assert total.pairs >= 80
    worst = min(cases, key=lambda case: case.purity), min(cases, key=lambda case: case.cover)
    assert worst[0].purity >= 0.85
    assert worst[1].cover >= 0.70


def test_regions_are_the_rooms_of_a_house(ground_floor: Explored) -> None:
    total = quality(ground_floor)
    assert total.rooms == 5
    assert_good(total)


@pytest.mark.slow
def test_floors_are_never_mixed_and_joined_by_the_stairs(two_floors: Explored) -> None:
    memory = two_floors.memory.hierarchical
    assert set(memory.floors) == {0, 1}
    for region in memory.regions.all:
        assert {memory.waypoints[index].floor for index in region.waypoints} == {region.floor}
    assert {edge.kind for edge in memory.floor_transitions} == {EdgeKind.CHAIN}
    assert memory.floor_transitions
    distance, _ = memory.graph.shortest({0: 0.0})
    assert sorted(distance) == [waypoint.index for waypoint in memory.waypoints], "every waypoint can be reached"


@pytest.mark.slow
def test_every_threshold_is_a_real_opening(two_floors: Explored, ground_floor: Explored) -> None:
    known = missed = 0
    for case in (two_floors, ground_floor):
        ways = [(opening.floor, case.to_memory(np.array([[opening.x, opening.y]]))[0]) for opening in case.house.openings]
        for storey, floor in case.floors.items():
            for threshold in case.memory.hierarchical.thresholds.on(floor):
                known += 1
                missed += all(storey != on or math.dist(threshold.middle_m, xy) > 0.35 for on, xy in ways)
    assert known >= 10
    assert missed <= 0.1 * known


@pytest.mark.slow
def test_both_floors_of_a_house_are_drawn(two_floors: Explored) -> None:
    building = BuildingMemory(two_floors.metric_map, two_floors.memory.hierarchical)
    for floor in (0, 1):
        sheet = floor_sheet(building, floor, math.pi / 2 - two_floors.start.yaw_rad, two_floors.raster(floor))
        assert sheet is not None
        picture = np.asarray(sheet.picture)
        assert max((picture == colour).all(axis=-1).sum() for colour in REGIONS) > 2000
        obstacle = (picture == OBSTACLE).all(axis=-1)
        straight = np.sort(obstacle.sum(axis=0))[-1] / picture.shape[0]
        assert straight > 0.3, "walls stand upright: some column is a wall over much of the house"
