"""Images, calibration, frames, profiles: what needs no transport."""

from __future__ import annotations

import math
import struct

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.core import Camera, EnvironmentFailure, Pose, UnknownNameError, UsageError
from spacevln.environments.robot.calibration import Rectifier, info_of
from spacevln.environments.robot.guard.geofence import inside
from spacevln.environments.robot.images import depth_message, depth_of, label_ids_of, label_message, rgb_message, rgb_of
from spacevln.environments.robot.messages import (
    CameraInfo,
    CompressedImage,
    Header,
    Image,
    Quaternion,
    TFMessage,
    TransformStamped,
    Vector3,
)
from spacevln.environments.robot.profile import Mount, load_profile, profile_names
from spacevln.environments.robot.transforms import PoseHistory, TfTree, place_of_camera
from spacevln.environments.robot.transport import open_transport

HEADER = Header(1_700_000_000_123_456_789, "camera")
RGB = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)


def padded(rgb: np.ndarray, encoding: str) -> Image:
    """With eight unused bytes at the end of every row."""
    rows = np.zeros((rgb.shape[0], rgb[0].size + 8), np.uint8)
    rows[:, :-8] = rgb.reshape(rgb.shape[0], -1)
    return Image(HEADER, rgb.shape[0], rgb.shape[1], encoding, rows.shape[1], rows.tobytes())


def test_colour_is_rgb_whatever_the_encoding() -> None:
    alpha = np.full((4, 6, 1), 255, np.uint8)
    assert np.array_equal(rgb_of(rgb_message(RGB, HEADER)), RGB)
    assert np.array_equal(rgb_of(padded(RGB, "rgb8")), RGB)
    assert np.array_equal(rgb_of(padded(RGB[..., ::-1], "bgr8")), RGB)
    assert np.array_equal(rgb_of(padded(np.dstack([RGB[..., ::-1], alpha]), "bgra8")), RGB)
    png = cv2.imencode(".png", RGB[..., ::-1])[1].tobytes()
    assert np.array_equal(rgb_of(CompressedImage(HEADER, "rgb8; png compressed bgr8", png)), RGB)
    with pytest.raises(EnvironmentFailure, match=r"'yuv422'.*rgb8"):
        rgb_of(Image(HEADER, 4, 6, "yuv422", 12, bytes(48)))
    with pytest.raises(EnvironmentFailure, match="48 bytes"):
        rgb_of(Image(HEADER, 4, 6, "rgb8", 18, bytes(48)))


def test_depth_is_metres_and_zero_where_nothing_was_measured() -> None:
    depth = np.array([[0.0, 1.5], [2.25, 4.999]], np.float32)
    assert depth_of(depth_message(depth, HEADER)) == pytest.approx(depth, abs=5e-4)
    assert np.array_equal(depth_of(depth_message(depth, HEADER, "32FC1")), depth)
    bad = np.array([[np.nan, np.inf, -1.0, 3.0]], "<f4")
    assert depth_of(Image(HEADER, 1, 4, "32FC1", 16, bad.tobytes())).tolist() == [[0.0, 0.0, 0.0, 3.0]]
    big = Image(HEADER, 1, 2, "16UC1", 4, np.array([[1000, 2000]], ">u2").tobytes(), is_bigendian=1)
    assert depth_of(big).tolist() == [[1.0, 2.0]]


def test_compressed_depth_of_image_transport() -> None:
    png = cv2.imencode(".png", np.array([[0, 1500]], np.uint16))[1].tobytes()
    short = CompressedImage(HEADER, "16UC1; compressedDepth png", struct.pack("<iff", 0, 0.0, 0.0) + png)
    assert depth_of(short) == pytest.approx(np.array([[0.0, 1.5]]))
    a, b = 2000.0, 100.0  # depth = a / (value - b)
    png = cv2.imencode(".png", np.array([[0, 1100]], np.uint16))[1].tobytes()
    floats = CompressedImage(HEADER, "32FC1; compressedDepth png", struct.pack("<iff", 0, a, b) + png)
    assert depth_of(floats) == pytest.approx(np.array([[0.0, 2.0]]))


def test_labels_come_back() -> None:
    ids = np.array([[0, 7], [70_000, 2]], np.int32)
    assert np.array_equal(label_ids_of(label_message(ids, HEADER)), ids)


def test_a_camera_survives_its_own_camera_info() -> None:
    camera = Camera(64, 48, 79.0, 0.88)
    rectifier = Rectifier(info_of(camera, HEADER), 0, 0.88)
    assert rectifier.camera.fx_px == pytest.approx(camera.fx_px)
    assert (rectifier.camera.cx_px, rectifier.camera.cy_px) == (32.0, 24.0)
    image = np.zeros((48, 64, 3), np.uint8)
    assert rectifier.rgb(image) is image
    half = Rectifier(info_of(camera, HEADER), 32, 0.88).camera
    assert (half.width_px, half.height_px, half.cx_px, half.cy_px) == (32, 24, 16.0, 12.0)
    assert half.hfov_deg == pytest.approx(79.0)
    with pytest.raises(EnvironmentFailure, match="aligned to colour"):
        rectifier.depth(np.zeros((24, 32), np.float32))


def test_distortion_is_taken_out() -> None:
    """A point where OpenCV's model puts it in the distorted image is found where the pinhole has it."""
    K = np.array([[60.0, 0, 31.5], [0, 60.0, 23.5], [0, 0, 1]])
    d = np.array([-0.3, 0.1, 0.0, 0.0, 0.0])
    info = CameraInfo(HEADER, 48, 64, "plumb_bob", tuple(d), tuple(K.ravel()), tuple(np.eye(3).ravel()), (0.0,) * 12)
    point = np.array([[0.35, -0.25, 1.0]])
    pixel, _ = cv2.projectPoints(point, np.zeros(3), np.zeros(3), K, d)
    u, v = pixel.ravel().round().astype(int)
    depth = np.zeros((48, 64), np.float32)
    depth[v - 1 : v + 2, u - 1 : u + 2] = 1.0
    found = np.argwhere(Rectifier(info, 0, 0.9).depth(depth) > 0).mean(axis=0)
    assert found == pytest.approx([60 * -0.25 + 23.5, 60 * 0.35 + 31.5], abs=0.8)
    with pytest.raises(EnvironmentFailure, match="equidistant"):
        Rectifier(CameraInfo(HEADER, 48, 64, "equidistant", (), tuple(K.ravel()), (), ()), 0, 0.9)


@given(st.floats(-3.1, 3.1))
def test_a_quaternion_keeps_its_yaw(yaw: float) -> None:
    assert Quaternion.of_yaw(yaw).yaw_rad == pytest.approx(yaw)


def transform(parent: str, child: str, xyz: tuple[float, float, float], q: Quaternion) -> TransformStamped:
    return TransformStamped(Header(1, parent), child, Vector3(*xyz), q)


def test_tf_finds_the_camera_on_the_body() -> None:
    tree = TfTree()
    optical = Quaternion(-0.5, 0.5, -0.5, 0.5)
    assert place_of_camera(tree, "base_link", "optical", None) is None
    tree.add(TFMessage((transform("base_link", "camera_link", (0.1, 0, 0.9), Quaternion()),)))
    tree.add(
        TFMessage(
            (transform("camera_link", "optical", (0, 0, 0), optical), transform("odom", "base_link", (5, 1, 0), Quaternion()))
        )
    )
    T = place_of_camera(tree, "base_link", "optical", None)
    assert T is not None
    assert pytest.approx([1.1, 0, 0.9, 1]) == T @ [1, 0, 0, 1]  # ahead of the camera is ahead of the body
    assert pytest.approx([0.1, 1, 0.9, 1]) == T @ [0, 1, 0, 1]
    assert tree.lookup("odom", "optical") == pytest.approx(np.linalg.inv(tree.lookup("optical", "odom")))
    assert tree.links("odom", "base_link") == {"base_link"}
    tilted = place_of_camera(tree, "base_link", "optical", Mount(z_m=1.0, pitch_deg=30.0))
    assert tilted is not None
    assert (tilted @ [1, 0, 0, 1])[2] == pytest.approx(0.5)  # downward


def test_poses_are_interpolated_over_short_gaps_only() -> None:
    history = PoseHistory(gap_s=0.25)
    history.add(0, Pose(0, 0, 0, math.pi - 0.1))
    history.add(100_000_000, Pose(1, 0, 0, -math.pi + 0.1))
    middle = history.at(50_000_000)
    assert middle is not None
    assert (middle.x_m, abs(middle.yaw_rad)) == pytest.approx((0.5, math.pi))
    assert history.at(100_000_001) is None
    history.add(900_000_000, Pose(2, 0))
    assert history.at(500_000_000) is None
    history.add(10, Pose(0, 0))  # the clock went back: a new history
    assert len(history) == 1


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_the_fence_is_its_polygon(x: float, y: float) -> None:
    square = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    if abs(abs(x) - 1) > 1e-6 and abs(abs(y) - 1) > 1e-6:
        assert inside(square, x, y) == (abs(x) < 1 and abs(y) < 1)
    assert inside((), x, y)


def test_every_profile_that_comes_along_loads() -> None:
    assert set(profile_names()) == {"generic", "tx-q1", "turtlebot4"}
    for name in profile_names():
        assert load_profile(name).name == name
    assert load_profile("turtlebot4").topics.stamped_cmd_vel
    with pytest.raises(UnknownNameError, match="turtlebot4"):
        load_profile("turtlebot")


def test_a_wrong_profile_says_where(tmp_path) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "mine.toml"
    path.write_text('name = "mine"\n[limits]\nspeed = 1.0\n')
    with pytest.raises(UsageError, match=r"limits\.speed"):
        load_profile(str(path))


def test_rclpy_is_asked_for_by_name() -> None:
    from spacevln.core import PrerequisiteError

    with pytest.raises(PrerequisiteError, match=r"source /opt/ros"):
        open_transport("rclpy")
