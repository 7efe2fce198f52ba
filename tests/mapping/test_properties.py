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


@settings(max_examples=10, deadline=None)
@given(i=st.integers(-500, 500), j=st.integers(-500, 500))
def test_kilometres_away_a_map_costs_the_same_and_is_the_same(i: int, j: int) -> None:
    shift = np.array([i, j]) * TILE_CELLS * BASE.resolution_m
    other = mapped([moved(frame, Pose(*shift)) for frame in FRAMES])
    for name in ("is_explored", "is_free", "is_obstacle"):
        assert np.mean(getattr(BASE, name)(GRID) == getattr(other, name)(GRID + shift)) > 0.999, name
    layers = [(a._tracker.floors[0].seen, a._tracker.floors[0].solid) for a in (BASE, other)]
    for here, there in zip(*layers, strict=True):
        assert {(a + i, b + j) for a, b in here.tiles} == set(there.tiles)


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


def test_a_cell_costs_a_byte_per_layer_and_only_touched_tiles_are_held() -> None:
    world_map = MetricMap()
    for k in range(12):
        world_map.integrate(moved(FRAMES[k % 6], Pose(4.0 * k, -3.0 * k)))
    world_map.frontiers(Pose(0, 0))
    floor = world_map._tracker.floors[0]
    layers = [floor.seen, floor.solid, floor.ground, floor.reachable.passable, floor.reachable.border]
    touched = [sum(bool(tile.any()) for tile in layer.tiles.values()) for layer in layers]
    assert sum(len(layer.tiles) for layer in layers) <= 2 * sum(touched)
    cells = sum(touched) * TILE_CELLS**2
    assert cells <= sum(layer.nbytes for layer in layers) <= 3 * cells
    assert world_map.nbytes == sum(layer.nbytes for layer in layers) + world_map._trace.nbytes


def test_a_frame_costs_no_more_on_a_long_walk() -> None:
    world_map, tiles, windows = MetricMap(), [], []
    for k in range(200):
        world_map.integrate(moved(FRAMES[0], Pose(10.0 * k, 0.0)))
        floor = world_map._tracker.floors[0]
        tiles.append(len(floor.reachable.changed))
        world_map.frontiers(Pose(10.0 * k, 0.0))
        windows.append(world_map.geodesic_field((10.0 * k, 0.0)).grid.passable.size)
    assert max(tiles[100:]) <= max(tiles[:100]) <= 9
    assert max(windows[100:]) <= max(windows[:100])
    assert sum(buffer.size for buffer in world_map._writer._scratch.values()) < 5_000_000


def test_ways_follow_the_map_as_it_changes() -> None:
    wall = (0.9, -3.0, 0.0, 1.0, 3.0, 2.0)
    open_room, closed_room = room(-2, -2, 3, 2), [*room(-2, -2, 3, 2), wall]
    world_map = MetricMap()
    for k in range(8):
        world_map.integrate(look(open_room, Pose(-0.5, 0, 0, k * math.pi / 4)))
    assert world_map.geodesic_m((-0.5, 0), (2.0, 0.5)) < 2.7
    world_map.integrate(look(closed_room, Pose(-0.5, 0)))
    blocked = world_map.geodesic_m((-0.5, 0), (2.0, 0.5))
    assert blocked > 2.7
    assert not world_map.line_of_sight((-0.5, 0), (2.0, 0.5))
    for _ in range(2):
        for k in range(8):
            world_map.integrate(look(open_room, Pose(-0.5, 0, 0, k * math.pi / 4)))
    assert world_map.geodesic_m((-0.5, 0), (2.0, 0.5)) < 2.7
    again = MetricMap.from_arrays(world_map.to_arrays())
    pose = Pose(-0.5, 0)
    assert again.frontiers(pose) == world_map.frontiers(pose)  # kept up piece by piece as if made at once
