"""Regions against the truth of furnished houses: purity, cover, one region a room, no two rooms in one."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from spacevln.core import Camera, EpisodeSpec, InstructionTask, Observation, Pose
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.houses.geodesics import Geodesics
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.plan import House, Room
from spacevln.environments.houses.walkable import RESOLUTION_M, Walkable
from spacevln.language import known_categories
from spacevln.mapping import MetricMap
from spacevln.memory import SpatialCognitiveMemory
from spacevln.memory.region_raster import RegionRaster, region_raster
from spacevln.perception import LabelDetector, lift

SEEDS = (11, 14, 17)
CAMERA = Camera(320, 240, 79.0, 0.88)


@dataclass
class Explored:
    """A house and what is remembered of its ground floor after a look around from the middle of every room."""

    house: House
    metric_map: MetricMap
    memory: SpatialCognitiveMemory
    rooms: list[Room]

    @property
    def raster(self) -> RegionRaster:
        raster = region_raster(self.memory.hierarchical, 0)
        assert raster is not None
        return raster


def middle_of(room: Room, walkable: Walkable) -> Pose | None:
    floor = walkable.floors[room.floor]
    points = np.array(floor.origin_m) + (np.argwhere(floor.clearance_m >= 0.25) + 0.5) * RESOLUTION_M
    inside = np.array([room.contains(float(x), float(y), 0.2) for x, y in points])
    if not inside.any():
        return None
    x, y = min(points[inside].tolist(), key=lambda point: math.dist(point, room.centre))
    return Pose(x, y)


def explore(seed: int, environment: HousesEnvironment) -> Explored:
    house = build_house(seed)
    walkable = Walkable(house)
    geodesics, detector = Geodesics(walkable), LabelDetector()
    metric_map, memory = MetricMap(), SpatialCognitiveMemory()

    def look(pose: Pose) -> Observation:
        seen = environment.reset(EpisodeSpec("", house.name, pose, InstructionTask("look")))
        return replace(seen, pose=pose, T_world_camera=None)

    left = [(room, pose) for room in house.rooms if room.floor == 0 and (pose := middle_of(room, walkable)) is not None]
    rooms, here = [], left[0][1]
    while left:
        nearest = min(left, key=lambda item: geodesics.distance_m(tuple(here.position_m), tuple(item[1].position_m)))
        left.remove(nearest)
        room, pose = nearest
        for a, b in itertools.pairwise(geodesics.path(tuple(here.position_m), tuple(pose.position_m))):
            heading = math.atan2(b[1] - a[1], b[0] - a[0])
            for share in np.arange(0, 1, 0.5 / max(math.dist(a, b), 0.5)):
                metric_map.integrate(look(Pose(*(a + share * (b - a)).tolist(), heading)))
        views = [look(pose.turned(k * math.pi / 6)) for k in range(12)]
        for view in views:
            metric_map.integrate(view)
        found = detector.detect(views, known_categories())
        sightings = [sighting for view, detections in zip(views, found, strict=True) for sighting in lift(view, detections)]
        memory.add_waypoint(pose, room.type, sightings, metric_map)
        rooms.append(room)
        here = pose
    return Explored(house, metric_map, memory, rooms)


@pytest.fixture(scope="module")
def explored() -> list[Explored]:
    environment = HousesEnvironment(CAMERA)
    try:
        return [explore(seed, environment) for seed in SEEDS]
    finally:
        environment.close()


@pytest.mark.slow
def test_regions_are_of_one_type_and_cover_their_rooms(explored: list[Explored]) -> None:
    right = owned = covered = free = 0
    for case in explored:
        types = [region.type for region in case.memory.hierarchical.regions.all]
        for room in case.rooms:
            for rect in room.rects:
                x, y = np.meshgrid(np.arange(rect.x0 + 0.05, rect.x1, 0.1), np.arange(rect.y0 + 0.05, rect.y1, 0.1))
                points = np.stack([x.ravel(), y.ravel()], axis=1)
                points = points[case.metric_map.is_free(points)]
                owners = case.raster.at(points)
                free += len(points)
                covered += np.count_nonzero(owners)
                owned += np.count_nonzero(owners)
                right += sum(types[owner - 1] == room.type for owner in owners.tolist() if owner)
    assert right / owned >= 0.9
    assert covered / free >= 0.7


@pytest.mark.slow
def test_one_region_a_room_and_no_two_rooms_in_one(explored: list[Explored]) -> None:
    regions = sum(len(case.memory.hierarchical.regions.all) for case in explored)
    assert regions <= 1.3 * sum(len(case.rooms) for case in explored)
    for case in explored:
        of = case.memory.hierarchical.regions.of
        for (a, room_a), (b, room_b) in itertools.combinations(enumerate(case.rooms), 2):
            assert room_a.id == room_b.id or of(a) is not of(b)


@pytest.mark.slow
def test_every_threshold_is_a_real_opening(explored: list[Explored]) -> None:
    known = missed = 0
    for case in explored:
        ways = [opening for opening in case.house.openings if opening.kind != "window"]
        thresholds = case.memory.hierarchical.thresholds.on(0)
        known += len(thresholds)
        missed += sum(all(math.dist(threshold.middle_m, (way.x, way.y)) > 0.35 for way in ways) for threshold in thresholds)
    assert missed <= 0.1 * known
