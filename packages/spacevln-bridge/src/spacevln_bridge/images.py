"""One RGB-D image with labels in a block of bytes, shared by both ends or sent."""

from __future__ import annotations

import mmap
from typing import Any, Tuple

import numpy as np

_BYTES_PER_PIXEL = 4 + 4 + 4


def block_bytes(width_px: int, height_px: int) -> int:
    """Size of the block of an image."""
    return _BYTES_PER_PIXEL * width_px * height_px


def views(block: Any, width_px: int, height_px: int) -> Tuple[Any, Any, Any]:
    """Arrays over a block: rgba (H, W, 4) uint8, depth (H, W) float32, labels (H, W) int32; alpha means nothing.

    Simulators draw four channels, and whole rows are copied several times as fast as three of four bytes.
    """
    count, shape = width_px * height_px, (height_px, width_px)
    depth = np.frombuffer(block, np.float32, count).reshape(shape)
    labels = np.frombuffer(block, np.int32, count, 4 * count).reshape(shape)
    rgba = np.frombuffer(block, np.uint8, 4 * count, 8 * count).reshape((*shape, 4))
    return rgba, depth, labels


def shared_block(descriptor: int, width_px: int, height_px: int) -> mmap.mmap:
    """The block in a shared-memory file.

    Raises:
        ValueError: the file is too small for it.
    """
    return mmap.mmap(descriptor, block_bytes(width_px, height_px))
