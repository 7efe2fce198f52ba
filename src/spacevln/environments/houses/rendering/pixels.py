"""From the frame buffer's rows to images: flip, linearise, look up; one pass over the pixels each."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M


@njit(cache=True)
def depth_from_buffer(buffer: NDArray[np.float32], near: float, far: float, longest: float, out: NDArray[np.float32]) -> None:
    """Metric depth (H, W), top row first, from MuJoCo's reversed depth buffer (1 = near plane, 0 = far plane)."""
    height, width = buffer.shape
    scale, offset = near * far / (far - near), near / (far - near)
    for i in range(height):
        for j in range(width):
            depth = scale / (buffer[height - 1 - i, j] + offset)
            out[i, j] = depth if depth <= longest else 0.0


@njit(cache=True)
def ids_from_buffer(buffer: NDArray[np.uint8], table: NDArray[np.int32], out: NDArray[np.int32]) -> None:
    """Ids (H, W), top row first: ``table[colour]`` of MuJoCo's segmentation colours, (H, W, 3)."""
    height, width, _ = buffer.shape
    for i in range(height):
        for j in range(width):
            red, green, blue = buffer[height - 1 - i, j]
            colour = np.int64(red) | np.int64(green) << 8 | np.int64(blue) << 16
            out[i, j] = table[colour] if colour < table.shape[0] else 0


__all__ = ["NEAR_M", "RANGE_M", "depth_from_buffer", "ids_from_buffer"]
