"""Properties that hold for any frame, place and order (hypothesis)."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from worlds import look, room

from spacevln.core import Observation, Pose
from spacevln.mapping import MetricMap
from spacevln.mapping.tiles import TILE_CELLS, TiledLayer

WORLD = [*room(-2.213, -2.687, 3.121, 2.331), (1.017, 0.331, 0.0, 1.621, 0.917, 0.8)]
FRAMES = [look(WORLD, Pose(0.1 * k, 0.05 * k, 0.0, k * math.pi / 3)) for k in range(6)]
GRID = np.stack(np.meshgrid(np.arange(-2.5, 3.5, 0.1), np.arange(-3, 2.6, 0.1)), axis=-1).reshape(-1, 2) + 0.025


def mapped(frames: list[Observation]) -> MetricMap:
    world_map = MetricMap()
    for frame in frames:
        world_map.integrate(frame)
    return world_map


def moved(frame: Observation, origin: Pose) -> Observation:
    return Observation(frame.rgb, frame.depth_m, origin.compose(frame.pose), frame.camera)


BASE = mapped(FRAMES)


@settings(max_examples=15, deadline=None)
@given(x=st.floats(-5000, 5000), y=st.floats(-5000, 5000), z=st.floats(-50, 50), yaw=st.floats(-math.pi, math.pi))
def test_another_frame_of_reference_gives_the_transformed_map(x: float, y: float, z: float, yaw: float) -> None:
    origin = Pose(x, y, z, yaw)
    other = mapped([moved(frame, origin) for frame in FRAMES])
    c, s = math.cos(yaw), math.sin(yaw)
    there = GRID @ np.array([[c, s], [-s, c]]) + (x, y)
    for name, share in (("is_explored", 0.97), ("is_free", 0.96), ("is_obstacle", 0.95)):
        a, b = getattr(BASE, name)(GRID), getattr(other, name)(there)
        assert np.mean(a == b) >= share, name
    assert other.nbytes <= 3 * BASE.nbytes
    ends = np.array([(-1.0, 1.5), (2.3, -1.5)]) @ np.array([[c, s], [-s, c]]) + (x, y)
    assert abs(other.geodesic_m(*ends) - BASE.geodesic_m((-1.0, 1.5), (2.3, -1.5))) < 0.2


@settings(max_examples=15, deadline=None)
@given(order=st.permutations(range(len(FRAMES))))
def test_order_of_frames_does_not_matter_for_explored(order: list[int]) -> None:
    # Far steps between frames, so that no way between them is drawn.
    frames = [moved(FRAMES[k], Pose(0.7 * k, 0.0)) for k in range(len(FRAMES))]
    points = np.concatenate([GRID + np.array([0.7 * k, 0]) for k in range(6)])
    ordered = mapped(frames).is_explored(points)
    assert np.array_equal(mapped([frames[k] for k in order]).is_explored(points), ordered)


@settings(max_examples=20, deadline=None)
@given(
    share=st.floats(0.01, 0.5),
    bad=st.sampled_from([0.0, math.nan, math.inf, -math.inf, -3.0, 0.2, 7.0]),
    seed=st.integers(0, 1000),
)
def test_holes_only_take_away(share: float, bad: float, seed: int) -> None:
    holes = np.random.default_rng(seed).random(FRAMES[0].depth_m.shape) < share
    depth = np.where(holes, np.float32(bad), FRAMES[0].depth_m).astype(np.float32)
    damaged = mapped([Observation(FRAMES[0].rgb, depth, FRAMES[0].pose, FRAMES[0].camera)])
    whole = mapped(FRAMES[:1])
    # Rows of a lying surface are joined over a gap, and a hole can choose another pair of rows: a cell beside the surface.
    assert (damaged.is_obstacle(GRID) & ~whole.is_obstacle(GRID)).sum() <= 3
    assert (damaged.is_explored(GRID) & ~whole.is_explored(GRID)).sum() <= 3


@settings(max_examples=25, deadline=None)
@given(a=st.tuples(st.floats(-2, 3), st.floats(-2.5, 2)), b=st.tuples(st.floats(-2, 3), st.floats(-2.5, 2)))
def test_ways_are_symmetric_walkable_and_never_shorter_than_straight(a: tuple[float, float], b: tuple[float, float]) -> None:
    there, back = BASE.geodesic_m(a, b), BASE.geodesic_m(b, a)
    assert math.isinf(there) == math.isinf(back)
    way = BASE.path(a, b)
    if math.isinf(there):
        assert len(way) == 0
        return
    assert abs(there - back) <= 0.05 + 0.03 * there
    assert there >= math.dist(a, b) - 1e-6
    legs = np.hypot(*np.diff(way, axis=0).T)
    snapped = math.dist(a, way[0]) + math.dist(b, way[-1])
    assert abs(legs.sum() + snapped - there) <= 0.05 + 0.03 * there
    for start, end in pairwise(way):
        on_leg = start + np.linspace(0, 1, 200)[:, None] * (end - start)
        assert BASE.is_free(on_leg).mean() > 0.97


@settings(max_examples=30, deadline=None)
@given(i=st.integers(-(10**7), 10**7), j=st.integers(-(10**7), 10**7), rows=st.integers(1, 500), columns=st.integers(1, 300))
def test_tiles_give_back_what_was_written(i: int, j: int, rows: int, columns: int) -> None:
    layer = TiledLayer()
    window = np.random.default_rng(rows).integers(1, 255, (rows, columns)).astype(np.uint8)
    layer.write(i, j, window)
    assert np.array_equal(layer.window(i, j, rows, columns), window)
    cells = np.array([(i, j), (i + rows - 1, j + columns - 1), (i - 1, j)])
    assert layer.at(cells).tolist() == [window[0, 0], window[-1, -1], 0]
    assert layer.nbytes == len(layer.tiles) * TILE_CELLS**2
    layer.write(i + 5000, j, np.zeros((3, 3), np.uint8))
    assert not layer.window(i + 5000, j, 3, 3).any()
    assert layer.nbytes == len(layer.tiles) * TILE_CELLS**2


def test_memory_grows_with_the_explored_area_only() -> None:
    world_map = MetricMap()
    sizes = []
    for k in range(30):
        for frame in FRAMES[:2]:
            world_map.integrate(moved(frame, Pose(100.0 * k, -70.0 * k)))
        sizes.append(world_map.nbytes)
    per_place = np.diff(sizes)
    assert per_place.max() <= 3 * 4 * TILE_CELLS**2
    before = world_map.nbytes
    for _ in range(5):
        for frame in FRAMES[:2]:
            world_map.integrate(moved(frame, Pose(0, 0)))
    assert world_map.nbytes <= before + 64 * 3 * 8  # the trace
