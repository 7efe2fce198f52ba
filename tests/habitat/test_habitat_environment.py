"""The Habitat environment keeps every environment's contract, and its walks are those of the real Habitat-Sim."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from bridge_world import DATA, RECORDS, SCENE, VERSIONS, episode, setup, small, use_standin

from spacevln.core import Action, EpisodeSpec, InstructionTask, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.environments.bridge.frame import pose_from_habitat, pose_to_habitat
from spacevln.environments.habitat.environment import HabitatEnvironment
from spacevln.testing.environment import EnvironmentConformance

ACTIONS: dict[int, Action] = {0: Stop(), 1: MoveForward(), 2: TurnLeft(), 3: TurnRight()}
BODIES = [("0.2.2", "3.8"), ("0.3.4", "current")]
MESHES = {"r010": (0.1, 0.2), "r018": (0.18, 0.2), "r018_fine": (0.18, 0.05)}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[HabitatEnvironment]:
    """One for all: a worker takes longer to start than a test to run."""
    world = small(tmp_path_factory.mktemp("scenes"))
    yield world
    world.close()


class TestContract(EnvironmentConformance):
    position_tolerance_m = 1e-5
    angle_tolerance_rad = 1e-5

    @pytest.fixture(autouse=True)
    def _standin(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        use_standin(monkeypatch, "0.3.4")
        self.folder = tmp_path

    @pytest.fixture
    def environment(self, shared: HabitatEnvironment) -> HabitatEnvironment:
        return shared

    def make_environment(self) -> HabitatEnvironment:
        return small(self.folder)

    def make_episode(self) -> EpisodeSpec:
        return episode()


@pytest.mark.slow
@pytest.mark.parametrize(("version", "which"), BODIES)
def test_walks_agree_with_the_records(version: str, which: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, version, fault="blank")  # pictures are others' matter
    traces = RECORDS["traces"][version.replace(".", "")]
    compared = 0
    for mesh, (radius_m, cell_height_m) in MESHES.items():
        for sliding in (True, False):
            chosen = [t for t in traces.values() if (t["navmesh"], t["sliding"]) == (mesh, sliding)]
            body = {"sliding": sliding, "agent_radius_m": radius_m, "cell_height_m": cell_height_m}
            world = small(tmp_path, which=which, width_px=8, height_px=6, **body)
            for trace in chosen:
                compared += _replay(world, trace["steps"])
            world.close()
    assert compared > 1500


def _replay(world: HabitatEnvironment, steps: list[list[object]]) -> int:
    _, position, rotation, _, _, _ = steps[0]
    start = pose_from_habitat(position, rotation)  # type: ignore[arg-type]
    world.reset(EpisodeSpec("1", SCENE, start, InstructionTask("go")))
    for action, position, rotation, camera, collided, _ in steps[1:]:
        motion = world.execute(ACTIONS[action])  # type: ignore[index]
        seen = world.observe()
        there, turned = pose_to_habitat(start.compose(seen.pose))
        np.testing.assert_allclose(there, position, atol=1e-5)  # type: ignore[arg-type]
        assert abs(np.dot(turned, rotation)) == pytest.approx(1, abs=1e-5)  # type: ignore[arg-type]
        eye = start.T_world_body @ seen.T_world_camera
        np.testing.assert_allclose([-eye[1, 3], eye[2, 3], -eye[0, 3]], camera, atol=1e-5)  # type: ignore[arg-type]
        assert motion.collided == bool(collided)
    return len(steps) - 1


@pytest.mark.parametrize(("version", "which"), BODIES)
def test_frames_agree_with_the_records(version: str, which: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, version)
    world = HabitatEnvironment(setup(tmp_path, which, depth_min_m=0.0, depth_max_m=100.0))
    recorded = np.load(DATA / "frames.npz")["depth_mm"]
    for index in (0, 4, 7, 11) if which == "current" else (4,):
        pose = RECORDS["poses"][index]
        seen = world.reset(episode(pose["position"], pose["rotation"]))
        assert (
            np.abs(1000 * seen.depth_m - recorded[index]).max() < 3
            or (np.abs(1000 * seen.depth_m - recorded[index]) > 3).mean() < 1e-4
        )  # edges
        assert seen.T_world_camera[2, 3] == pytest.approx(0.88, abs=1e-6)
    world.close()


def test_depth_outside_of_the_range_is_no_measurement_and_labels_name_things(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    use_standin(monkeypatch, "0.3.4")
    world = small(tmp_path, depth_max_m=2.0)
    seen = [world.reset(episode())]
    for _ in range(11):
        world.execute(TurnLeft())
        seen.append(world.observe())
    assert max(each.depth_m.max() for each in seen) <= 2.0
    assert min(each.depth_m[each.depth_m > 0].min() for each in seen) >= 0.5
    names = {label.category for each in seen if each.labels for label in each.labels.instances.values()}
    assert "sofa" in names
    assert "wall" not in names
    world.close()


@pytest.mark.parametrize("version", [pytest.param(VERSIONS[0], marks=pytest.mark.slow), VERSIONS[1]])
def test_one_worker_serves_scenes_and_episodes_and_keeps_its_mesh(
    version: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    use_standin(monkeypatch, version)
    world = small(tmp_path / "scenes", cache=str(tmp_path / "meshes"))
    other = tmp_path / "scenes" / "other.glb"
    other.parent.mkdir(parents=True, exist_ok=True)
    other.write_bytes(b"another")
    world.reset(episode())
    first = world.simulator.opened
    assert first is not None
    assert first.mesh_source == "computed"
    assert first.mesh_settings["agent_radius"] == pytest.approx(0.1)
    world.reset(EpisodeSpec("2", "other.glb", episode().start, InstructionTask("go")))
    world.reset(episode())
    again = world.simulator.opened
    assert again is not None
    assert (again.mesh_source, again.mesh_digest) == ("cached", first.mesh_digest)
    assert world.simulator.starts == 1
    world.close()


def test_distances_and_ways_agree_with_the_records(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    world = small(tmp_path)
    geodesics = world.geodesics(SCENE)
    checked = 0
    for query in RECORDS["queries"]["034"]["r010"]["paths"][:12]:
        ends = [pose_from_habitat(query[name], (0.0, 0.0, 0.0, 1.0)).position_m for name in ("start", "end")]
        found = geodesics.distances_m(ends[0][None], ends[1][None])[0]
        wanted = float(query["geodesic_distance"])
        if np.isinf(wanted):
            assert np.isinf(found)
            assert len(geodesics.path(ends[0], ends[1][None])) == 1
            continue
        assert found == pytest.approx(wanted, rel=0.03)
        corners = geodesics.path(ends[0], ends[1][None])
        assert np.linalg.norm(np.diff(corners, axis=0), axis=1).sum() == pytest.approx(found, abs=1e-3)
        checked += 1
    assert checked > 6
    world.close()


def test_the_installed_bridge_is_not_needed_beside_the_simulator(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    world = small(tmp_path)
    world.reset(episode())
    welcome = world.simulator.worker.welcome
    assert (welcome.simulator, welcome.process) == ("0.3.3", world.simulator.worker.pid)
    world.close()
