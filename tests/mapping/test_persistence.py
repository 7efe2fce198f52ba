"""Saved maps come back whole, and what is no map is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from worlds import look, look_around, room

from spacevln.core import Observation, Pose, Sighting, UsageError
from spacevln.mapping import MetricMap
from spacevln.mapping.tiles import TILE_CELLS

WORLD = [*room(-2.2, -2.7, 3.1, 2.3), (1.0, 0.3, 0.0, 1.6, 0.9, 0.8)]
SOFA = Sighting("sofa", 0.9, (0, 0, 5, 5), (1.0, 0.5, 0.4), 1.1, 0.46, 0.6)
FRAMES = [frame for x in (0.0, 0.25, 0.5) for frame in look_around(WORLD, Pose(x, 0.1), count=6)]


@pytest.fixture
def half() -> MetricMap:
    """Half of the frames, in a stage that began on the way."""
    world_map = MetricMap(agent_radius_m=0.12)
    for frame in FRAMES[:7]:
        world_map.integrate(frame)
    world_map.start_stage()
    world_map.integrate(FRAMES[7], [SOFA])
    return world_map


def same(a: MetricMap, b: MetricMap) -> None:
    crops = [world_map.crop((0, 0), 12.0, 0.3) for world_map in (a, b)]
    for name in ("explored", "obstacle", "free", "trajectory", "stage_trajectory"):
        assert np.array_equal(getattr(crops[0], name), getattr(crops[1], name)), name
    assert crops[0].semantic.keys() == crops[1].semantic.keys()
    assert all(np.array_equal(crops[0].semantic[term], crops[1].semantic[term]) for term in crops[0].semantic)
    assert np.array_equal(a.travelled, b.travelled)
    assert np.array_equal(a.travelled_stage, b.travelled_stage)
    assert (a.floor, a.floors, a.connectors, a.version) == (b.floor, b.floors, b.connectors, b.version)
    assert (a.resolution_m, a.agent_radius_m) == (b.resolution_m, b.agent_radius_m)
    assert a.geodesic_m((0, 0), (2.5, 1.8)) == b.geodesic_m((0, 0), (2.5, 1.8))


def test_a_loaded_map_is_the_saved_one_and_goes_on_like_it(half: MetricMap, tmp_path: Path) -> None:
    half.save(tmp_path / "house.npz")
    again = MetricMap.load(tmp_path / "house.npz")
    same(half, again)
    for world_map in (half, again):
        for frame in FRAMES[8:]:
            world_map.integrate(frame)
    same(half, again)
    assert [path.name for path in tmp_path.iterdir()] == ["house.npz"]


def test_the_file_does_not_depend_on_the_order_in_which_tiles_were_touched(tmp_path: Path) -> None:
    files = []
    for order in (1, -1):
        world_map = MetricMap()
        for k in range(3)[::order]:
            frame = FRAMES[0]
            world_map.integrate(Observation(frame.rgb, frame.depth_m, Pose(30.0 * k, 0.0), frame.camera))
        world_map.start_episode()
        world_map._tracker.floors[0].version = 0
        world_map.save(tmp_path / f"{order}.npz")
        files.append((tmp_path / f"{order}.npz").read_bytes())
    assert files[0] == files[1]


def test_an_empty_map_can_be_kept(tmp_path: Path) -> None:
    MetricMap().save(tmp_path / "empty.npz")
    again = MetricMap.load(tmp_path / "empty.npz")
    assert again.floors == ()
    again.integrate(FRAMES[0])
    assert again.is_free([(0, 0)])[0]


def test_a_map_can_be_part_of_a_larger_archive(half: MetricMap) -> None:
    arrays = half.to_arrays() | {"graph/edges": np.zeros((0, 2))}
    assert all(name.startswith("map/") for name in half.to_arrays())
    same(half, MetricMap.from_arrays(arrays))


def test_a_new_episode_begins_anywhere_in_a_known_map(half: MetricMap) -> None:
    half.start_episode()
    assert len(half.travelled) == 0
    half.integrate(look(WORLD, Pose(2.0, -1.5, 0.05, math.pi)))
    assert half.floors == (0,)
    assert np.array_equal(half.travelled, [(2.0, -1.5, 0)])
    assert half.is_free([(0, 0)])[0]
    for z_m, floor in ((3.0, 1), (-2.6, -1), (6.0, 2)):
        half.start_episode()
        half.integrate(look(WORLD, Pose(0, 0, z_m, 0)))
        assert half.floor == floor


def test_what_is_no_map_is_refused_with_a_sentence(half: MetricMap, tmp_path: Path) -> None:
    path = tmp_path / "map.npz"
    with pytest.raises(UsageError, match="cannot be read as a saved map"):
        MetricMap.load(path)
    path.write_bytes(b"no zip file")
    with pytest.raises(UsageError, match="cannot be read as a saved map"):
        MetricMap.load(path)
    np.savez(path, things=np.array([{}], object))
    with pytest.raises(UsageError, match="cannot be read as a saved map"):
        MetricMap.load(path)
    np.savez(path, things=np.zeros(3))
    with pytest.raises(UsageError, match="no metric map"):
        MetricMap.load(path)
    arrays = half.to_arrays()
    header = json.loads(arrays["map/header"].tobytes()) | {"version": 99}
    with pytest.raises(UsageError, match="version 99"):
        MetricMap.from_arrays(arrays | {"map/header": np.frombuffer(json.dumps(header).encode(), np.uint8)})
    with pytest.raises(UsageError, match="damaged"):
        MetricMap.from_arrays({name: array for name, array in arrays.items() if name != "map/trace"})
    with pytest.raises(UsageError, match="damaged"):
        MetricMap.from_arrays(arrays | {"map/0/seen/tiles": np.zeros((1, TILE_CELLS, 3), np.uint8)})
