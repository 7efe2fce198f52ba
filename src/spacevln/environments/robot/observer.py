"""From a synchronised set of messages to an :class:`~spacevln.core.sensing.Observation`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from spacevln.core.geometry import Float, Pose
from spacevln.core.sensing import Camera, InstanceLabel, Labels, Observation
from spacevln.environments.robot.calibration import Rectifier
from spacevln.environments.robot.images import depth_of, label_ids_of, rgb_of
from spacevln.environments.robot.messages import CameraInfo, Image
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Snapshot


class Observer:
    """Decodes, rectifies, poses.

    Args:
        profile: widths and scales.
        info: of the colour camera.
        T_base_camera: (4, 4), our camera frame in the body.

    Raises:
        EnvironmentFailure: the calibration is unusable.
    """

    def __init__(self, profile: RobotProfile, info: CameraInfo, T_base_camera: Float) -> None:
        self._scale_m, self._T_base_camera = profile.images.depth_scale_m, T_base_camera
        self._rectifier = Rectifier(info, profile.images.width_px, float(T_base_camera[2, 3]))

    @property
    def camera(self) -> Camera:
        """Of every observation."""
        return self._rectifier.camera

    def observation(self, snapshot: Snapshot, origin: Pose, names: Mapping[int, InstanceLabel] | None = None) -> Observation:
        """The observation in the frame of ``origin``.

        Args:
            snapshot: in the fixed frame.
            origin: where the wanted frame lies in it, on the floor.
            names: what a simulator's instance ids are called.

        Raises:
            EnvironmentFailure: an image is broken, or not of the calibrated size.
        """
        pose = flat(snapshot.pose).relative_to(origin)
        return Observation(
            rgb=self._rectifier.rgb(rgb_of(snapshot.rgb)),
            depth_m=self._rectifier.depth(depth_of(snapshot.depth, self._scale_m)),
            pose=pose,
            camera=self.camera,
            T_world_camera=pose.T_world_body @ self._T_base_camera,
            labels=None if snapshot.labels is None or not names else self._labels(snapshot.labels, names),
        )

    def _labels(self, image: Image, names: Mapping[int, InstanceLabel]) -> Labels:
        ids = self._rectifier.ids(label_ids_of(image))
        shown = sorted({int(number) for number in np.unique(ids)} & set(names))
        return Labels(np.where(np.isin(ids, shown), ids, 0).astype(np.int32), {number: names[number] for number in shown})


def flat(pose: Pose) -> Pose:
    """On the floor: what odometry says about height is drift on one storey."""
    return Pose(pose.x_m, pose.y_m, 0.0, pose.yaw_rad)


def placed(observation: Observation, origin: Pose) -> Observation:
    """An observation in the frame in which ``origin`` is told."""
    return replace(
        observation, pose=origin.compose(observation.pose), T_world_camera=origin.T_world_body @ observation.T_world_camera
    )
