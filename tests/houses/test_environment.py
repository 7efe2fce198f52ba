"""The houses environment: conformance, and what is its own."""

from __future__ import annotations

import math

import numpy as np
import pytest
import two_rooms

from spacevln.core import (
    Camera,
    ContractError,
    EpisodeSpec,
    InstanceLabel,
    InstructionTask,
    MoveForward,
    Pose,
    Stop,
    TurnLeft,
    UnknownNameError,
)
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.houses.rendering import renderer_info
from spacevln.testing.environment import EnvironmentConformance

SMALL = Camera(160, 120, 79.0, 0.88)
START = Pose(0.8, 2.0, 0.0, 0.0)
needs_gl = pytest.mark.skipif(renderer_info("auto").name != "gl", reason="no OpenGL library here")


def episode(start: Pose = START, scene: str = "house-000000") -> EpisodeSpec:
    return EpisodeSpec("1", scene, start, InstructionTask("go through the door"))


class TestRaycastHouse(EnvironmentConformance):
    def make_environment(self) -> HousesEnvironment:
        return HousesEnvironment(SMALL, renderer="raycast", load=two_rooms.place)

    def make_episode(self) -> EpisodeSpec:
        return episode()


@needs_gl
class TestGLHouse(EnvironmentConformance):
    def make_environment(self) -> HousesEnvironment:
        return HousesEnvironment(SMALL, renderer="gl", load=two_rooms.place)

    def make_episode(self) -> EpisodeSpec:
        return episode(Pose(0.8, 2.1, 0.0, 0.4))


@pytest.fixture
def environment():
    environment = HousesEnvironment(SMALL, renderer="raycast", load=two_rooms.place)
    yield environment
    environment.close()


def test_labels_come_with_category_and_attributes(environment):
    environment.reset(episode(Pose(1.0, 1.5, 0.0, math.pi / 2)))
    labels = environment.observe().labels
    assert labels.instances == {two_rooms.BOX: InstanceLabel("cabinet", ("red",))}
    assert (labels.instance_ids == two_rooms.BOX).sum() > 500


def test_doorways_are_instances_and_rooms_are_not_named(environment):
    labels = environment.reset(episode()).labels
    assert labels.instances[two_rooms.DOOR] == InstanceLabel("doorway", ("white",))
    assert not {label.category for label in labels.instances.values()} & {"living room", "bedroom"}


def test_the_same_pose_is_drawn_once(environment):
    first = environment.reset(episode())
    assert environment.observe() is first
    environment.execute(TurnLeft(30.0))
    assert environment.observe() is not first


def test_sliding_can_be_switched_off():
    moved = {}
    for sliding in (True, False):
        environment = HousesEnvironment(SMALL, renderer="raycast", sliding=sliding, load=two_rooms.place)
        environment.reset(episode(Pose(3.85, 1.0, 0.0, math.radians(45))))
        moved[sliding] = environment.execute(MoveForward(0.25))
        environment.close()
    assert moved[True].collided
    assert moved[False].collided
    assert moved[True].moved_m > moved[False].moved_m + 0.05


@pytest.mark.parametrize("action", [MoveForward(0.5), MoveForward(0.0), TurnLeft(15.0)])
def test_only_primitives_are_executed(environment, action):
    environment.reset(episode())
    with pytest.raises(ContractError, match="no primitive"):
        environment.execute(action)


def test_nothing_is_executed_outside_an_episode(environment):
    with pytest.raises(ContractError, match="reset"):
        environment.observe()
    with pytest.raises(ContractError, match="reset"):
        environment.execute(Stop())
    environment.reset(episode())
    environment.execute(Stop())
    with pytest.raises(ContractError, match="outside an episode"):
        environment.execute(TurnLeft(30.0))


def test_many_scenes_may_be_visited_again(environment):
    pictures = [environment.reset(episode(scene=f"house-{seed:06d}")).rgb for seed in (0, 1, 2, 3, 4, 5, 0)]
    np.testing.assert_array_equal(pictures[0], pictures[-1])


def test_an_unknown_renderer_is_refused_with_the_nearest_name():
    with pytest.raises(UnknownNameError, match="raycast"):
        HousesEnvironment(renderer="raycasts")  # type: ignore[arg-type]


def test_the_camera_is_smaller_when_rays_are_cast():
    small = HousesEnvironment(renderer="raycast", load=two_rooms.place).spec.camera
    assert (small.width_px, small.height_px, small.hfov_deg, small.height_m) == (320, 240, 79.0, 0.88)
