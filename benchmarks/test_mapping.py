"""Speed of the map: one thread, 640x480 full-resolution depth. ``pytest benchmarks --benchmark-only``."""

from __future__ import annotations

import itertools
import math

import numba
import numpy as np
import pytest

from spacevln.core import Camera, Observation, Pose, Sighting
from spacevln.mapping import MetricMap

CAMERA = Camera(640, 480, 79.0, 0.88)
BOXES = np.array(
    [
        (-6, -5, -0.2, 6, 5, 0),
        (-6, -5, 2.6, 6, 5, 2.8),
        (-5.2, -5, 0, -5, 5, 2.6),
        (5, -5, 0, 5.2, 5, 2.6),
        (-5, -5.2, 0, 5, -5, 2.6),
        (-5, 5, 0, 5, 5.2, 2.6),
        (1.5, 0.5, 0, 2.2, 1.5, 0.75),
        (-0.1, 1, 0, 0.1, 5, 2.6),
        (-3, -3, 0, -2, -2, 0.45),
    ],
    float,
)


@numba.njit(cache=True)
def _depth(boxes: np.ndarray, x: float, y: float, yaw: float, fx: float, width: int, height: int) -> np.ndarray:
    out = np.zeros((height, width), np.float32)
    origin = np.array([x, y, 0.88])
    for v in range(height):
        for u in range(width):
            left, up = -(u + 0.5 - width / 2) / fx, -(v + 0.5 - height / 2) / fx
            ray = np.array([np.cos(yaw) - np.sin(yaw) * left, np.sin(yaw) + np.cos(yaw) * left, up + 1e-12])
            best = np.inf
            for k in range(len(boxes)):
                enter, leave = 0.0, np.inf
                for axis in range(3):
                    a, b = (boxes[k, axis] - origin[axis]) / ray[axis], (boxes[k, axis + 3] - origin[axis]) / ray[axis]
                    enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
                if enter <= leave and enter < best:
                    best = enter
            out[v, u] = best
    return out


def look(x: float, y: float, yaw: float) -> Observation:
    depth = _depth(BOXES, x, y, yaw, CAMERA.fx_px, CAMERA.width_px, CAMERA.height_px)
    return Observation(np.zeros((480, 640, 3), np.uint8), depth, Pose(x, y, 0.0, yaw), CAMERA)


@numba.njit(cache=True)
def bare_scatter(depth: np.ndarray, fx: float, fy: float, cx: float, cy: float, c: float, s: float, grid: np.ndarray) -> None:
    """The yardstick: float32 depth in, one uint8 grid out, range and height test, nothing else."""
    for v in range(depth.shape[0]):
        up = -(np.float32(v) + np.float32(0.5) - cy) / fy
        for u in range(depth.shape[1]):
            d = depth[v, u]
            if d >= np.float32(0.5) and d <= np.float32(5.0):
                z = np.float32(0.88) + d * up
                if z >= np.float32(0.15) and z <= np.float32(1.30):
                    left = -(np.float32(u) + np.float32(0.5) - cx) / fx * d
                    x, y = c * d - s * left, s * d + c * left
                    grid[int((x + np.float32(8)) * np.float32(20)), int((y + np.float32(8)) * np.float32(20))] = 1


@pytest.fixture(scope="module")
def frames() -> list[Observation]:
    return [look(0.2 * k, 0.1 * k, k * math.pi / 6) for k in range(12)]


@pytest.fixture(scope="module")
def world_map() -> MetricMap:
    explored = MetricMap()
    for x, y in itertools.product((-3, 0, 3), (-3, 0, 3)):
        for k in range(12):
            explored.integrate(look(x + 0.3, y + 0.2, k * math.pi / 6))
    return explored


def test_bare_project_and_scatter(benchmark, frames) -> None:
    grid, f = np.zeros((320, 320), np.uint8), np.float32
    turn = itertools.cycle(frames)

    def run() -> None:
        frame = next(turn)
        yaw = frame.pose.yaw_rad
        bare_scatter(
            frame.depth_m,
            f(CAMERA.fx_px),
            f(CAMERA.fy_px),
            f(CAMERA.cx_px),
            f(CAMERA.cy_px),
            f(math.cos(yaw)),
            f(math.sin(yaw)),
            grid,
        )

    run()
    benchmark(run)


def test_integrate(benchmark, frames, world_map) -> None:
    turn = itertools.cycle(frames)
    sighting = Sighting("sofa", 0.9, (0, 0, 5, 5), (1.0, 0.5, 0.4), 1.1, 0.46, 0.6, surface_m=((1.0, 0.5), (1.1, 0.5)))
    benchmark(lambda: world_map.integrate(next(turn), [sighting]))


def test_heading_up_crop_of_24_m(benchmark, world_map) -> None:
    benchmark(lambda: world_map.crop((0, 0), 24.0, 0.4))


def test_obstacle_sectors(benchmark, frames, world_map) -> None:
    turn = itertools.cycle(frames)
    benchmark(lambda: world_map.obstacle_distances(next(turn)))


def test_geodesic_field_of_100_m2(benchmark, frames, world_map) -> None:
    def run() -> None:
        world_map.integrate(frames[0])
        world_map._floor.version += 1  # noqa: SLF001 - so that nothing is taken from the cache
        world_map.geodesic_field((0.2, 0.1))

    benchmark(run)


def test_geodesic_field_of_24_m_all_free(benchmark) -> None:
    from spacevln.mapping.geodesics import FreeGrid

    grid = np.ones((480, 480), np.uint8)
    grid[0] = grid[-1] = grid[:, 0] = grid[:, -1] = 0
    free = FreeGrid(0, 0, 0.05, grid)
    benchmark(lambda: free.field((12.0, 12.0)))


def test_frontiers(benchmark, world_map) -> None:
    pose = Pose(0.2, 0.1)
    benchmark(lambda: world_map.frontiers(pose))
