"""Spatial Cognitive Memory on one thread. Every goal is a median and asserted.

``pytest benchmarks/test_memory.py --benchmark-only``; add ``--benchmark-timer=time.process_time`` on a busy machine.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from spacevln.core import Camera, Detection, Observation, Pose, Sighting
from spacevln.mapping import MetricMap
from spacevln.memory import LocalLandmarkMemory, SpatialCognitiveMemory
from spacevln.memory.arrange import arrange
from spacevln.memory.rendering import render_map
from spacevln.memory.serialize import serialize
from spacevln.perception import lift

TEXT_S, RENDERED_MAP_S, LANDMARKS_S = 0.025, 0.015, 0.001
WAYPOINTS = 60
CAMERA = Camera(160, 120, 79.0, 0.88)
WALLS = [  # x0, y0, x1, y1, height
    (-0.2, -0.2, 12.2, 0, 2.6), (-0.2, 10, 12.2, 10.2, 2.6), (-0.2, 0, 0, 10, 2.6), (12, 0, 12.2, 10, 2.6),
    (3.9, 0, 4.1, 1.5, 2.6), (3.9, 2.5, 4.1, 10, 2.6), (4.1, 4.9, 7, 5.1, 2.6), (8, 4.9, 12, 5.1, 2.6),
    (7.9, 5.1, 8.1, 7, 2.6), (7.9, 8, 8.1, 10, 2.6), (5, 1, 6, 2, 0.8), (10, 1, 11.5, 3, 0.5), (1, 7, 3, 9, 0.5),
    (5, 8, 6, 9, 0.7),
]  # fmt: skip
DOORS = [((4.0, 1.5), (4.0, 2.5)), ((7.0, 5.0), (8.0, 5.0)), ((8.0, 7.0), (8.0, 8.0))]
STOPS = [(2, 2), (2, 5), (3, 3), (5, 3), (8, 2), (7.5, 4), (7.5, 6), (6, 7), (9.5, 7.5), (9, 6), (11, 6)]
HERE = Pose(6, 3.5, 0, 1.0)


def median_s(benchmark: Any) -> float:
    return float(benchmark.stats.stats.median)


def look(pose: Pose) -> Observation:
    """Exact depth of the walls, the floor and the ceiling."""
    u, v = np.meshgrid(np.arange(CAMERA.width_px) + 0.5, np.arange(CAMERA.height_px) + 0.5)
    left, up = -(u - CAMERA.cx_px) / CAMERA.fx_px, -(v - CAMERA.cy_px) / CAMERA.fy_px
    c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    ray = np.stack([c - s * left, s + c * left, up], axis=-1)
    ray = np.where(np.abs(ray) < 1e-9, 1e-9, ray)
    eye = np.array([pose.x_m, pose.y_m, CAMERA.height_m])
    best = np.where(ray[..., 2] < 0, -eye[2] / ray[..., 2], (2.6 - eye[2]) / ray[..., 2])
    for x0, y0, x1, y1, height in WALLS:
        a, b = (np.array([x0, y0, 0.0]) - eye) / ray, (np.array([x1, y1, height]) - eye) / ray
        enter, leave = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
        best = np.where((enter <= leave) & (enter > 0) & (enter < best), enter, best)
    return Observation(np.zeros((*u.shape, 3), np.uint8), best.astype(np.float32), pose, CAMERA)


def sighting(
    category: str, x: float, y: float, box: int, surface: tuple[tuple[float, float], ...] = (), passage: bool = False
) -> Sighting:
    return Sighting(
        category, 0.8, (box, 0, box + 9, 9), (x, y, 0.5), 1.5, 0.0, 0.9, (), passage, 900, surface or ((x, y), (x + 0.2, y + 0.1))
    )


@pytest.fixture(scope="module")
def world() -> tuple[SpatialCognitiveMemory, MetricMap]:
    """60 waypoints in four rooms on a map of them, seen by 144 images."""
    memory, metric_map, rng = SpatialCognitiveMemory(), MetricMap(), np.random.default_rng(0)
    doors = [sighting("doorway", (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 9 * k, (a, b), True) for k, (a, b) in enumerate(DOORS)]
    for index in range(WAYPOINTS):
        x, y = np.array(STOPS[index % len(STOPS)]) + rng.uniform(-0.8, 0.8, 2)
        pose = Pose(float(x), float(y), 0.0, float(rng.uniform(-3, 3)))
        if index < len(STOPS):
            for k in range(12):
                metric_map.integrate(look(pose.turned(k * math.pi / 6)))
        region = "bedroom" if x < 4 else "living room" if y < 5 else "kitchen" if x < 8 else "office"
        memory.add_waypoint(pose, f"{region} - sofa", doors, metric_map)
    for k in range(12):
        metric_map.integrate(look(HERE.turned(k * math.pi / 6)))
    return memory, metric_map


def test_text_with_60_waypoints_field_included(benchmark: Any, world: tuple[SpatialCognitiveMemory, MetricMap]) -> None:
    memory, metric_map = world
    shift = iter(np.arange(1, 10**6) * 1e-7)

    def text() -> str:
        pose = Pose(HERE.x_m + float(next(shift)), HERE.y_m, 0.0, HERE.yaw_rad)  # a new start: no kept field
        arranged = arrange(memory.hierarchical, pose, metric_map)
        return serialize(memory.hierarchical, pose, metric_map.floor, arranged, metric_map.frontiers(pose))

    benchmark(text)
    assert median_s(benchmark) < TEXT_S


def test_rendered_map_with_60_waypoints(benchmark: Any, world: tuple[SpatialCognitiveMemory, MetricMap]) -> None:
    memory, metric_map = world
    shown = [item.waypoint for item in arrange(memory.hierarchical, HERE, metric_map)]
    benchmark(render_map, memory.hierarchical, HERE, metric_map, shown)
    assert median_s(benchmark) < RENDERED_MAP_S


def test_landmark_update_with_ten_candidates(benchmark: Any, world: tuple[SpatialCognitiveMemory, MetricMap]) -> None:
    landmarks = LocalLandmarkMemory("chair", HERE)
    chairs = [sighting("chair", 5 + 0.7 * (k % 5), 2 + k // 5, 10 * k) for k in range(10)]
    benchmark(landmarks.update, chairs, HERE, world[1])
    assert median_s(benchmark) < LANDMARKS_S


def test_lifting_ten_detections_at_640x480(benchmark: Any) -> None:
    camera = Camera(640, 480, 79.0, 0.88)
    depth = np.full((480, 640), 3.0, np.float32)
    observation = Observation(np.zeros((480, 640, 3), np.uint8), depth, HERE, camera)
    mask = np.ones((120, 100), np.bool_)
    found = [Detection("doorway" if k % 5 == 0 else "chair", (60 * k, 100, 60 * k + 100, 220), 0.8, mask) for k in range(9)] + [
        Detection("sofa", (100, 200, 500, 460), 0.8, np.ones((260, 400), np.bool_))
    ]
    benchmark(lift, observation, found)
