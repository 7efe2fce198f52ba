"""A simulator behind the bridge as an environment: poses in the episode frame, STOP decided here, lost workers told."""

from __future__ import annotations

import math
from typing import cast

import cv2
import numpy as np
from spacevln_bridge import messages as say
from spacevln_bridge.images import views

from spacevln.core.actions import Action, Motion, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.errors import ContractError, EnvironmentFailure
from spacevln.core.geometry import Pose, wrap_angle
from spacevln.core.interfaces import EnvironmentSpec
from spacevln.core.sensing import Observation
from spacevln.core.task import EpisodeSpec
from spacevln.environments.bridge.conversation import ANSWER_S, OPEN_S
from spacevln.environments.bridge.frame import camera_from_habitat, pose_from_habitat, pose_to_habitat
from spacevln.environments.bridge.labels import SceneLabels
from spacevln.environments.bridge.setup import BridgeSetup
from spacevln.environments.bridge.simulator import BridgedSimulator, Opened

_TOLERANCE = 1e-6
Quaternion = tuple[float, float, float, float]


class BridgedEnvironment:
    """Implements :class:`spacevln.core.Environment` in a simulator behind the bridge; who measures ways there adds ``geodesics``.

    Args:
        setup: how.
        answer_s, open_s: how long the simulator may take for a step, and for opening a scene.
    """

    def __init__(self, setup: BridgeSetup, *, answer_s: float = ANSWER_S, open_s: float = OPEN_S) -> None:
        self._setup = setup
        self._spec = setup.spec
        self._simulator = BridgedSimulator(setup, answer_s=answer_s, open_s=open_s)
        self._view: say.View | None = None
        self._start = Pose(0.0, 0.0)
        self._observation: Observation | None = None
        self._labels: SceneLabels | None = None
        self._stopped = False

    @property
    def spec(self) -> EnvironmentSpec:
        """What the body can do and see."""
        return self._spec

    @property
    def simulator(self) -> BridgedSimulator:
        """What the environment drives."""
        return self._simulator

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Load the scene and put the body at the start, without snapping.

        Raises:
            PrerequisiteError: interpreter or scene is missing.
            EnvironmentFailure: the simulator failed; the next reset starts another.
        """
        self._view, self._observation, self._stopped = None, None, False
        self._simulator.check()
        opened = self._simulator.open(episode.scene)
        self._labels = self._labels_of(opened)
        self._start = episode.start
        position, rotation = pose_to_habitat(episode.start)
        self._see(self._simulator.ask(say.Place(tuple(position), tuple(rotation)), say.View))
        return self.observe()

    def observe(self) -> Observation:
        """What the camera saw after the last motion; copied out of the shared image once."""
        view = self._seen()
        if self._observation is None:
            setup = self._setup
            rgba, depth_m, ids = views(self._simulator.image, setup.width_px, setup.height_px)
            measured = cv2.inRange(depth_m, setup.depth_min_m, setup.depth_max_m)  # not so for NaN
            T_scene_camera = camera_from_habitat(view.camera_position, cast("Quaternion", view.camera_rotation))
            self._observation = Observation(
                rgb=np.asarray(cv2.cvtColor(rgba, cv2.COLOR_RGBA2RGB)),
                depth_m=cv2.copyTo(depth_m, measured, np.zeros_like(depth_m)),
                pose=self._pose(view).relative_to(self._start),
                camera=self._spec.camera,
                T_world_camera=np.linalg.inv(self._start.T_world_body) @ T_scene_camera,
                labels=None if self._labels is None else self._labels.of(ids),
            )
        return self._observation

    def execute(self, action: Action) -> Motion:
        """Carry out one primitive; STOP never reaches the simulator, which has none.

        Raises:
            ContractError: the action is none of the spec's primitives, or the episode is over.
            EnvironmentFailure: the simulator failed.
        """
        before = self._pose(self._seen())
        if self._stopped:
            raise ContractError("BridgedEnvironment.execute() was called after STOP: reset to an episode first.")
        if isinstance(action, Stop):
            self._stopped = True
            return Motion(moved_m=0.0, turned_rad=0.0, collided=False)
        name = self._primitive(action)
        self._observation = None
        view = self._simulator.ask(say.Act(name), say.View)
        self._see(view)
        after = self._pose(view)
        return Motion(
            moved_m=math.hypot(after.x_m - before.x_m, after.y_m - before.y_m),
            turned_rad=wrap_angle(after.yaw_rad - before.yaw_rad),
            collided=view.collided,
        )

    def close(self) -> None:
        """End the simulator."""
        self._view = self._observation = None
        self._simulator.close()

    def _labels_of(self, opened: Opened) -> SceneLabels | None:
        """The scene's annotations, if the simulator has any."""
        del opened
        return None

    def _primitive(self, action: Action) -> str:
        spec = self._spec
        match action:
            case MoveForward(distance_m=distance_m) if abs(distance_m - spec.step_m) < _TOLERANCE:
                return "move_forward"
            case TurnLeft(angle_deg=angle_deg) if abs(angle_deg - spec.turn_deg) < _TOLERANCE:
                return "turn_left"
            case TurnRight(angle_deg=angle_deg) if abs(angle_deg - spec.turn_deg) < _TOLERANCE:
                return "turn_right"
        raise ContractError(
            f"{action!r} is no primitive: allowed are Stop(), MoveForward({spec.step_m}), "
            f"TurnLeft({spec.turn_deg}) and TurnRight({spec.turn_deg}); split longer decisions."
        )

    def _see(self, view: say.View) -> None:
        """Take note of a view, unless it cannot be."""
        if not np.isfinite([*view.position, *view.rotation, *view.camera_position]).all():
            raise EnvironmentFailure(f"{self._setup.title} put the body at {view.position}: the start lies outside of the scene.")
        self._view = view

    def _seen(self) -> say.View:
        if self._view is None:
            raise ContractError("BridgedEnvironment was used before reset(): reset to an episode first.")
        return self._view

    @staticmethod
    def _pose(view: say.View) -> Pose:
        return pose_from_habitat(view.position, cast("Quaternion", view.rotation))
