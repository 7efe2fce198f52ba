import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from drawn_house import WALK, house, remembered
from hypothesis import given, settings
from hypothesis import strategies as st

from spacevln.core import Camera, Mark, Observation, Pose, UsageError
from spacevln.mapping import MetricMap
from spacevln.memory import BuildingMemory, EdgeKind, SavedMemory, SpatialCognitiveMemory, load_memory, save_memory

START = Pose(21.5, -3.0, 0.0, 2.0)
HERE = Pose(12.0, 2.5, 0.0, 2.5)


def saved(walk: tuple[tuple[Pose, str], ...] = WALK) -> SavedMemory:
    camera = Camera(40, 30, 79.0, 0.88)
    metric_map = MetricMap()
    metric_map.integrate(Observation(np.zeros((30, 40, 3), np.uint8), np.full((30, 40), 2.0, np.float32), HERE, camera))
    return SavedMemory("house-000001", START, BuildingMemory(metric_map, remembered(house(), walk).hierarchical))


def test_a_loaded_memory_tells_the_same(tmp_path: Path) -> None:
    before = saved()
    save_memory(tmp_path / "memory.npz", before)
    after = load_memory(tmp_path / "memory.npz")
    assert (after.scene, after.T_scene_episode) == ("house-000001", START)
    one, two = (SpatialCognitiveMemory(memory.building.hierarchical).egocentric(HERE, house()) for memory in (before, after))
    assert two.text == one.text
    assert two.waypoints == one.waypoints
    assert np.array_equal(one.map_image, two.map_image)
    assert after.building.hierarchical.graph.edges == before.building.hierarchical.graph.edges
    assert after.building.metric_map.is_free(HERE.xy_m) == before.building.metric_map.is_free(HERE.xy_m)


def test_a_loaded_memory_grows_like_the_one_that_was_saved(tmp_path: Path) -> None:
    before = saved(WALK[:5])
    save_memory(tmp_path / "memory.npz", before)
    after = load_memory(tmp_path / "memory.npz")
    texts = []
    for memory in (before, after):
        cognitive, metric_map = SpatialCognitiveMemory(memory.building.hierarchical), house()
        for (previous, _), (pose, anchor) in itertools.pairwise(WALK[4:]):
            metric_map.walk(previous, pose)
            cognitive.add_waypoint(pose, anchor, [], metric_map)
        texts.append(cognitive.egocentric(HERE, metric_map).text)
    assert texts[0] == texts[1]


def test_the_same_memory_has_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        save_memory(tmp_path / name, saved())
    save_memory(tmp_path / "c", load_memory(tmp_path / "a"))
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes() == (tmp_path / "c").read_bytes()


def test_a_new_episode_begins_its_own_chain(tmp_path: Path) -> None:
    save_memory(tmp_path / "memory.npz", saved())
    memory = load_memory(tmp_path / "memory.npz")
    memory.building.start_episode()
    memory.building.start_episode()  # twice is once
    cognitive, metric_map = SpatialCognitiveMemory(memory.building.hierarchical), house()
    assert cognitive.hierarchical.chain == ()
    told = cognitive.egocentric(Pose(3, 3.2), metric_map)
    assert all(item.marks == (Mark.EARLIER,) and item.visits == 0 for item in told.waypoints)
    assert "w0 bedroom 1 [earlier episode]" in told.text
    assert "Walked so far" not in told.text
    cognitive.add_waypoint(Pose(3, 3.2), "bedroom", [], metric_map)
    metric_map.walk(Pose(3, 3.2), Pose(5.2, 2.1))
    cognitive.add_waypoint(Pose(5.2, 2.1), "hallway", [], metric_map)
    hierarchical = cognitive.hierarchical
    assert hierarchical.chains == (tuple(range(7)), (7, 8))
    chain = [(edge.a, edge.b) for edge in hierarchical.graph.edges if edge.kind is EdgeKind.CHAIN]
    assert (6, 7) not in chain
    assert (7, 8) in chain
    told = cognitive.egocentric(Pose(5.2, 2.1), metric_map)
    marks = {item.waypoint.index: (item.marks, item.merged, item.visits) for item in told.waypoints}
    assert marks[7] == ((Mark.FIRST,), (0,), 1)
    assert marks[8] == ((Mark.PREVIOUS,), (1,), 1)
    assert told.text.splitlines()[-1] == "Walked so far: w7 bedroom 1 > right 30, 2.5 m > w8 hallway 1"


def test_set_down_out_of_reach_of_what_is_known() -> None:
    memory = saved()
    memory.building.start_episode()
    metric_map = house()
    metric_map.passable[:] = 0
    told = SpatialCognitiveMemory(memory.building.hierarchical).egocentric(Pose(3, 3), metric_map)
    assert all(item.path == () and item.geodesic_m == math.inf for item in told.waypoints)
    assert "no known way" in told.text


@settings(max_examples=30)
@given(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 6), st.floats(-4, 4))
def test_the_start_of_a_later_episode_is_registered(x: float, y: float, z: float, yaw: float) -> None:
    scene = Pose(x, y, z, yaw)
    there = START.compose(saved_frame().start_of(scene))
    assert there.position_m == pytest.approx(scene.position_m, abs=1e-9)
    assert math.cos(there.yaw_rad - yaw) == pytest.approx(1.0)


def saved_frame() -> SavedMemory:
    return SavedMemory("house-000001", START, BuildingMemory(MetricMap(), SpatialCognitiveMemory().hierarchical))


def test_what_is_no_memory_is_refused_in_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "memory.npz"
    with pytest.raises(UsageError, match="cannot be read"):
        load_memory(path)
    MetricMap().save(path)
    with pytest.raises(UsageError, match="holds no Spatial Cognitive Memory"):
        load_memory(path)
    save_memory(path, saved())
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    text = arrays["memory/header"].tobytes().replace(b"spacevln-memory/1.0", b"spacevln-memory/9.0")
    np.savez(path, **arrays | {"memory/header": np.frombuffer(text, np.uint8)})
    with pytest.raises(UsageError, match=r"is no spacevln-memory/1\.0"):
        load_memory(path)
    np.savez(path, **arrays | {"memory/support/ends": np.zeros(2, np.int64)})
    with pytest.raises(UsageError, match="is damaged"):
        load_memory(path)
    del arrays["memory/ways/ends"]
    np.savez(path, **arrays)
    with pytest.raises(UsageError, match="is damaged"):
        load_memory(path)
