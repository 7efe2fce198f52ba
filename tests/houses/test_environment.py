"""The houses environment: conformance, and what is its own."""

from __future__ import annotations

import functools
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
    UsageError,
)
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.rendering import renderer_info
from spacevln.environments.houses.walking.motion import Body
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


class TestFurnishedHouse(EnvironmentConformance):
    def make_environment(self) -> HousesEnvironment:
        return HousesEnvironment(SMALL)

    def make_episode(self) -> EpisodeSpec:
        x, y = _free_place(5)
        return episode(Pose(x, y, 0.0, 0.0), "house-000005")


@functools.cache
def _free_place(seed: int) -> tuple[float, float]:
    """A place on the ground floor with a metre of free floor to its east."""
    walkable = Walkable(build_house(seed))
    space = walkable.floors[0]
    for i, j in np.argwhere(space.clearance_m > 0.5).tolist():
        x, y = space.centre(i, j)
        if all(walkable.is_walkable(x + d, y, 0.0, 0.3) for d in (0.3, 0.6, 0.9)):
            return x, y
    raise AssertionError("no free place")


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


def test_an_unknown_scene_is_a_usage_error():
    with pytest.raises(UsageError, match="house-000017"):
        HousesEnvironment(SMALL, renderer="raycast").reset(episode(scene="castle"))


def test_the_body_climbs_the_stairs_and_comes_down_again():
    house = next(house for house in map(build_house, range(8, 60)) if house.stairs)
    stairs = house.stairs[0]
    ux, uy = round(math.cos(stairs.up_yaw_rad)), round(math.sin(stairs.up_yaw_rad))
    length = abs(stairs.rect.width * ux + stairs.rect.depth * uy)
    low, high = (house.floors[stairs.lower_floor + k].z_m for k in (0, 1))
    x, y = stairs.rect.centre
    start = Pose(x - ux * (length / 2 + 0.3), y - uy * (length / 2 + 0.3), low, stairs.up_yaw_rad)
    body = Body(Walkable(house))
    pose, heights = start, []
    for _ in range(round((length + 0.6) / 0.25) + 1):
        pose, motion = body.forward(pose, 0.25)
        heights.append(pose.z_m)
        assert not motion.collided
    assert heights == sorted(heights)
    assert heights[-1] == pytest.approx(high)
    assert max(np.diff(heights)) <= 0.25
    pose = pose.turned(math.pi)
    for _ in heights:
        pose, _ = body.forward(pose, 0.25)
    assert (pose.x_m, pose.y_m, pose.z_m) == pytest.approx((start.x_m, start.y_m, low), abs=1e-6)


@pytest.mark.parametrize("seed", [3, 17])
def test_a_random_walk_stays_in_walkable_space(seed):
    house = build_house(seed)
    walkable = Walkable(house)
    body = Body(walkable)
    pose = body.placed(Pose(*_free_place(seed), 0.0, 0.0))
    rng = np.random.default_rng(seed)
    for _ in range(400):
        if rng.random() < 0.3:
            pose, _ = body.turn(pose, math.radians(rng.choice([-30, 30])))
        pose, _ = body.forward(pose, 0.25)
        assert walkable.is_walkable(pose.x_m, pose.y_m, pose.z_m)
        assert pose.z_m == walkable.floor_height_m(pose.x_m, pose.y_m, pose.z_m)
