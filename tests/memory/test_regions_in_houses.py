"""Regions against the truth of furnished houses: purity, cover, one region a room, no two rooms in one."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from explored_house import CAMERA, Explored, Quality, explore, place_of, quality

from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.memory import EdgeKind

SEEDS = range(30)
FEW = (3, 10)  # a small one, and one with two floors


@pytest.fixture(scope="module")
def environment() -> Iterator[HousesEnvironment]:
    environment = HousesEnvironment(CAMERA, load=place_of)
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def few(environment: HousesEnvironment) -> list[Explored]:
    return [explore(seed, environment) for seed in FEW]


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


def test_regions_are_the_rooms_of_a_house(few: list[Explored]) -> None:
    total = sum(map(quality, few), Quality())
    assert (total.purity, total.cover, total.regions_per_room) >= (0.9, 0.7, 0.0)
    assert total.cover >= 0.7
    assert total.regions_per_room <= 1.3


def test_floors_are_never_mixed_and_joined_by_the_stairs(few: list[Explored]) -> None:
    upstairs = few[1].memory.hierarchical
    assert set(upstairs.floors) == {0, 1}
    for region in upstairs.regions.all:
        assert {upstairs.waypoints[index].floor for index in region.waypoints} == {region.floor}
    assert {edge.kind for edge in upstairs.floor_transitions} == {EdgeKind.CHAIN}
    assert upstairs.floor_transitions
    distance, _ = upstairs.graph.shortest({0: 0.0})
    assert sorted(distance) == [waypoint.index for waypoint in upstairs.waypoints], "every waypoint can be reached"


def test_every_threshold_is_a_real_opening(few: list[Explored]) -> None:
    known = missed = 0
    for case in few:
        ways = [(opening.floor, case.to_memory(np.array([[opening.x, opening.y]]))[0]) for opening in case.house.openings]
        for storey, floor in case.floors.items():
            for threshold in case.memory.hierarchical.thresholds.on(floor):
                known += 1
                missed += all(storey != on or math.dist(threshold.middle_m, xy) > 0.35 for on, xy in ways)
    assert known >= 10
    assert missed <= 0.1 * known
