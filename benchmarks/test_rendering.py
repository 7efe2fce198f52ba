"""Time of one observation: 20 furnished houses, 640x480 (rays: 320x240), HFOV 79 degrees, camera 0.88 m high.

``pytest benchmarks/test_rendering.py``; the targets with software OpenGL on two quiet cores: median 35 ms, 95th percentile 60 ms.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from spacevln.core import Camera, Pose
from spacevln.environments.houses.environment import Place, load_place
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.rendering import make_renderer, renderer_info
from spacevln.environments.houses.walking.motion import Body

HOUSES, VIEWS = 20, 6


def standing_poses(place: Place, count: int, rng: np.random.Generator) -> list[Pose]:
    """Poses at random in the house where the agent can stand with 0.2 m around it."""
    house, walkable = place.drawable.house, Walkable(place.drawable.house)
    poses: list[Pose] = []
    while len(poses) < count:
        room = house.rooms[rng.integers(len(house.rooms))]
        rect = room.rects[0]
        x, y, z = rng.uniform(rect.x0, rect.x1), rng.uniform(rect.y0, rect.y1), house.floors[room.floor].z_m
        if walkable.is_walkable(x, y, z, 0.2):
            poses.append(Pose(x, y, z, rng.uniform(-math.pi, math.pi)))
    return poses


@pytest.mark.parametrize("name", ["gl", "raycast"])
def test_frame(benchmark, name):
    if name == "gl" and renderer_info().name != "gl":
        pytest.skip("no OpenGL library here")
    camera = Camera(640, 480, 79.0, 0.88) if name == "gl" else Camera(320, 240, 79.0, 0.88)
    views = []
    for seed in range(HOUSES):
        place = load_place(f"house-{seed:06d}")
        renderer = make_renderer(renderer_info(name), place.drawable, camera.width_px, camera.height_px)
        for pose in standing_poses(place, VIEWS, np.random.default_rng(seed)):
            T_scene_camera = pose.T_world_body
            T_scene_camera[2, 3] += camera.height_m
            views.append((renderer, T_scene_camera))
    turn = itertools.cycle(views)

    def frame():
        renderer, T_scene_camera = next(turn)
        return renderer.render(T_scene_camera, camera)

    benchmark.pedantic(frame, rounds=3 * len(views), warmup_rounds=len(views))
    times = np.sort(benchmark.stats.stats.data)
    benchmark.extra_info["p95_ms"] = 1e3 * float(times[int(0.95 * len(times))])


def test_step(benchmark):
    place = load_place("house-000003")
    body = Body(place.ground)
    poses = itertools.cycle(standing_poses(place, 200, np.random.default_rng(0)))
    benchmark.pedantic(lambda: body.forward(next(poses), 0.25), rounds=2000, warmup_rounds=10)
