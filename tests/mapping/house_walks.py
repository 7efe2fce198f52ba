"""A scripted walk through a whole furnished house: shortest ways from room to room, looking around in each and on the way."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from spacevln.core import Camera, Observation, Pose
from spacevln.environments.houses.environment import Place
from spacevln.environments.houses.rendering import make_renderer, renderer_info
from spacevln.environments.houses.walking.geodesics import Geodesics

CAMERA = Camera(320, 240, 79.0, 0.88)
STEP_M = 0.25
_LOOK_AGAIN_M = 8.0


def walk_poses(place: Place, seed: int, rooms: int | None = None) -> list[Pose]:
    """Poses in the scene frame: every room of every floor (or so many of the first), floor by floor, the nearest next."""
    rng = np.random.default_rng([seed, 77])
    geodesics, ground = Geodesics(place.ground), place.ground
    at, poses, since_m, yaw = _standing_points(place, rng), [], math.inf, float(rng.uniform(-math.pi, math.pi))
    here = at[0].pop(0)
    for target in list(itertools.islice(itertools.chain([here], _nearest_next(here, at)), rooms)):
        path = geodesics.path(here, target) if target != here else np.array([here])
        for k, (x, y, z_hint) in enumerate(_every_step(path)):
            z = ground.floor_height_m(x, y, z_hint)
            if poses and k:
                moved = math.dist((x, y), (poses[-1].x_m, poses[-1].y_m))
                yaw = math.atan2(y - poses[-1].y_m, x - poses[-1].x_m) if moved > 0.01 else yaw
            poses.append(Pose(x, y, z, yaw))
            since_m += STEP_M
            level = any(abs(z - floor.z_m) < 0.05 for floor in place.drawable.house.floors)
            if level and (since_m > _LOOK_AGAIN_M or (k and k == len(path) - 1)):
                poses += [poses[-1].turned(turn * math.pi / 6) for turn in range(1, 12)]
                since_m = 0.0
        poses += [poses[-1].turned(turn * math.pi / 6) for turn in range(1, 12)] if since_m else []
        since_m = 0.0
        here = target if len(path) else here
    return poses


def _standing_points(place: Place, rng: np.random.Generator) -> list[list[tuple[float, float, float]]]:
    """Per floor, one point to stand on in every room."""
    found = []
    for floor, space in zip(place.drawable.house.floors, place.ground.floors, strict=True):
        points = np.array(space.origin_m) + (np.argwhere(space.clearance_m >= 0.2) + 0.5) * 0.05
        rooms = [room for room in place.drawable.house.rooms if room.floor == floor.index]
        inside = [[p for p in points if room.contains(p[0], p[1], 0.2)] for room in rooms]
        picked = [some[int(rng.integers(len(some)))] for some in inside if some]
        found.append([(float(p[0]), float(p[1]), floor.z_m) for p in picked])
    return found


def _nearest_next(
    here: tuple[float, float, float], floors: list[list[tuple[float, float, float]]]
) -> Iterator[tuple[float, float, float]]:
    for left in floors:
        while left:
            here = min(left, key=lambda point: math.dist(point, here))
            left.remove(here)
            yield here


def _every_step(path: np.ndarray) -> list[tuple[float, float, float]]:
    points = [tuple(path[0].tolist())] if len(path) else []
    for a, b in pairwise(path):
        n = max(1, math.ceil(math.dist(a[:2], b[:2]) / STEP_M))
        points += [tuple((a + (b - a) * k / n).tolist()) for k in range(1, n + 1)]
    return points


def look(place: Place, poses: list[Pose], camera: Camera = CAMERA) -> Iterator[Observation]:
    """What the camera sees at each pose, in the episode frame of the first one."""
    renderer = make_renderer(renderer_info("auto"), place.drawable, camera.width_px, camera.height_px)
    for pose in poses:
        T_scene_camera = pose.T_world_body
        T_scene_camera[2, 3] += camera.height_m
        frame = renderer.render(T_scene_camera, camera)
        yield Observation(frame.rgb, frame.depth_m, pose.relative_to(poses[0]), camera)
    renderer.close()


def to_scene(start: Pose, xy_m: np.ndarray) -> np.ndarray:
    """Points of the episode frame in the scene frame."""
    c, s = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    return xy_m @ np.array([[c, s], [-s, c]]) + start.xy_m


def to_episode(start: Pose, xy_m: np.ndarray) -> np.ndarray:
    """Points of the scene frame in the episode frame."""
    c, s = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    return (xy_m - start.xy_m) @ np.array([[c, -s], [s, c]])
