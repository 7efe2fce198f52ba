"""What a frame must be before it is mapped: a mistake in units or frames is refused, not mapped."""

from __future__ import annotations

import numpy as np

from spacevln.core import Observation, UsageError

_UNIT_M = 100.0  # depths mostly beyond this were not given in metres
_SAMPLE_PX = 16
_ROLL = 0.7  # the camera's y axis leaves the horizontal plane by less than 45 degrees


def check_frame(observation: Observation) -> None:
    """Refuse what cannot be metres and radians in a frame with z up.

    Shapes and types were checked when the observation was made.

    Raises:
        UsageError: the pose or the camera's transform is not finite, the transform is no rotation with a shift or the camera's
            axes are those of an optical frame, or most depths lie beyond 100 m.
    """
    pose, T_world_camera = observation.pose, observation.T_world_camera
    if not (np.isfinite([pose.x_m, pose.y_m, pose.z_m, pose.yaw_rad]).all() and np.isfinite(T_world_camera).all()):
        raise UsageError(f"Observation.pose {pose} or T_world_camera is not finite: give a pose in metres and radians.")
    rotation = T_world_camera[:3, :3]
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-3 or np.linalg.det(rotation) < 0:
        raise UsageError(
            f"Observation.T_world_camera has {rotation.round(3).tolist()} where a rotation is needed: "
            "give a homogeneous transform without scale or mirroring."
        )
    if abs(rotation[2, 1]) > _ROLL:
        raise UsageError(
            f"The y axis of Observation.T_world_camera rises by {rotation[2, 1]:.2f} per metre, allowed is {_ROLL}: the camera "
            "frame is x forward, y left, z up, so convert optical frames (x right, y down, z forward)."
        )
    depth_m = observation.depth_m[::_SAMPLE_PX, ::_SAMPLE_PX]
    measured = depth_m[np.isfinite(depth_m) & (depth_m > 0)]
    if len(measured) and float(np.median(measured)) > _UNIT_M:
        raise UsageError(
            f"Observation.depth_m has a median of {float(np.median(measured)):.0f}, allowed are metres up to {_UNIT_M:.0f}: "
            "divide millimetres by 1000."
        )
