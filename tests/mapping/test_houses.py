"""The map of furnished houses against their own geometry, on a scripted walk through all their rooms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from house_scores import Witness
from house_walks import CAMERA, look, walk

from spacevln.core import Camera, Observation, Pose
from spacevln.environments.houses.environment import load_place
from spacevln.environments.houses.layout.structure import direction
from spacevln.environments.houses.rendering import make_renderer, renderer_info
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.mapping import MetricMap

FULL = Camera(640, 480, 79.0, 0.88)
KNOWN = {15: pytest.mark.xfail(reason="two of 19 ways are 5.1 % and 7.0 % off", strict=True)}


def check(seed: int, camera: Camera, rooms: int | None = None) -> None:
    walked = walk(seed, rooms)
    witness, world_map = Witness(walked, np.random.default_rng(seed)), MetricMap()
    for stop, images in look(walked, camera):
        for pose, image in zip(stop.poses, images, strict=True):
            world_map.integrate(image)
            witness.see(pose, image)
    place, poses = walked.place, walked.poses
    storeys = sorted({place.ground.floor_index(pose.x_m, pose.y_m, pose.z_m) for pose in poses})
    assert world_map.floors == tuple(storeys)
    assert len(world_map.connectors) == len(storeys) - 1
    for floor in storeys:
        score = witness.score(world_map, floor)
        assert score.precise >= 0.99, (seed, floor, score.precise)
        assert score.marked >= 0.95, (seed, floor, score.marked)
        assert score.free >= 0.98, (seed, floor, score.free)
        assert score.explored >= 0.97, (seed, floor, score.explored)
        # A gap as wide as the body and less than a cell more can be open on the map and closed in truth, or the other way.
        assert len(score.ways) >= (1 if rooms else 15)
        assert score.bracketed.all(), (seed, floor, score.ways[~score.bracketed])
        assert np.mean(np.abs(score.ways - 1) <= 0.05) >= 0.95, (seed, floor, sorted(score.ways))
    if len(storeys) == 2:
        way = world_map.cross_floor_m((0, 0), 0, poses[-1].relative_to(poses[0]).xy_m, 1)
        exact = Geodesics(place.ground).distance_m(poses[0].position_m, poses[-1].position_m)
        assert way == pytest.approx(exact, rel=0.1)  # over the flight it is the way that was walked


@pytest.mark.parametrize("seed", [3, 5, 9])
def test_the_map_of_some_rooms_is_true(seed: int) -> None:
    check(seed, CAMERA, rooms=3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [pytest.param(seed, marks=KNOWN.get(seed, ())) for seed in range(1, 31)])
def test_the_map_of_a_whole_house_is_true(seed: int) -> None:
    check(seed, FULL if seed % 10 == 0 else CAMERA)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "up"), [(8, True), (8, False), (10, True)])
def test_real_stairs_are_climbed_and_descended(seed: int, up: bool) -> None:
    place = load_place(f"house-{seed:06d}")
    stairs, floors = place.drawable.house.stairs[0], place.drawable.house.floors
    ux, uy = direction(stairs)
    half = (stairs.rect.width if ux else stairs.rect.depth) / 2
    low, high = (floors[stairs.lower_floor + k].z_m for k in (0, 1))
    along = np.arange(-half - 1.2, half + 0.9, 0.25)
    yaw = math.atan2(uy, ux)
    if not up:
        along, yaw = along[::-1], yaw + math.pi
    poses = []
    for s in along:
        x, y = stairs.rect.centre[0] + ux * s, stairs.rect.centre[1] + uy * s
        poses.append(Pose(x, y, low + (high - low) * min(1.0, max(0.0, place.ground.climb(stairs, x, y))), yaw))
    poses += [poses[-1].turned(k * math.pi / 6) for k in range(1, 4)]
    renderer = make_renderer(renderer_info("auto"), place.drawable, FULL.width_px, FULL.height_px)
    world_map = MetricMap()
    for pose in poses:
        T_scene_camera = pose.T_world_body
        T_scene_camera[2, 3] += FULL.height_m
        frame = renderer.render(T_scene_camera, FULL)
        observation = Observation(frame.rgb, frame.depth_m, pose.relative_to(poses[0]), FULL)
        world_map.integrate(observation)
        if low + 0.2 < pose.z_m < high - 0.2:
            assert world_map.obstacle_distances(observation).front_m >= 0.75
    renderer.close()
    assert world_map.floor == (1 if up else -1)
    assert len(world_map.connectors) == 1
