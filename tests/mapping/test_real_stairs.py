"""Stairs of furnished houses, climbed and descended straight."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacevln.core import Camera, Observation, Pose
from spacevln.environments.houses.environment import load_place
from spacevln.environments.houses.layout.structure import direction
from spacevln.environments.houses.rendering import make_renderer, renderer_info
from spacevln.mapping import MetricMap

FULL = Camera(640, 480, 79.0, 0.88)


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
