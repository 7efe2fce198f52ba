"""Map and regions of furnished houses against the truth, on a scripted walk through all their rooms."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from explored_house import Explored, Quality, explore, quality
from house_scores import Score
from house_walks import CAMERA

from spacevln.core import Camera
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.memory import BuildingMemory, EdgeKind
from spacevln.memory.map_marks import OBSTACLE, REGIONS
from spacevln.viewer.plan_sheet import floor_sheet

FULL = Camera(640, 480, 79.0, 0.88)
MOST_OFF = 0.05  # a map distance may be this much longer or shorter than the true one
THRESHOLD_OFF_M = 0.35


def assert_map_is_true(case: Explored, least_ways: int) -> list[Score]:
    world_map, place, poses = case.metric_map, case.walked.place, case.walked.poses
    storeys = sorted({place.ground.floor_index(pose.x_m, pose.y_m, pose.z_m) for pose in poses})
    assert world_map.floors == tuple(storeys)
    assert len(world_map.connectors) == len(storeys) - 1
    scores = [case.witness.score(world_map, floor) for floor in storeys]
    for floor, score in zip(storeys, scores, strict=True):
        where = case.house.name, floor
        assert score.precise >= 0.99, (where, score.precise)
        assert score.marked >= 0.95, (where, score.marked)
        assert score.free >= 0.98, (where, score.free)
        assert score.explored >= 0.97, (where, score.explored)
        assert len(score.ways) >= least_ways, where
        assert np.abs(score.ways - 1).max() <= MOST_OFF, (where, sorted(score.ways))
        # A gap as wide as the body and less than a cell more can be open to the cells and closed to a disc, or the other way.
        assert score.bracketed.all(), (where, score.disc_ways[~score.bracketed])
    if len(storeys) == 2:
        way = world_map.cross_floor_m((0, 0), 0, poses[-1].relative_to(poses[0]).xy_m, 1)
        exact = Geodesics(place.ground).distance_m(poses[0].position_m, poses[-1].position_m)
        assert way == pytest.approx(exact, rel=0.1)  # over the flight it is the way that was walked
    return scores


def assert_floors_are_apart(case: Explored) -> None:
    memory = case.memory.hierarchical
    assert memory.floors == tuple(sorted(case.floors.values()))
    for region in memory.regions.all:
        assert {memory.waypoints[index].floor for index in region.waypoints} == {region.floor}
    assert {edge.kind for edge in memory.floor_transitions} <= {EdgeKind.CHAIN}
    assert bool(memory.floor_transitions) == (len(memory.floors) > 1)
    distance, _ = memory.graph.shortest({0: 0.0})
    assert sorted(distance) == [waypoint.index for waypoint in memory.waypoints], "every waypoint can be reached"


def thresholds_found(case: Explored) -> tuple[int, int]:
    """How many thresholds are known, and how many of them are no opening of the house."""
    ways = [(opening.floor, case.to_memory(np.array([[opening.x, opening.y]]))[0]) for opening in case.house.openings]
    known = missed = 0
    for storey, floor in case.floors.items():
        for threshold in case.memory.hierarchical.thresholds.on(floor):
            known += 1
            missed += all(storey != on or math.dist(threshold.middle_m, xy) > THRESHOLD_OFF_M for on, xy in ways)
    return known, missed


def assert_is_drawn(case: Explored) -> None:
    building = BuildingMemory(case.metric_map, case.memory.hierarchical)
    for floor in case.floors.values():
        sheet = floor_sheet(building, floor, math.pi / 2 - case.walked.start.yaw_rad, case.raster(floor))
        assert sheet is not None
        picture = np.asarray(sheet.picture)
        assert max((picture == colour).all(axis=-1).sum() for colour in REGIONS) > 2000
        obstacle = (picture == OBSTACLE).all(axis=-1)
        straight = np.sort(obstacle.sum(axis=0))[-1] / picture.shape[0]
        assert straight > 0.3, "walls stand upright: some column is a wall over much of the house"


def assert_regions_are_rooms(total: Quality) -> None:
    assert total.purity >= 0.90
    assert total.cover >= 0.70
    assert total.regions_per_room <= 1.3
    assert total.merged_share <= 0.05


@pytest.mark.parametrize(("seed", "rooms"), [(3, 5), (5, 3), (9, 3)])
def test_map_and_regions_of_some_rooms_are_true(seed: int, rooms: int) -> None:
    case = explore(seed, rooms)
    assert_map_is_true(case, least_ways=10)
    total = quality(case)
    assert total.rooms == rooms
    assert_regions_are_rooms(total)


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("seeds", [range(1, 11), range(11, 21), range(21, 31)], ids="{0.start}-{0.stop}".format)
def test_maps_and_regions_of_thirty_houses_are_true(seeds: Sequence[int]) -> None:
    found: list[Quality] = []
    disc_ways: list[np.ndarray] = []
    thresholds = np.zeros(2, int)
    for seed in seeds:
        case = explore(seed, camera=FULL if seed % 10 == 0 else CAMERA)
        disc_ways += [score.disc_ways for score in assert_map_is_true(case, least_ways=50)]
        assert_floors_are_apart(case)
        found.append(quality(case))
        assert found[-1].purity >= 0.85
        assert found[-1].cover >= 0.70
        thresholds += thresholds_found(case)
        if len(case.floors) > 1:
            assert_is_drawn(case)
    total = sum(found, Quality())
    assert_regions_are_rooms(total)
    assert total.rooms >= 80
    assert total.pairs >= 20
    assert thresholds[0] >= 60
    assert thresholds[1] <= 0.1 * thresholds[0]
    assert np.mean(np.abs(np.concatenate(disc_ways) - 1) <= MOST_OFF) >= 0.95
