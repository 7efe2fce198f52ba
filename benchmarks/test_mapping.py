"""Speed of the map: one thread, 640x480 full-resolution depth. Every goal is a median and asserted.

``pytest benchmarks/test_mapping.py --benchmark-only``; add ``--benchmark-timer=time.process_time`` on a busy machine.
"""

from __future__ import annotations

import itertools
import math
import time
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

from spacevln.core import Camera, Observation, Pose, Sighting
from spacevln.mapping import MetricMap, unknown_bearings

INTEGRATE_S, TIMES_BARE = 0.004, 3.0
CROP_S, SECTORS_S, BEARINGS_S = 0.002, 0.0005, 0.002
FIELD_100_M2_S, FIELD_ALL_FREE_S = 0.010, 0.050
SAVE_AND_LOAD_S, LAST_OVER_FIRST = 1.0, 1.1
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


def median_s(benchmark: Any) -> float:
    return float(benchmark.stats.stats.median)


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
    assert median_s(benchmark) < INTEGRATE_S


def test_integrate_into_a_fresh_map(benchmark, frames) -> None:
    """Every frame shows something new, tiles are allocated: the dearest case."""

    def fresh() -> tuple[tuple[MetricMap, Observation], dict[str, object]]:
        return (MetricMap(), next(turn)), {}

    turn = itertools.cycle(frames)
    benchmark.pedantic(lambda explored, frame: explored.integrate(frame), setup=fresh, rounds=200, warmup_rounds=12)
    assert median_s(benchmark) < INTEGRATE_S


def test_integrate_against_the_bare_scatter(benchmark, frames, world_map) -> None:
    """Both on the same frame, one after the other, a landmark channel included."""
    grid, ratios, f = np.zeros((320, 320), np.uint8), [], np.float32
    sighting = Sighting("sofa", 0.9, (0, 0, 5, 5), (1.0, 0.5, 0.4), 1.1, 0.46, 0.6, surface_m=((1.0, 0.5), (1.1, 0.5)))
    intrinsics = f(CAMERA.fx_px), f(CAMERA.fy_px), f(CAMERA.cx_px), f(CAMERA.cy_px)
    turn = itertools.cycle(frames)

    def run() -> None:
        frame = next(turn)
        yaw = frame.pose.yaw_rad
        start = time.process_time()
        bare_scatter(frame.depth_m, *intrinsics, f(math.cos(yaw)), f(math.sin(yaw)), grid)
        between = time.process_time()
        world_map.integrate(frame, [sighting])
        ratios.append((time.process_time() - between) / (between - start))

    benchmark.pedantic(run, rounds=240, warmup_rounds=12)
    benchmark.extra_info["median_ratio"] = float(np.median(ratios))
    assert np.median(ratios) < TIMES_BARE


def test_the_end_of_two_kilometres(benchmark, frames) -> None:
    """8000 frames along a line; ``extra_info`` has how much the last 100 cost against 100 in a map as long as a room."""
    long, short = MetricMap(), MetricMap()

    def at(k: int) -> Observation:
        frame = frames[k % len(frames)]
        return Observation(frame.rgb, frame.depth_m, Pose(0.25 * k, 0.0, 0.0, frame.pose.yaw_rad), frame.camera)

    for k in range(7900):
        long.integrate(at(k))
    for k in range(100):
        short.integrate(at(k))
    costs = np.zeros((2, 100))

    def run() -> None:
        for k in range(100):
            for row, (explored, first) in enumerate(((long, 7900), (short, 100))):
                start = time.process_time()
                explored.integrate(at(first + k))
                explored.obstacle_distances(at(first + k))
                costs[row, k] = time.process_time() - start

    benchmark.pedantic(run, rounds=1)
    benchmark.extra_info["last_over_first"] = float(np.median(costs[0]) / np.median(costs[1]))
    benchmark.extra_info["nbytes"] = long.nbytes
    assert benchmark.extra_info["last_over_first"] < LAST_OVER_FIRST


def test_save_and_load_a_million_cells(benchmark, tmp_path: Path) -> None:
    big = MetricMap()
    for k in range(-9, 9):  # 18 tiles of 57 600 cells, each as full as a real one
        for frame in (look(0.3, 0.2, 0.0), look(0.3, 0.2, math.pi)):
            pose = Pose(frame.pose.x_m + 12.0 * k, frame.pose.y_m, 0.0, frame.pose.yaw_rad)
            big.integrate(Observation(frame.rgb, frame.depth_m, pose, frame.camera))

    def run() -> None:
        big.save(tmp_path / "map.npz")
        MetricMap.load(tmp_path / "map.npz")

    benchmark(run)
    assert median_s(benchmark) < SAVE_AND_LOAD_S


def test_heading_up_crop_of_24_m(benchmark, world_map) -> None:
    benchmark(lambda: world_map.crop((0, 0), 24.0, 0.4))
    assert median_s(benchmark) < CROP_S


def test_obstacle_sectors(benchmark, frames, world_map) -> None:
    turn = itertools.cycle(frames)
    benchmark(lambda: world_map.obstacle_distances(next(turn)))
    assert median_s(benchmark) < SECTORS_S


def test_geodesic_field_of_100_m2(benchmark, world_map) -> None:
    """10 x 10 m of known free space, one more field every time (a field is kept until the map changes)."""
    starts = itertools.count()
    benchmark(lambda: world_map.geodesic_field((0.2 + 1e-6 * next(starts), 0.1)))
    assert median_s(benchmark) < FIELD_100_M2_S


def test_reachability_after_a_frame(benchmark, world_map) -> None:
    """What a changed map costs the next question about ways, the field itself aside."""
    floor = world_map._tracker.current  # noqa: SLF001
    floor.reachable.refresh(floor.seen, floor.solid, floor.ground)

    def run() -> None:
        floor.reachable.touch(-100, -80, 100, 80)
        floor.reachable.refresh(floor.seen, floor.solid, floor.ground)

    benchmark(run)


def test_geodesic_field_of_24_m_all_free(benchmark) -> None:
    from spacevln.mapping.geodesics import FreeGrid

    grid = np.ones((480, 480), np.uint8)
    grid[0] = grid[-1] = grid[:, 0] = grid[:, -1] = 0
    free = FreeGrid(0, 0, 0.05, grid)
    benchmark(lambda: free.field((12.0, 12.0)))
    assert median_s(benchmark) < FIELD_ALL_FREE_S


def test_frontiers(benchmark, world_map) -> None:
    pose = Pose(0.2, 0.1)
    benchmark(lambda: world_map.frontiers(pose))


def test_bearings_of_unknown_floor(benchmark, world_map) -> None:
    pose = Pose(0.2, 0.1)
    benchmark(lambda: unknown_bearings(world_map, pose))
    assert median_s(benchmark) < BEARINGS_S
