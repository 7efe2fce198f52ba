"""What every environment must do.

Run it on an own one in five lines::

    from spacevln.testing.environment import EnvironmentConformance

    class TestMine(EnvironmentConformance):
        def make_environment(self): return MyEnvironment()
        def make_episode(self): return EpisodeSpec("1", "my-scene", Pose(1, 2, 0, 0.3), InstructionTask("go"))

The episode should start with at least two free steps ahead; the environment may be a simulator or a recording of one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from spacevln.core.actions import MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.geometry import transform_points, wrap_angle
from spacevln.core.interfaces import Environment
from spacevln.core.sensing import Observation
from spacevln.core.task import EpisodeSpec

POSITION_M = 1e-6
ANGLE_RAD = 1e-6
_ENOUGH_POINTS = 20


class EnvironmentConformance:
    """Subclass it, give the two makers, and let pytest collect it.

    Attributes:
        position_tolerance_m, angle_tolerance_rad: how well a body does what it reports; raise them for a real robot.
        depth_tolerance_m: how well depth agrees with motion.
    """

    position_tolerance_m: float = POSITION_M
    angle_tolerance_rad: float = ANGLE_RAD
    depth_tolerance_m: float = 0.05

    def make_environment(self) -> Environment:
        """A new environment."""
        raise NotImplementedError("Give make_environment() in your subclass: it returns the environment under test.")

    def make_episode(self) -> EpisodeSpec:
        """An episode with two free steps ahead of its start."""
        raise NotImplementedError("Give make_episode() in your subclass: it returns an episode of the environment under test.")

    @pytest.fixture
    def environment(self) -> Iterator[Environment]:
        """The environment under test; closed afterwards."""
        environment = self.make_environment()
        yield environment
        environment.close()

    @pytest.fixture
    def episode(self) -> EpisodeSpec:
        """The episode that the tests play."""
        return self.make_episode()

    def test_the_spec_is_constant_and_closes_the_circle(self, environment: Environment, episode: EpisodeSpec) -> None:
        """A look-around turns by a full circle in whole primitives."""
        spec = environment.spec
        environment.reset(episode)
        assert environment.spec == spec
        assert spec.step_m > 0
        assert spec.max_forward_m >= spec.step_m
        assert spec.lookaround_count * spec.turn_deg == pytest.approx(360)

    def test_observations_have_the_promised_shapes_types_and_ranges(self, environment: Environment, episode: EpisodeSpec) -> None:
        """RGB is uint8, depth float32 metres, finite, 0 for no measurement; the camera is the spec's."""
        seen = environment.reset(episode)
        camera = environment.spec.camera
        assert seen.camera == camera
        assert seen.rgb.shape == (camera.height_px, camera.width_px, 3)
        assert seen.rgb.dtype == np.uint8
        assert seen.depth_m.shape == (camera.height_px, camera.width_px)
        assert seen.depth_m.dtype == np.float32
        assert np.isfinite(seen.depth_m).all()
        assert (seen.depth_m >= 0).all()
        assert (seen.depth_m > 0).any()

    def test_the_start_is_the_origin(self, environment: Environment, episode: EpisodeSpec) -> None:
        """Poses are in the episode frame: wherever the scene's start is, the first pose is zero; also after a second reset."""
        for _ in range(2):
            pose = environment.reset(episode).pose
            assert np.abs(pose.position_m).max() <= self.position_tolerance_m
            assert abs(pose.yaw_rad) <= self.angle_tolerance_rad
            environment.execute(TurnLeft(environment.spec.turn_deg))
            environment.execute(MoveForward(environment.spec.step_m))

    def test_reset_is_deterministic(self, environment: Environment, episode: EpisodeSpec) -> None:
        """The same episode and the same actions give the same pictures and poses."""
        first = self._play(environment, episode)
        second = self._play(environment, episode)
        for a, b in zip(first, second, strict=True):
            assert a.pose == b.pose
            np.testing.assert_array_equal(a.rgb, b.rgb)
            np.testing.assert_array_equal(a.depth_m, b.depth_m)

    def test_observing_changes_nothing(self, environment: Environment, episode: EpisodeSpec) -> None:
        """Looking twice gives the same, and looking in between does not change where the body goes."""
        environment.reset(episode)
        first, second = environment.observe(), environment.observe()
        assert first.pose == second.pose
        np.testing.assert_array_equal(first.rgb, second.rgb)
        np.testing.assert_array_equal(first.depth_m, second.depth_m)
        environment.execute(MoveForward(environment.spec.step_m))
        looked = environment.observe().pose
        environment.reset(episode)
        environment.execute(MoveForward(environment.spec.step_m))
        assert environment.observe().pose == looked

    def test_old_observations_stay_as_they_were(self, environment: Environment, episode: EpisodeSpec) -> None:
        """An observation is a value: the next picture is not drawn into it."""
        seen = environment.reset(episode)
        rgb, depth_m = seen.rgb.copy(), seen.depth_m.copy()
        environment.execute(TurnLeft(environment.spec.turn_deg))
        environment.observe()
        np.testing.assert_array_equal(seen.rgb, rgb)
        np.testing.assert_array_equal(seen.depth_m, depth_m)

    def test_turning_left_goes_counter_clockwise_on_the_spot(self, environment: Environment, episode: EpisodeSpec) -> None:
        """A left turn is positive, a right turn takes it back, neither moves the feet."""
        environment.reset(episode)
        angle = environment.spec.turn_deg
        motion = environment.execute(TurnLeft(angle))
        pose = environment.observe().pose
        assert motion.turned_rad == pytest.approx(math.radians(angle), abs=self.angle_tolerance_rad)
        assert pose.yaw_rad == pytest.approx(math.radians(angle), abs=self.angle_tolerance_rad)
        assert math.hypot(pose.x_m, pose.y_m) <= self.position_tolerance_m
        motion = environment.execute(TurnRight(angle))
        assert motion.turned_rad == pytest.approx(-math.radians(angle), abs=self.angle_tolerance_rad)
        assert abs(environment.observe().pose.yaw_rad) <= self.angle_tolerance_rad

    def test_a_full_look_around_restores_heading_and_picture(self, environment: Environment, episode: EpisodeSpec) -> None:
        """Twelve turns of 30 degrees (or eight of 45) come back to the start."""
        start = environment.reset(episode)
        count = environment.spec.lookaround_count
        headings = []
        for _ in range(count):
            environment.execute(TurnLeft(environment.spec.turn_deg))
            headings.append(environment.observe().pose.yaw_rad)
        end = environment.observe()
        assert abs(wrap_angle(end.pose.yaw_rad - start.pose.yaw_rad)) <= count * self.angle_tolerance_rad
        assert len({round(heading, 3) for heading in headings}) == count
        assert np.abs(end.pose.position_m).max() <= self.position_tolerance_m
        seen = (start.depth_m > 0) & (end.depth_m > 0)
        assert np.median(np.abs(start.depth_m - end.depth_m)[seen]) <= self.depth_tolerance_m

    def test_forward_moves_along_the_heading_by_what_is_reported(self, environment: Environment, episode: EpisodeSpec) -> None:
        """With free floor ahead a step is a step: along x at the start, along the new heading after a turn."""
        environment.reset(episode)
        step = environment.spec.step_m
        motion = environment.execute(MoveForward(step))
        pose = environment.observe().pose
        assert not motion.collided, "the episode's start must have free floor ahead"
        assert motion.moved_m == pytest.approx(step, abs=self.position_tolerance_m)
        assert (pose.x_m, pose.y_m) == pytest.approx((step, 0.0), abs=self.position_tolerance_m)

    def test_motion_is_bounded_and_agrees_with_the_poses(self, environment: Environment, episode: EpisodeSpec) -> None:
        """Walking on until something is hit: never farther than asked, and short or aside only when collided."""
        pose = environment.reset(episode).pose
        step = environment.spec.step_m
        for _ in range(40):
            motion = environment.execute(MoveForward(step))
            then = environment.observe().pose
            moved = math.hypot(then.x_m - pose.x_m, then.y_m - pose.y_m)
            assert moved == pytest.approx(motion.moved_m, abs=self.position_tolerance_m)
            assert moved <= step + self.position_tolerance_m
            if not motion.collided:
                assert moved == pytest.approx(step, abs=self.position_tolerance_m)
            pose = then
            if motion.collided:
                return

    def test_depth_agrees_with_motion(self, environment: Environment, episode: EpisodeSpec) -> None:
        """What is seen ahead comes nearer by the step, and what was measured keeps its place under steps and turns."""
        before = environment.reset(episode)
        motion = environment.execute(MoveForward(environment.spec.step_m))
        after = environment.observe()
        assert self._disagreement(before, after) <= self.depth_tolerance_m
        environment.execute(TurnLeft(environment.spec.turn_deg))
        assert self._disagreement(after, environment.observe()) <= self.depth_tolerance_m
        row, column = environment.spec.camera.height_px // 2, environment.spec.camera.width_px // 2
        first, second = float(before.depth_m[row, column]), float(after.depth_m[row, column])
        if first > 0 and second > 0:
            assert first - second == pytest.approx(motion.moved_m, abs=self.depth_tolerance_m)

    def test_stop_does_not_move(self, environment: Environment, episode: EpisodeSpec) -> None:
        """STOP reports no motion, and reset works after it."""
        environment.reset(episode)
        motion = environment.execute(Stop())
        assert (motion.moved_m, motion.turned_rad, motion.collided) == (0.0, 0.0, False)
        assert environment.reset(episode).pose.x_m == pytest.approx(0.0, abs=self.position_tolerance_m)

    def test_labels_name_exactly_what_the_image_shows(self, environment: Environment, episode: EpisodeSpec) -> None:
        """Where there are labels: int32, one name for every id of this very image and for no other, 0 unnamed, names stable."""
        names: dict[int, tuple[str, tuple[str, ...]]] = {}
        for seen in self._play(environment, episode):
            if seen.labels is None:
                continue
            ids = seen.labels.instance_ids
            assert ids.shape == seen.depth_m.shape
            assert ids.dtype == np.int32
            assert set(np.unique(ids).tolist()) - {0} == set(seen.labels.instances)
            for instance, label in seen.labels.instances.items():
                assert label.category
                assert names.setdefault(instance, (label.category, label.attributes)) == (label.category, label.attributes)

    def test_closing_twice_is_fine(self, episode: EpisodeSpec) -> None:
        """Also when nothing was ever reset."""
        unused = self.make_environment()
        unused.close()
        unused.close()
        used = self.make_environment()
        used.reset(episode)
        used.close()
        used.close()

    @staticmethod
    def _play(environment: Environment, episode: EpisodeSpec) -> list[Observation]:
        """A short walk: ahead, a look to the left, ahead."""
        seen = [environment.reset(episode)]
        spec = environment.spec
        for action in (MoveForward(spec.step_m), TurnLeft(spec.turn_deg), MoveForward(spec.step_m), TurnRight(spec.turn_deg)):
            environment.execute(action)
            seen.append(environment.observe())
        return seen

    @classmethod
    def _disagreement(cls, before: Observation, after: Observation) -> float:
        """Median difference [m] between the depth of an image and that of another one's points seen from there."""
        camera = before.camera
        points = transform_points(np.linalg.inv(before.T_world_camera).astype(np.float64), cls._points(after))
        points = points[points[:, 0] > 0.3]
        columns = np.floor(camera.cx_px - camera.fx_px * points[:, 1] / points[:, 0]).astype(int)
        rows = np.floor(camera.cy_px - camera.fy_px * points[:, 2] / points[:, 0]).astype(int)
        inside = (rows >= 0) & (rows < camera.height_px) & (columns >= 0) & (columns < camera.width_px)
        measured = before.depth_m[rows[inside], columns[inside]]
        both = measured > 0
        if both.sum() < _ENOUGH_POINTS:
            return 0.0
        return float(np.median(np.abs(measured - points[inside, 0])[both]))

    @staticmethod
    def _points(seen: Observation) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        """Some of the measured points in the episode frame, at most 3 m away, (N, 3)."""
        camera = seen.camera
        rows, columns = np.mgrid[4 : camera.height_px : 8, 4 : camera.width_px : 8]
        depth = seen.depth_m[rows, columns].astype(np.float64)
        left = -(columns + 0.5 - camera.cx_px) / camera.fx_px * depth
        up = -(rows + 0.5 - camera.cy_px) / camera.fy_px * depth
        measured = (depth > 0) & (depth < 3.0)
        return transform_points(seen.T_world_camera, np.stack([depth, left, up], axis=-1)[measured])
