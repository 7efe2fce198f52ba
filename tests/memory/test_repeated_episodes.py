"""Repeated episodes in one building: registration, what a run with a loaded memory records, what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from spacevln.assembly import Configuration, KnownBuilding, RegisteredEnvironment
from spacevln.core import EpisodeSpec, InstructionTask, MoveForward, Pose, RecordError, TurnLeft, UsageError, transform_points
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.houses import house_episode
from spacevln.mapping import MetricMap
from spacevln.memory import BuildingMemory, HierarchicalSpatialMemory, SavedMemory, load_memory, save_memory
from spacevln.memory.map_marks import AGENT, FREE, OBSTACLE, REGIONS, THRESHOLD, UNKNOWN
from spacevln.recording import RecordLevel, read_events
from spacevln.recording.schema import EpisodeStartedLine, LookedAroundLine, StepTakenLine
from spacevln.testing.flatland import Flatland
from spacevln.viewer import draw_memory

FIRST, SECOND = Pose(1.0, 1.0, 0.0, 0.4), Pose(2.0, 1.5, 0.0, -2.0)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The record of a short episode."""
    directory = tmp_path_factory.mktemp("record")
    with Session(Configuration(step_budget=34)) as session:
        result = session.attempt(house_episode("houses-vln-000003"), directory, level=RecordLevel.LIGHT)
    assert (result.memory, result.loaded_memory) == ("memory.npz", None)
    return directory


def episode(start: Pose) -> EpisodeSpec:
    return EpisodeSpec("1", "flatland", start, InstructionTask("go"))


def empty(T_scene_episode: Pose = FIRST) -> SavedMemory:
    return SavedMemory("flatland", T_scene_episode, BuildingMemory(MetricMap(), HierarchicalSpatialMemory()))


def test_poses_and_cameras_are_in_the_memory_s_frame() -> None:
    plain, registered = Flatland(), RegisteredEnvironment(Flatland(), empty())
    pairs = [(plain.reset(episode(SECOND)), registered.reset(episode(SECOND)))]
    for action in (MoveForward(), TurnLeft(), MoveForward()):
        assert plain.execute(action) == registered.execute(action)
        pairs.append((plain.observe(), registered.observe()))
    for own, shared in pairs:
        in_scene = SECOND.compose(own.pose)
        assert FIRST.compose(shared.pose).position_m == pytest.approx(in_scene.position_m)
        ahead = np.array([[1.0, 0.2, 0.0]])
        T_shared_own = FIRST.T_world_body @ shared.T_world_camera, SECOND.T_world_body @ own.T_world_camera
        assert transform_points(T_shared_own[0], ahead) == pytest.approx(transform_points(T_shared_own[1], ahead))
    assert registered.spec == plain.spec
    registered.close()


def test_two_episodes_draw_one_map(tmp_path: Path) -> None:
    known = empty()
    for start in (FIRST, SECOND):
        environment = RegisteredEnvironment(Flatland(), known)
        known.building.start_episode()
        known.building.metric_map.integrate(environment.reset(episode(start)))
        for _ in range(12):
            environment.execute(TurnLeft())
            known.building.metric_map.integrate(environment.observe())
        if start is FIRST:
            cells = np.argwhere(known.building.metric_map.crop((0, 0), 16.0).obstacle)
        save_memory(tmp_path / "memory.npz", known)
        known = load_memory(tmp_path / "memory.npz")
    again = np.argwhere(known.building.metric_map.crop((0, 0), 16.0).obstacle)
    gaps = np.sqrt(((again[:, None] - cells[None]) ** 2).sum(axis=2)).min(axis=1) * 0.05
    assert len(cells) > 300
    assert len(again) == pytest.approx(len(cells), rel=0.05), "the same walls, seen from elsewhere, are the same cells"
    assert (gaps <= 0.1).mean() > 0.99
    assert known.building.metric_map.floors == (0,)


def test_a_run_with_a_memory_says_so_and_keeps_the_frames_apart(record: Path, tmp_path: Path) -> None:
    first, second = house_episode("houses-vln-000003"), house_episode("houses-objectnav-000003")
    setting = KnownBuilding.of(record / "memory.npz")
    with Session(Configuration(step_budget=34, memory=setting)) as session:
        result = session.attempt(second, tmp_path / "b", level=RecordLevel.LIGHT)
        with pytest.raises(UsageError, match="is of house-000003, the episode is in house-000004"):
            session.attempt(house_episode("houses-vln-000004"), tmp_path / "c", level=RecordLevel.LIGHT)
    assert (result.memory, result.loaded_memory) == ("memory.npz", setting.digest)
    lines = list(read_events(tmp_path / "b"))
    started = next(line for line in lines if isinstance(line, EpisodeStartedLine))
    turned = next(line for line in lines if isinstance(line, StepTakenLine))
    assert started.T_scene_episode.position_m == pytest.approx(first.start.position_m)
    assert started.T_scene_episode.compose(turned.pose).position_m == pytest.approx(second.start.position_m)
    looked = next(line for line in lines if isinstance(line, LookedAroundLine))
    assert looked.memory is not None
    assert "[earlier episode]" in looked.memory.text
    left = load_memory(tmp_path / "b" / "memory.npz")
    assert left.T_scene_episode == first.start
    assert len(left.building.hierarchical.chains) == 2
    assert result.truth is not None
    assert math.isfinite(result.truth.final_distance_m)
    assert result.metrics.path_length < 34 * 0.25


def test_another_file_under_the_same_name_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "memory.npz"
    save_memory(path, empty())
    setting = KnownBuilding.of(path)
    assert setting.load().scene == "flatland"
    save_memory(path, empty(SECOND))
    with pytest.raises(UsageError, match="has changed"):
        setting.load()
    with pytest.raises(UsageError, match="cannot be read"):
        KnownBuilding.of(tmp_path / "none.npz")


def test_the_memory_is_drawn_from_the_record_alone(record: Path, tmp_path: Path) -> None:
    files = draw_memory(record, tmp_path / "pictures")
    assert [path.name for path in files] == ["metric_map.png", "spatial_memory.png", "rendered_map.png", "memory.txt"]
    metric_map, spatial, rendered = (np.asarray(Image.open(path)) for path in files[:3])
    for colour in (FREE, OBSTACLE, UNKNOWN, AGENT):
        assert (metric_map == colour).all(axis=-1).sum() > 50
    assert (spatial == REGIONS[0]).all(axis=-1).sum() > 1000
    assert (spatial == THRESHOLD).all(axis=-1).sum() > 50
    assert rendered.shape == (480, 440, 3)
    told = files[3].read_text()
    assert told.startswith("Here: ")
    assert "w0" in told
    again = draw_memory(record, tmp_path / "again")
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in files]


def test_a_record_without_a_memory_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="holds no final memory"):
        draw_memory(tmp_path, tmp_path / "pictures")
    assert not (tmp_path / "pictures").exists()
