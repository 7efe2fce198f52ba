"""From CameraInfo to a rectified pinhole camera of a chosen width."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import EnvironmentFailure
from spacevln.core.sensing import Camera
from spacevln.environments.robot.messages import CameraInfo, Header

_MODELS = ("", "plumb_bob", "rational_polynomial", "none")
_HALF_PIXEL = 0.5  # ROS puts pixel centres at whole numbers, we at half ones


class Rectifier:
    """Undistorts and scales images.

    Args:
        info: of the camera.
        width_px: of the result; 0 keeps the camera's.
        height_m: of the optical centre over the floor.

    Raises:
        EnvironmentFailure: the camera is not calibrated, or by a model that is not supported.
    """

    def __init__(self, info: CameraInfo, width_px: int, height_m: float) -> None:
        if info.k[0] <= 0 or info.k[4] <= 0:
            raise EnvironmentFailure(
                "CameraInfo has no focal length: calibrate the camera, or start its driver with a calibration."
            )
        if info.distortion_model not in _MODELS:
            raise EnvironmentFailure(
                f"The camera's distortion model is {info.distortion_model!r}: allowed are plumb_bob and rational_polynomial; "
                "give a rectified stream."
            )
        self._size = (info.height, info.width)
        width = width_px or info.width
        scale = width / info.width
        height = round(info.height * scale)
        K = np.array(info.k, np.float64).reshape(3, 3)
        new = K.copy()
        new[:2] *= scale
        new[:2, 2] += _HALF_PIXEL * (scale - 1)  # the same point of the image, pixel centres at whole numbers
        d = np.array(info.d, np.float64)
        self._maps: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None
        if width != info.width or np.any(d != 0):
            self._maps = cv2.initUndistortRectifyMap(K, d, np.eye(3), new, (width, height), cv2.CV_32FC1)  # type: ignore[assignment]
        self.camera = Camera(
            width_px=width,
            height_px=height,
            hfov_deg=math.degrees(2 * math.atan(width / 2 / new[0, 0])),
            height_m=height_m,
            fx_px=float(new[0, 0]),
            fy_px=float(new[1, 1]),
            cx_px=float(new[0, 2]) + _HALF_PIXEL,
            cy_px=float(new[1, 2]) + _HALF_PIXEL,
        )

    def rgb(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Colour as the rectified camera sees it, (H, W, 3)."""
        self._check(image.shape[:2])
        if self._maps is None:
            return image
        return np.asarray(cv2.remap(image, *self._maps, cv2.INTER_LINEAR), np.uint8)

    def depth(self, depth_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """Depth likewise, (H, W); never averaged over an edge."""
        self._check(depth_m.shape)
        if self._maps is None:
            return depth_m
        return np.asarray(cv2.remap(depth_m, *self._maps, cv2.INTER_NEAREST), np.float32)

    def ids(self, ids: NDArray[np.int32]) -> NDArray[np.int32]:
        """Instance ids likewise, (H, W)."""
        self._check(ids.shape)
        if self._maps is None:
            return ids
        return np.asarray(cv2.remap(ids.astype(np.float32), *self._maps, cv2.INTER_NEAREST), np.int32)

    def _check(self, size: tuple[int, ...]) -> None:
        if tuple(size) != self._size:
            raise EnvironmentFailure(
                f"An image is {size[1]}x{size[0]} pixels, CameraInfo says {self._size[1]}x{self._size[0]}: "
                "take depth that is aligned to colour, and the camera_info of the colour stream."
            )


def info_of(camera: Camera, header: Header) -> CameraInfo:
    """The CameraInfo of a pinhole camera without distortion."""
    fx, fy, cx, cy = camera.fx_px, camera.fy_px, camera.cx_px - _HALF_PIXEL, camera.cy_px - _HALF_PIXEL
    return CameraInfo(
        header,
        camera.height_px,
        camera.width_px,
        "plumb_bob",
        (0.0,) * 5,
        (fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0),
        (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        (fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0),
    )
