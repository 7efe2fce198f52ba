"""Pixels of image messages: colour as RGB, depth as metres."""

from __future__ import annotations

import struct

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import EnvironmentFailure
from spacevln.environments.robot.messages import CompressedImage, Header, Image

RGB_ENCODINGS = ("rgb8", "bgr8", "rgba8", "bgra8", "mono8")
DEPTH_ENCODINGS = ("16UC1", "mono16", "32FC1")
_CHANNELS = {"rgb8": 3, "bgr8": 3, "rgba8": 4, "bgra8": 4, "mono8": 1}
_COMPRESSED_DEPTH = struct.Struct("<iff")  # format, and A and B of depth = A / (value - B), before the PNG


def _rows(image: Image, dtype: str, channels: int) -> NDArray[np.generic]:
    """The pixels as an array, without the padding of rows."""
    kind = np.dtype(dtype).newbyteorder(">" if image.is_bigendian else "<")
    if len(image.data) < image.step * image.height or image.step < image.width * channels * kind.itemsize:
        raise EnvironmentFailure(
            f"An image of {image.width}x{image.height} {image.encoding} has {len(image.data)} bytes and step {image.step}: "
            "the driver's message is broken."
        )
    rows = np.frombuffer(image.data, np.uint8, image.step * image.height).reshape(image.height, image.step)
    wanted = np.ascontiguousarray(rows[:, : image.width * channels * kind.itemsize])
    shape = (image.height, image.width, channels) if channels > 1 else (image.height, image.width)
    return wanted.view(kind).reshape(shape)


def rgb_of(image: Image | CompressedImage) -> NDArray[np.uint8]:
    """Colour (H, W, 3) uint8.

    Raises:
        EnvironmentFailure: the encoding is not supported, or the message is broken.
    """
    if isinstance(image, CompressedImage):
        found = cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR)
        if found is None:
            raise EnvironmentFailure(f"A compressed image ({image.format!r}) cannot be decoded: allowed are JPEG and PNG.")
        return np.ascontiguousarray(found[..., ::-1], dtype=np.uint8)
    if image.encoding not in _CHANNELS:
        raise EnvironmentFailure(f"Colour images are {image.encoding!r}: allowed are {', '.join(RGB_ENCODINGS)}.")
    pixels = np.asarray(_rows(image, "u1", _CHANNELS[image.encoding]), np.uint8)
    if image.encoding == "mono8":
        return np.repeat(pixels[..., None], 3, axis=2)
    return np.ascontiguousarray(pixels[..., :3] if image.encoding.startswith("rgb") else pixels[..., 2::-1])


def depth_of(image: Image | CompressedImage, scale_m: float = 0.001) -> NDArray[np.float32]:
    """Depth (H, W) float32 metres along the optical axis; 0 where nothing was measured (0, NaN, infinite, negative).

    Args:
        image: 16UC1, mono16, 32FC1, or image_transport's compressedDepth of 16UC1 or 32FC1.
        scale_m: metres per unit of integer depth.

    Raises:
        EnvironmentFailure: the encoding is not supported, or the message is broken.
    """
    if isinstance(image, CompressedImage):
        return _clean(_compressed_depth(image, scale_m))
    if image.encoding not in DEPTH_ENCODINGS:
        raise EnvironmentFailure(f"Depth images are {image.encoding!r}: allowed are {', '.join(DEPTH_ENCODINGS)}.")
    if image.encoding == "32FC1":
        return _clean(np.asarray(_rows(image, "f4", 1), np.float32))
    return _clean(np.asarray(_rows(image, "u2", 1), np.float32) * np.float32(scale_m))


def _compressed_depth(image: CompressedImage, scale_m: float) -> NDArray[np.float32]:
    begin = _COMPRESSED_DEPTH.size if "compressedDepth" in image.format else 0
    values = cv2.imdecode(np.frombuffer(image.data, np.uint8, offset=begin), cv2.IMREAD_UNCHANGED)
    if values is None or values.ndim != 2:
        raise EnvironmentFailure(
            f"A compressed depth image ({image.format!r}) cannot be decoded: allowed is a PNG of one channel."
        )
    if not image.format.startswith("32FC1"):
        return np.asarray(values, np.float32) * np.float32(scale_m)
    _, a, b = _COMPRESSED_DEPTH.unpack_from(image.data)
    with np.errstate(divide="ignore"):
        return np.where(values > 0, np.float32(a) / (values.astype(np.float32) - np.float32(b)), np.float32(0))


def _clean(depth_m: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.where(np.isfinite(depth_m) & (depth_m > 0), depth_m, np.float32(0))


def rgb_message(rgb: NDArray[np.uint8], header: Header) -> Image:
    """An rgb8 message."""
    return Image(header, rgb.shape[0], rgb.shape[1], "rgb8", rgb.shape[1] * 3, np.ascontiguousarray(rgb).tobytes())


def depth_message(depth_m: NDArray[np.float32], header: Header, encoding: str = "16UC1") -> Image:
    """A depth message: 16UC1 in millimetres, or 32FC1 with NaN for no measurement."""
    height, width = depth_m.shape
    if encoding == "16UC1":
        data = np.clip(np.rint(depth_m * 1000), 0, 65535).astype("<u2")
        return Image(header, height, width, encoding, width * 2, data.tobytes())
    data32 = np.where(depth_m > 0, depth_m, np.nan).astype("<f4")
    return Image(header, height, width, encoding, width * 4, data32.tobytes())


def label_ids_of(image: Image) -> NDArray[np.int32]:
    """A simulator's instance ids (H, W) of a 32SC1 message."""
    if image.encoding != "32SC1":
        raise EnvironmentFailure(f"Label images are {image.encoding!r}: allowed is 32SC1.")
    return np.asarray(_rows(image, "i4", 1), np.int32)


def label_message(ids: NDArray[np.int32], header: Header) -> Image:
    """A 32SC1 message of instance ids."""
    return Image(header, ids.shape[0], ids.shape[1], "32SC1", ids.shape[1] * 4, np.ascontiguousarray(ids, "<i4").tobytes())
