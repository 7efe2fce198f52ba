"""One message of every type that goes over a wire."""

from __future__ import annotations

from spacevln.environments.robot.messages import (
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

HEADER = Header(1_700_000_000_123_456_789, "camera_color_optical_frame")
TWIST = Twist(Vector3(0.25, 0.0, 0.0), Vector3(0.0, 0.0, -0.5))
TURN = Quaternion.of_yaw(0.7)
NUMBERS = tuple(float(k) / 7 for k in range(12))
MESSAGES: tuple[Message, ...] = (
    Image(HEADER, 2, 3, "rgb8", 9, bytes(range(18))),
    CompressedImage(HEADER, "jpeg", b"\xff\xd8\x01"),
    CameraInfo(HEADER, 480, 640, "plumb_bob", NUMBERS[:5], NUMBERS[:9], NUMBERS[:9], NUMBERS),
    Odometry(HEADER, "base_link", Vector3(1.0, -2.0, 0.5), TURN, TWIST),
    TFMessage((TransformStamped(HEADER, "base", Vector3(1.0, 2.0, 3.0), TURN), TransformStamped(HEADER, "c", Vector3(), TURN))),
    TFMessage(()),
    TWIST,
    TwistStamped(HEADER, TWIST),
)
