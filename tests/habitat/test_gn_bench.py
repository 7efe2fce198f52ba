"""GN-Bench beside a stand-in of its simulator: bodies, pictures, ways, and a whole run from file to table."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bridge_world import DATA, HERE, RECORDS, use_standin
from splat_world import PIXEL_M, SCENE, episode, setup, small, write_episodes, write_scene
from test_pipelines import spacevln

from spacevln.assembly import Configuration
from spacevln.core import (
    Detection,
    EnvironmentFailure,
    EpisodeSpec,
    InstructionTask,
    MoveForward,
    Observation,
    Pose,
    PrerequisiteError,
    UsageError,
)
from spacevln.environments.bridge.frame import pose_from_habitat
from spacevln.environments.gn_bench.environment import GNBenchEnvironment
from spacevln.environments.gn_bench.occupancy import load_occupancy
from spacevln.evaluation import datasets
from spacevln.evaluation.attempt import Session
from spacevln.recording import RecordLevel
from spacevln.testing.environment import EnvironmentConformance

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def _standin(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[GNBenchEnvironment]:
    made = small(tmp_path_factory.mktemp("scenes"))
    yield made
    made.close()


class TestContract(EnvironmentConformance):
    position_tolerance_m = 1e-5
    angle_tolerance_rad = 1e-5

    @pytest.fixture
    def environment(self, world: GNBenchEnvironment) -> GNBenchEnvironment:
        return world

    @pytest.fixture(autouse=True)
    def _folder(self, tmp_path: Path) -> None:
        self.folder = tmp_path

    def make_environment(self) -> GNBenchEnvironment:
        return small(self.folder)

    def make_episode(self) -> EpisodeSpec:
        return episode()


def test_a_wall_stops_the_body_at_the_last_free_pixel(world: GNBenchEnvironment) -> None:
    world.reset(episode(-1.5, -3.5, math.pi / 2))  # towards the wall at y = -0.06, four pixels from which the body stays
    motions = [world.execute(MoveForward()) for _ in range(16)]
    free = [motion for motion in motions if not motion.collided]
    assert all(motion.moved_m == pytest.approx(0.25, abs=1e-5) for motion in free)
    assert 12 <= len(free) < 16
    y_m = -3.5 + world.observe().pose.x_m
    assert -0.06 - 5.5 * PIXEL_M < y_m < -0.06 - 4 * PIXEL_M
    again = world.execute(MoveForward())
    assert again.collided
    assert again.moved_m < PIXEL_M


def test_pictures_are_the_recorded_ones(tmp_path: Path) -> None:
    world = GNBenchEnvironment(setup(tmp_path, depth_min_m=0.0, depth_max_m=100.0, camera_height_m=0.98))
    recorded = np.load(DATA / "frames.npz")["depth_mm"]
    for index in (0, 4):
        pose = pose_from_habitat(RECORDS["poses"][index]["position"], RECORDS["poses"][index]["rotation"])
        seen = world.reset(EpisodeSpec("1", SCENE, Pose(pose.x_m, pose.y_m, 0.0, pose.yaw_rad), InstructionTask("go")))
        assert (np.abs(1000 * seen.depth_m - recorded[index]) > 4).mean() < 2e-3  # edges
        assert seen.T_world_camera[2, 3] == pytest.approx(0.98, abs=1e-6)
        assert seen.labels is None
    assert world.simulator.starts == 1
    world.close()


def test_ways_are_the_simulators_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from spacevln_bridge.gn_bench import reference_of

    monkeypatch.syspath_prepend(str(HERE / "standin"))
    import GN_Bench

    scene = write_scene(tmp_path) / SCENE
    (tmp_path / "reference.json").write_text(json.dumps(reference_of(scene)))
    configuration = GN_Bench.get_config().SIMULATOR.clone()
    configuration.defrost()
    configuration.SCENE, configuration.REF_JSON = str(scene), str(tmp_path / "reference.json")
    sim = GN_Bench.sims.make_sim("Sim-v0", config=configuration)
    sim.reconfigure(configuration)
    ours = small(tmp_path).geodesics(SCENE)
    rng = np.random.default_rng(0)
    lengths = []
    for _ in range(12):  # some ends inside of walls and furniture, some outside of the house
        start, end = (np.array([rng.uniform(-8.3, 0.3), rng.uniform(-10.3, 0.3), 0.0]) for _ in range(2))
        lengths.append(float(ours.distances_m(start[None], end[None])[0]))
        assert lengths[-1] == pytest.approx(sim.geodesic_distance(start, [end]), abs=1e-9)
    assert np.isfinite(lengths).all()
    both = np.array([[-5.0, -3.0, 0.0], [-2.0, -8.0, 0.0]])
    here = np.array([-1.5, -3.5, 0.0])
    assert ours.distances_m(here[None], both)[0] == min(ours.distances_m(here[None], each[None])[0] for each in both)
    bends = ours.path(here, both[:1])
    assert np.linalg.norm(bends[0] - here) < PIXEL_M
    assert np.linalg.norm(bends[-1] - both[0]) < PIXEL_M


def test_a_closed_room_has_no_way_out(tmp_path: Path) -> None:
    import cv2

    picture = write_scene(tmp_path) / SCENE / "occupancy.png"
    gray = cv2.imread(str(picture), cv2.IMREAD_UNCHANGED)
    gray[:, 100:103] = 0
    cv2.imwrite(str(picture), gray)
    world = GNBenchEnvironment(setup_of(tmp_path))
    ends = load_occupancy(tmp_path / SCENE).points_of(np.array([[60, 60], [140, 60]]))
    assert math.isinf(world.geodesics(SCENE).distances_m(ends[:1], ends[1:])[0])
    assert len(world.geodesics(SCENE).path(ends[0], ends[1:])) == 1


@pytest.mark.parametrize("name", ["occupancy.json", "occupancy.png", "3dgs_compressed.ply"])
def test_what_a_building_lacks_is_named(name: str, tmp_path: Path) -> None:
    (write_scene(tmp_path) / SCENE / name).unlink()
    world = GNBenchEnvironment(setup_of(tmp_path))
    with pytest.raises(PrerequisiteError, match=rf"lacks {name}"):
        world.reset(episode())
    if name.startswith("occupancy"):
        with pytest.raises(PrerequisiteError, match=r"occupancy map .* cannot be read"):
            world.geodesics(SCENE)
    world.close()


def test_damaged_maps_are_told(tmp_path: Path) -> None:
    picture = write_scene(tmp_path) / SCENE / "occupancy.png"
    for content in (b"", b"no picture"):
        picture.write_bytes(content)
        with pytest.raises(PrerequisiteError, match=r"no picture of 8-bit grays"):
            load_occupancy(tmp_path / SCENE)


def test_a_worker_runs_one_simulator(world: GNBenchEnvironment) -> None:
    from spacevln_bridge import messages as say

    world.reset(episode())
    point = say.pack([[0.0, 0.0, 0.0]])
    with pytest.raises(UsageError, match=r"Distances is no request of GNBenchSim"):
        world.simulator.ask(say.Distances(point, point), say.Numbers)
    world.simulator.worker.close()
    with pytest.raises(EnvironmentFailure, match=r"worker of GN-Bench's simulator was lost"):
        world.execute(MoveForward())


def setup_of(folder: Path) -> Any:
    """As :func:`splat_world.setup`, without writing the building again."""
    from spacevln.environments.gn_bench.setup import GNBenchSetup

    return GNBenchSetup(python=sys.executable, scenes=str(folder), gpu_device=-1)


def place(tmp_path: Path, numbers: tuple[int, ...]) -> list[str]:
    data = write_episodes(tmp_path / "InteriorGS_test_unseen.parquet", numbers)
    scenes = str(write_scene(tmp_path / "scenes"))
    return ["--data", str(data), "--simulator-python", sys.executable, "--scenes", scenes, "--gpu-device", "-1"]


@pytest.mark.parametrize("driver", ["oracle", "reference"])
def test_reference_walks_succeed_from_file_to_table(driver: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HABITAT_STANDIN_COARSE", "8")
    out = tmp_path / "out"
    spacevln("bench", "gn-bench", *place(tmp_path, (1, 7)), "--driver", driver, "--out", str(out))
    found = json.loads((out / "summary.json").read_text())
    assert found["episodes"] == 2
    assert found["metrics"]["SR"] == 100
    assert found["metrics"]["SPL"] > 75
    configuration = json.loads((out / "run.json").read_text())["configuration"]
    assert configuration["environment"]["simulator"] == "gn-bench"
    assert configuration["step_budget"] == 300
    assert "SR" in spacevln("table", str(out))


def test_doctor_looks_into_a_building_of_splats(tmp_path: Path) -> None:
    said = spacevln("doctor", *place(tmp_path, (1,)), "--suite", "gn-bench")
    assert "GN-Bench's simulator unknown answers" in said
    assert "380 Gaussians" in said
    assert "a frame of 640x480 pixels" in said
    assert "the way to the goal is" in said


class Blind:
    """A detector that finds nothing."""

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        del queries
        return [() for _ in observations]


def test_the_agent_runs_and_is_judged(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HABITAT_STANDIN_COARSE", "8")
    (one,) = datasets.load("gn-bench", write_episodes(tmp_path / "InteriorGS_test_unseen.parquet", (1,)))
    world = GNBenchEnvironment(setup(tmp_path / "scenes"))
    with Session(Configuration(step_budget=40), world, detector=Blind()) as session:
        result = session.attempt(one, tmp_path / "record", level=RecordLevel.LIGHT)
    assert result.status in ("stopped", "step_limit"), result.detail
    assert result.metrics.SR is not None
    assert result.truth is not None
    assert result.truth.geodesic_m > 3
