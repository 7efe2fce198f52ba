"""The map of furnished houses against their own geometry, on a scripted walk."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from house_walks import CAMERA, TRUTH_M, Truth, Walk, map_cells, often_seen, truth_of, visible_floor, walk_house

from spacevln.core import Observation, Pose
from spacevln.environments.houses.environment import load_place
from spacevln.environments.houses.layout.structure import direction
from spacevln.environments.houses.rendering import make_renderer, renderer_info
from spacevln.mapping import MetricMap
from spacevln.mapping.geodesics import FreeGrid

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", [3, 11])
def test_the_map_is_true(seed: int) -> None:
    walk = walk_house(seed, rooms=4)
    truth = truth_of(walk.place)
    cells = map_cells(walk)
    distance = truth.at(truth.distance_m, walk.to_scene(cells))
    world_map = walk.world_map
    assert np.mean(distance[world_map.is_obstacle(cells)] <= 0.10) >= 0.99
    inside = truth.at(truth.inside_m, walk.to_scene(cells))
    assert np.mean(inside[world_map.is_free(cells)] <= TRUTH_M) >= 0.97
    assert world_map.is_obstacle(often_seen(walk)).mean() >= 0.95
    assert world_map.is_explored(visible_floor(walk, truth, 40, np.random.default_rng(seed))).mean() >= 0.97
    _ways_are_true(walk, truth)


def _ways_are_true(walk: Walk, truth: Truth) -> None:
    """Known ways over 2 m against those in the true free space with the same inflation, on cells of 2 cm."""
    open_cells = (truth.distance_m >= 0.1).astype(np.uint8)
    open_cells[[0, -1]] = open_cells[:, [0, -1]] = 0
    i0, j0 = np.round(truth.origin / TRUTH_M).astype(int)
    exact_grid = FreeGrid(int(i0), int(j0), TRUTH_M, open_cells)
    shift = truth.origin - np.array([i0, j0]) * TRUTH_M
    places, ratios = [frame.pose for frame in walk.frames[::15]], []
    for a in places[::3]:
        field = walk.world_map.geodesic_field(a.xy_m)
        exact = exact_grid.field(walk.to_scene(a.xy_m[None])[0] - shift)
        for b in places:
            way = exact.path_to(walk.to_scene(b.xy_m[None])[0] - shift) + shift
            if a.distance_m(b.x_m, b.y_m) < 2.0 or len(way) < 2:
                continue
            dense = np.concatenate([p + np.linspace(0, 1, 50)[:, None] * (q - p) for p, q in pairwise(way)])
            if walk.world_map.is_free(walk.to_episode(dense)).all():
                length = np.hypot(*np.diff(way, axis=0).T).sum()
                ratios.append(float(field.at(b.xy_m)[0]) / length)
    assert len(ratios) >= 5
    assert np.mean(np.abs(np.array(ratios) - 1) <= 0.05) >= 0.9, sorted(ratios)


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
    renderer = make_renderer(renderer_info("auto"), place.drawable, CAMERA.width_px, CAMERA.height_px)
    world_map = MetricMap()
    for pose in poses:
        T_scene_camera = pose.T_world_body
        T_scene_camera[2, 3] += CAMERA.height_m
        frame = renderer.render(T_scene_camera, CAMERA)
        observation = Observation(frame.rgb, frame.depth_m, pose.relative_to(poses[0]), CAMERA)
        world_map.integrate(observation)
        if low + 0.2 < pose.z_m < high - 0.2:
            assert world_map.obstacle_distances(observation).front_m >= 0.75
    renderer.close()
    assert world_map.floor == (1 if up else -1)
    assert len(world_map.connectors) == 1
