"""The standard ROS 2 messages that a robot's data contract uses, as plain values.

Every field is named as in its ROS definition (sensor_msgs, nav_msgs, geometry_msgs, tf2_msgs, std_srvs); covariances, which
nothing here reads, are written as zeros. Stamps are whole nanoseconds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from spacevln.core.geometry import Pose

NANO = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Header:
    """std_msgs/Header."""

    stamp_ns: int
    frame_id: str = ""

    @property
    def stamp_s(self) -> float:
        """Time of the measurement [s]."""
        return self.stamp_ns / NANO


@dataclass(frozen=True, slots=True)
class Vector3:
    """geometry_msgs/Vector3 and Point."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(frozen=True, slots=True)
class Quaternion:
    """geometry_msgs/Quaternion."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0

    @classmethod
    def of_yaw(cls, yaw_rad: float) -> Quaternion:
        """A turn about the vertical axis."""
        return cls(0.0, 0.0, math.sin(yaw_rad / 2), math.cos(yaw_rad / 2))

    @property
    def yaw_rad(self) -> float:
        """Heading of the x axis [rad]."""
        return math.atan2(2 * (self.w * self.z + self.x * self.y), 1 - 2 * (self.y**2 + self.z**2))


@dataclass(frozen=True, slots=True, eq=False)
class Image:
    """sensor_msgs/Image; ``data`` has ``step`` bytes per row."""

    header: Header
    height: int
    width: int
    encoding: str
    step: int
    data: bytes
    is_bigendian: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class CompressedImage:
    """sensor_msgs/CompressedImage."""

    header: Header
    format: str
    data: bytes


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """sensor_msgs/CameraInfo: ``k`` (9) row-major intrinsics, ``d`` distortion, ``r`` (9), ``p`` (12)."""

    header: Header
    height: int
    width: int
    distortion_model: str
    d: tuple[float, ...]
    k: tuple[float, ...]
    r: tuple[float, ...]
    p: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Twist:
    """geometry_msgs/Twist."""

    linear: Vector3 = Vector3()
    angular: Vector3 = Vector3()


@dataclass(frozen=True, slots=True)
class TwistStamped:
    """geometry_msgs/TwistStamped."""

    header: Header
    twist: Twist


@dataclass(frozen=True, slots=True)
class Odometry:
    """nav_msgs/Odometry without covariances."""

    header: Header
    child_frame_id: str
    position: Vector3
    orientation: Quaternion
    twist: Twist = Twist()

    @property
    def pose(self) -> Pose:
        """The pose on the floor."""
        return Pose(self.position.x, self.position.y, self.position.z, self.orientation.yaw_rad)


@dataclass(frozen=True, slots=True)
class TransformStamped:
    """geometry_msgs/TransformStamped: maps coordinates of ``child_frame_id`` to ``header.frame_id``."""

    header: Header
    child_frame_id: str
    translation: Vector3
    rotation: Quaternion


@dataclass(frozen=True, slots=True)
class TFMessage:
    """tf2_msgs/TFMessage."""

    transforms: tuple[TransformStamped, ...]


@dataclass(frozen=True, slots=True)
class TriggerReply:
    """std_srvs/Trigger response."""

    success: bool
    message: str


Message = Image | CompressedImage | CameraInfo | Odometry | TFMessage | Twist | TwistStamped

TYPE_NAMES: Mapping[type[Any], str] = MappingProxyType(
    {
        Image: "sensor_msgs/msg/Image",
        CompressedImage: "sensor_msgs/msg/CompressedImage",
        CameraInfo: "sensor_msgs/msg/CameraInfo",
        Odometry: "nav_msgs/msg/Odometry",
        TFMessage: "tf2_msgs/msg/TFMessage",
        Twist: "geometry_msgs/msg/Twist",
        TwistStamped: "geometry_msgs/msg/TwistStamped",
    }
)
"""The ROS 2 name of every message type."""
