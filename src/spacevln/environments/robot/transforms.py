"""Frames of a robot: a small TF tree, poses over time, and the camera's place on the body."""

from __future__ import annotations

import bisect
import math
from collections import deque

import numpy as np
from scipy.spatial.transform import Rotation

from spacevln.core.errors import EnvironmentFailure
from spacevln.core.geometry import Float, Pose, wrap_angle
from spacevln.environments.robot.messages import NANO, TFMessage, TransformStamped
from spacevln.environments.robot.profile import Mount

T_OPTICAL_CAMERA: Float = np.array([[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]], np.float64)
"""Our camera frame (x forward, y left, z up) in ROS' optical frame (z forward, x right, y down)."""

_KEPT = 500


def matrix_of(item: TransformStamped) -> Float:
    """The (4, 4) matrix of a transform."""
    q, t = item.rotation, item.translation
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat([q.x, q.y, q.z, q.w]).as_matrix()
    T[:3, 3] = (t.x, t.y, t.z)
    return T


def matrix_of_mount(mount: Mount) -> Float:
    """T_base_camera of a mount in the profile."""
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("ZYX", [mount.yaw_deg, mount.pitch_deg, mount.roll_deg], degrees=True).as_matrix()
    T[:3, 3] = (mount.x_m, mount.y_m, mount.z_m)
    return T


def pose_of_matrix(T: Float) -> Pose:
    """The planar pose of a transform."""
    return Pose(float(T[0, 3]), float(T[1, 3]), float(T[2, 3]), math.atan2(T[1, 0], T[0, 0]))


class TfTree:
    """The latest transform of every child frame."""

    def __init__(self) -> None:
        self._parents: dict[str, tuple[str, Float]] = {}

    def add(self, message: TFMessage) -> None:
        """Take the transforms of a message."""
        for item in message.transforms:
            self._parents[item.child_frame_id.strip("/")] = (item.header.frame_id.strip("/"), matrix_of(item))

    def lookup(self, target: str, source: str) -> Float | None:
        """T_target_source (4, 4): coordinates of ``source`` in ``target``; None while they are not connected."""
        up_source, up_target = self._chain(source.strip("/")), self._chain(target.strip("/"))
        for frame, T_frame_source in up_source.items():
            if frame in up_target:
                return np.linalg.inv(up_target[frame]) @ T_frame_source
        return None

    def links(self, target: str, source: str) -> frozenset[str]:
        """The child frames whose transforms make up ``lookup(target, source)``."""
        up_source, up_target = self._chain(source.strip("/")), self._chain(target.strip("/"))
        return frozenset(set(up_source) ^ set(up_target)) | {source.strip("/")}

    def _chain(self, frame: str) -> dict[str, Float]:
        """Every ancestor of a frame with the frame's coordinates in it, nearest first."""
        chain, T = {frame: np.eye(4)}, np.eye(4)
        while frame in self._parents and len(chain) <= len(self._parents):
            frame, T_parent_child = self._parents[frame]
            T = T_parent_child @ T
            chain[frame] = T
        return chain


class PoseHistory:
    """Poses by their stamps.

    Args:
        gap_s: over which is interpolated at most.
    """

    def __init__(self, gap_s: float) -> None:
        self._gap_ns = round(gap_s * NANO)
        self._poses: deque[tuple[int, Pose]] = deque(maxlen=_KEPT)

    def __len__(self) -> int:
        return len(self._poses)

    def add(self, stamp_ns: int, pose: Pose) -> None:
        """Take a pose; one that is older than the last begins the history anew, as its clock has jumped."""
        if self._poses and stamp_ns <= self._poses[-1][0]:
            if stamp_ns == self._poses[-1][0]:
                return
            self._poses.clear()
        self._poses.append((stamp_ns, pose))

    @property
    def latest(self) -> tuple[int, Pose] | None:
        """The newest stamp and pose."""
        return self._poses[-1] if self._poses else None

    def at(self, stamp_ns: int) -> Pose | None:
        """The pose at a time, interpolated; None while it is not known."""
        poses = list(self._poses)
        index = bisect.bisect_left(poses, stamp_ns, key=lambda item: item[0])
        if index < len(poses) and poses[index][0] == stamp_ns:
            return poses[index][1]
        if index == 0 or index == len(poses):
            return None
        (t0, a), (t1, b) = poses[index - 1], poses[index]
        if t1 - t0 > self._gap_ns:
            return None
        share = (stamp_ns - t0) / (t1 - t0)
        yaw = wrap_angle(a.yaw_rad + share * wrap_angle(b.yaw_rad - a.yaw_rad))
        x, y, z = a.position_m + share * (b.position_m - a.position_m)
        return Pose(float(x), float(y), float(z), yaw)


def place_of_camera(tree: TfTree, base: str, optical: str, mount: Mount | None) -> Float | None:
    """T_base_camera from the profile's mount, else from TF; None while TF does not know.

    Raises:
        EnvironmentFailure: the camera of TF looks at the floor or the ceiling.
    """
    if mount is not None:
        return matrix_of_mount(mount)
    T = tree.lookup(base, optical)
    if T is None:
        return None
    T_base_camera = T @ T_OPTICAL_CAMERA
    if abs(T_base_camera[2, 0]) > 0.9:
        raise EnvironmentFailure(
            f"TF says that {optical!r} looks straight up or down from {base!r}: name the optical frame, or give [mount]."
        )
    return np.asarray(T_base_camera, np.float64)
