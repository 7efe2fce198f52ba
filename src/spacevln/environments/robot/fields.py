"""Between our message values and the objects of any ROS 2 implementation, whose attribute names are all the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from spacevln.environments.robot.messages import (
    NANO,
    CameraInfo,
    CompressedImage,
    Header,
    Image,
    Message,
    Odometry,
    Quaternion,
    TFMessage,
    TransformStamped,
    Twist,
    TwistStamped,
    Vector3,
)


class Maker(Protocol):
    """Makes an object of an implementation from its ROS 2 type name and fields."""

    def __call__(self, ros_name: str, /, **fields: Any) -> Any:
        """The object."""


def to_ros(message: Message, make: Maker) -> Any:
    """A message as an object of the implementation that ``make`` makes."""
    match message:
        case Image() | CompressedImage():
            return _picture(message, make)
        case CameraInfo():
            return _info(message, make)
        case Odometry():
            return _odometry(message, make)
        case TFMessage(transforms=transforms):
            return make("tf2_msgs/msg/TFMessage", transforms=[_transform(item, make) for item in transforms])
        case Twist():
            return _twist(message, make)
        case TwistStamped(header=header, twist=twist):
            return make("geometry_msgs/msg/TwistStamped", header=_header(header, make), twist=_twist(twist, make))


def _header(header: Header, make: Maker) -> Any:
    sec, nanosec = divmod(header.stamp_ns, NANO)
    stamp = make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
    return make("std_msgs/msg/Header", stamp=stamp, frame_id=header.frame_id)


def _vector(vector: Vector3, make: Maker, name: str = "Vector3") -> Any:
    return make(f"geometry_msgs/msg/{name}", x=vector.x, y=vector.y, z=vector.z)


def _quaternion(q: Quaternion, make: Maker) -> Any:
    return make("geometry_msgs/msg/Quaternion", x=q.x, y=q.y, z=q.z, w=q.w)


def _twist(twist: Twist, make: Maker) -> Any:
    return make("geometry_msgs/msg/Twist", linear=_vector(twist.linear, make), angular=_vector(twist.angular, make))


def _picture(image: Image | CompressedImage, make: Maker) -> Any:
    data = np.frombuffer(image.data, np.uint8)
    header = _header(image.header, make)
    if isinstance(image, CompressedImage):
        return make("sensor_msgs/msg/CompressedImage", header=header, format=image.format, data=data)
    return make(
        "sensor_msgs/msg/Image",
        header=header,
        height=image.height,
        width=image.width,
        encoding=image.encoding,
        is_bigendian=image.is_bigendian,
        step=image.step,
        data=data,
    )


def _info(info: CameraInfo, make: Maker) -> Any:
    roi = make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    return make(
        "sensor_msgs/msg/CameraInfo",
        header=_header(info.header, make),
        height=info.height,
        width=info.width,
        distortion_model=info.distortion_model,
        d=np.array(info.d, np.float64),
        k=np.array(info.k, np.float64),
        r=np.array(info.r, np.float64),
        p=np.array(info.p, np.float64),
        binning_x=0,
        binning_y=0,
        roi=roi,
    )


def _odometry(odometry: Odometry, make: Maker) -> Any:
    position, orientation = _vector(odometry.position, make, "Point"), _quaternion(odometry.orientation, make)
    pose = make("geometry_msgs/msg/Pose", position=position, orientation=orientation)
    return make(
        "nav_msgs/msg/Odometry",
        header=_header(odometry.header, make),
        child_frame_id=odometry.child_frame_id,
        pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
        twist=make("geometry_msgs/msg/TwistWithCovariance", twist=_twist(odometry.twist, make), covariance=np.zeros(36)),
    )


def _transform(item: TransformStamped, make: Maker) -> Any:
    translation, rotation = _vector(item.translation, make), _quaternion(item.rotation, make)
    return make(
        "geometry_msgs/msg/TransformStamped",
        header=_header(item.header, make),
        child_frame_id=item.child_frame_id,
        transform=make("geometry_msgs/msg/Transform", translation=translation, rotation=rotation),
    )


def from_ros(found: Any, kind: type[Any]) -> Message:
    """The message that an implementation's object holds."""
    return _FROM[kind](found)


def _header_of(found: Any) -> Header:
    return Header(found.stamp.sec * NANO + found.stamp.nanosec, str(found.frame_id))


def _vector_of(found: Any) -> Vector3:
    return Vector3(float(found.x), float(found.y), float(found.z))


def _quaternion_of(found: Any) -> Quaternion:
    return Quaternion(float(found.x), float(found.y), float(found.z), float(found.w))


def _twist_of(found: Any) -> Twist:
    return Twist(_vector_of(found.linear), _vector_of(found.angular))


def _image_of(found: Any) -> Image:
    return Image(
        _header_of(found.header),
        int(found.height),
        int(found.width),
        str(found.encoding),
        int(found.step),
        bytes(found.data),
        int(found.is_bigendian),
    )


def _info_of(found: Any) -> CameraInfo:
    def numbers(values: Any) -> tuple[float, ...]:
        return tuple(float(value) for value in values)

    model, d, k = str(found.distortion_model), numbers(found.d), numbers(found.k)
    return CameraInfo(
        _header_of(found.header), int(found.height), int(found.width), model, d, k, numbers(found.r), numbers(found.p)
    )


def _odometry_of(found: Any) -> Odometry:
    pose = found.pose.pose
    return Odometry(
        _header_of(found.header),
        str(found.child_frame_id),
        _vector_of(pose.position),
        _quaternion_of(pose.orientation),
        _twist_of(found.twist.twist),
    )


def _transform_of(found: Any) -> TransformStamped:
    return TransformStamped(
        _header_of(found.header),
        str(found.child_frame_id),
        _vector_of(found.transform.translation),
        _quaternion_of(found.transform.rotation),
    )


_FROM: dict[type[Any], Callable[[Any], Message]] = {
    Image: _image_of,
    CompressedImage: lambda found: CompressedImage(_header_of(found.header), str(found.format), bytes(found.data)),
    CameraInfo: _info_of,
    Odometry: _odometry_of,
    TFMessage: lambda found: TFMessage(tuple(map(_transform_of, found.transforms))),
    Twist: _twist_of,
    TwistStamped: lambda found: TwistStamped(_header_of(found.header), _twist_of(found.twist)),
}
