"""The camera that follows the robot: it stands in free air, shows the robot, and no agent sees through it."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import mujoco
import numpy as np
import pytest
import two_rooms

from spacevln.core import Camera, ContractError, EpisodeSpec, InstructionTask, MoveForward, Pose, Stop, TurnLeft
from spacevln.core.events import StepTaken
from spacevln.environments.houses.chase import BOOM_M, ChaseCamera
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.houses.rendering import DrawnBody, RaycastRenderer
from spacevln.recording import EpisodeRecorder, RecordLevel, read_events

SIZE = (160, 120)
POSES = [Pose(2.0, 2.0, 0.0, 0.0), Pose(0.2, 0.2, 0.0, 0.8), Pose(4.06, 2.0, 0.0, 0.0), Pose(7.9, 3.8, 0.0, -2.5)]


@pytest.fixture(scope="module")
def chase() -> ChaseCamera:
    drawable = two_rooms.drawable()
    return ChaseCamera(drawable, RaycastRenderer(drawable), DrawnBody(0.1, 0.88), SIZE)


@pytest.mark.parametrize("at", POSES, ids=["open", "corner", "doorway", "far corner"])
def test_it_stands_in_free_air_and_looks_at_the_robot(chase: ChaseCamera, at: Pose) -> None:
    T = chase.stand(at)
    assert T[:3, :3] @ T[:3, :3].T == pytest.approx(np.eye(3))
    assert T[2, 1] == pytest.approx(0.0)  # level
    model = two_rooms.drawable().model
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    to_head = np.array([at.x_m, at.y_m, 0.88]) - T[:3, 3]
    away = float(np.linalg.norm(to_head))
    assert away <= BOOM_M + 1.0
    met = mujoco.mj_ray(model, data, T[:3, 3], to_head / away, None, 1, -1, np.zeros(1, np.int32))
    assert met < 0 or met > away


@pytest.mark.parametrize("at", POSES[:2], ids=["open", "corner"])
def test_the_robot_is_in_the_picture(chase: ChaseCamera, at: Pose) -> None:
    T, camera = chase.stand(at), chase._camera
    empty = chase._renderer.render(T, camera).rgb
    changed = np.argwhere((chase.view(at) != empty).any(axis=2))
    assert len(changed) > 40
    assert SIZE[0] / 4 < changed[:, 1].mean() < 3 * SIZE[0] / 4


def test_a_wall_hides_the_robot() -> None:
    drawable = two_rooms.drawable()
    renderer, body = RaycastRenderer(drawable), DrawnBody(0.1, 0.88)
    camera = Camera(*SIZE, 79.0, 0.88)
    T = Pose(2.0, 3.2, 0.0, 0.0).T_world_body
    T[2, 3] = 1.0
    seen = []
    for x in (3.0, 6.0):  # on this side of the wall, and behind it
        frame = renderer.render(T, camera)
        before = frame.rgb.copy()
        body.draw(frame, T, camera, Pose(x, 3.2))
        seen.append(int((frame.rgb != before).any(axis=2).sum()))
    assert seen[0] > 100
    assert seen[1] == 0


def test_pictures_are_recorded_beside_the_steps_and_change_nothing_else(tmp_path: Path) -> None:
    environment = HousesEnvironment(Camera(*SIZE, 79.0, 0.88), renderer="raycast", load=two_rooms.place)
    with pytest.raises(ContractError, match="before reset"):
        environment.external_view()
    environment.reset(EpisodeSpec("1", "house-000000", Pose(0.8, 2.0), InstructionTask("go")))
    filmed = EpisodeRecorder(tmp_path / "filmed", RecordLevel.LIGHT, environment.external_view)
    plain = EpisodeRecorder(tmp_path / "plain", RecordLevel.LIGHT)
    for step, action in enumerate((MoveForward(0.25), TurnLeft(30.0), Stop()), start=1):
        motion = environment.execute(action)
        seen = None if isinstance(action, Stop) else environment.observe()
        for recorder in (filmed, plain):
            recorder.emit(StepTaken(step, 0, "execute", action, motion, environment.observe().pose, seen, ()))
    filmed.close()
    plain.close()
    lines = [list(read_events(tmp_path / name)) for name in ("filmed", "plain")]
    assert [line.external for line in lines[0]] == ["images/0001_external.jpg", "images/0002_external.jpg", None]
    assert [line.external for line in lines[1]] == [None, None, None]
    assert all(a.rgb == b.rgb and a.pose == b.pose for a, b in zip(*lines, strict=True))
    first, second = (cv2.imread(str(tmp_path / "filmed" / name)) for name in ("images/0001_rgb.jpg", "images/0001_external.jpg"))
    assert first is not None
    assert second is not None
    assert np.abs(first.astype(int) - second).mean() > 5
    assert math.isclose(environment.observe().pose.yaw_rad, math.pi / 6)
    environment.close()
