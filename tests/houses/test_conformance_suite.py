"""The conformance suite catches what it should: each broken environment fails at least the test that is about its fault."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import two_rooms

from spacevln.core import (
    Camera,
    EpisodeSpec,
    InstanceLabel,
    InstructionTask,
    Labels,
    Motion,
    MoveForward,
    Observation,
    Pose,
    TurnLeft,
    TurnRight,
)
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.testing.environment import EnvironmentConformance

START = Pose(0.8, 2.0, 0.0, 0.3)


class Sound(HousesEnvironment):
    def __init__(self) -> None:
        super().__init__(Camera(80, 60, 79.0, 0.88), renderer="raycast", load=two_rooms.place)


class TurnsTheWrongWay(Sound):
    def execute(self, action):
        swapped = {TurnLeft: TurnRight, TurnRight: TurnLeft}.get(type(action))
        return super().execute(swapped(action.angle_deg) if swapped else action)


class TellsThePoseInTheSceneFrame(Sound):
    def observe(self) -> Observation:
        seen = super().observe()
        return dataclasses.replace(seen, pose=START.compose(seen.pose), T_world_camera=None)


class GivesMillimetres(Sound):
    def observe(self) -> Observation:
        seen = super().observe()
        return dataclasses.replace(seen, depth_m=seen.depth_m * 1000)


class GivesRayLengths(Sound):
    def observe(self) -> Observation:
        seen = super().observe()
        rows, columns = np.mgrid[0:60, 0:80]
        slopes = np.hypot((columns + 0.5 - 40) / seen.camera.fx_px, (rows + 0.5 - 30) / seen.camera.fy_px)
        return dataclasses.replace(seen, depth_m=(seen.depth_m * np.hypot(1, slopes)).astype(np.float32))


class DrawsIntoOldPictures(Sound):
    buffer = np.zeros((60, 80, 3), np.uint8)

    def observe(self) -> Observation:
        seen = super().observe()
        self.buffer[:] = seen.rgb
        return dataclasses.replace(seen, rgb=self.buffer)


class MovesWhenLookedAt(Sound):
    def observe(self) -> Observation:
        if self._episode is not None:
            self._at = Pose(self._at.x_m + 0.01, self._at.y_m, self._at.z_m, self._at.yaw_rad)
            self._observation = None
        return super().observe()


class ExaggeratesItsMotion(Sound):
    def execute(self, action):
        motion = super().execute(action)
        return Motion(2 * motion.moved_m, motion.turned_rad, motion.collided)


class NeverCollides(Sound):
    def execute(self, action):
        motion = super().execute(action)
        return Motion(motion.moved_m, motion.turned_rad, collided=False)


class IsNoisy(Sound):
    noise = np.random.default_rng(0)

    def observe(self) -> Observation:
        seen = super().observe()
        return dataclasses.replace(seen, rgb=self.noise.integers(0, 255, seen.rgb.shape).astype(np.uint8))


class NamesWhatItDoesNotShow(Sound):
    def observe(self) -> Observation:
        seen = super().observe()
        names = {**seen.labels.instances, 99: InstanceLabel("ghost")}
        return dataclasses.replace(seen, labels=Labels(seen.labels.instance_ids, names))


class StepsTooFar(Sound):
    def execute(self, action):
        motion = super().execute(action)
        if isinstance(action, MoveForward) and not motion.collided:
            self._at = self._at.compose(Pose(0.05, 0.0))
            self._observation = None
        return motion


def failures(kind: type[Sound]) -> set[str]:
    """Names of the suite's tests that an environment fails."""
    suite = EnvironmentConformance()
    suite.make_environment = kind  # type: ignore[method-assign]
    episode = EpisodeSpec("1", "house-000000", START, InstructionTask("go"))
    failed = set()
    for name in (name for name in dir(suite) if name.startswith("test_")):
        environment = kind()
        arguments = (episode,) if name == "test_closing_twice_is_fine" else (environment, episode)
        try:
            getattr(suite, name)(*arguments)
        except AssertionError:
            failed.add(name)
        environment.close()
    return failed


def test_a_sound_environment_passes():
    assert failures(Sound) == set()


@pytest.mark.parametrize(
    ("kind", "caught_by"),
    [
        (TurnsTheWrongWay, "test_turning_left_goes_counter_clockwise_on_the_spot"),
        (TellsThePoseInTheSceneFrame, "test_the_start_is_the_origin"),
        (GivesMillimetres, "test_depth_agrees_with_motion"),
        (GivesRayLengths, "test_depth_agrees_with_motion"),
        (DrawsIntoOldPictures, "test_old_observations_stay_as_they_were"),
        (MovesWhenLookedAt, "test_observing_changes_nothing"),
        (ExaggeratesItsMotion, "test_forward_moves_along_the_heading_by_what_is_reported"),
        (NeverCollides, "test_motion_is_bounded_and_agrees_with_the_poses"),
        (IsNoisy, "test_reset_is_deterministic"),
        (NamesWhatItDoesNotShow, "test_labels_name_exactly_what_the_image_shows"),
        (StepsTooFar, "test_forward_moves_along_the_heading_by_what_is_reported"),
    ],
)
def test_a_fault_is_caught(kind, caught_by):
    assert caught_by in failures(kind)
