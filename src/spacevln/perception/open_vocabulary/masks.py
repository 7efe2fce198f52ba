"""From a segmenter's logits to the mask inside a box: the best of several masks, brought to the image's size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

MASK_THRESHOLD = 0.0
"""Logits above it belong to the thing."""


@dataclass(frozen=True, slots=True)
class Framing:
    """How an image was laid into a model's square input.

    Args:
        scale_x, scale_y: input pixels per image pixel.
        size_px: side of the square.
    """

    scale_x: float
    scale_y: float
    size_px: int

    @classmethod
    def padded(cls, width_px: int, height_px: int, size_px: int) -> Framing:
        """Longest side to ``size_px``, the rest padded at the right and the bottom (SAM, RepViT-SAM)."""
        scale = size_px / max(width_px, height_px)
        return cls(int(width_px * scale + 0.5) / width_px, int(height_px * scale + 0.5) / height_px, size_px)

    @classmethod
    def stretched(cls, width_px: int, height_px: int, size_px: int) -> Framing:
        """Both sides to ``size_px`` (SAM 2)."""
        return cls(size_px / width_px, size_px / height_px, size_px)

    def to_input(self, boxes_px: Sequence[tuple[int, int, int, int]]) -> NDArray[np.float32]:
        """Boxes (N, 4) in the pixels of the model's input."""
        scales = np.array([self.scale_x, self.scale_y, self.scale_x, self.scale_y])
        boxes: NDArray[np.float64] = np.array(boxes_px, np.float64).reshape(-1, 4) * scales
        return boxes.astype(np.float32)


def best_masks(
    logits: NDArray[np.float32], quality: NDArray[np.float32], boxes_px: Sequence[tuple[int, int, int, int]], framing: Framing
) -> list[NDArray[np.bool_]]:
    """Of the masks offered for each box the one that the model thinks best, inside the box.

    Logits are interpolated once, bilinearly, from the model's grid to the image's pixels of the box, and only there.

    Args:
        logits: (N, masks, h, w) over the model's input.
        quality: (N, masks) predicted overlap with the truth.
        boxes_px: the N boxes in the image.
        framing: of the image in the input.
    """
    masks = []
    for of_box, scores, (x0, y0, x1, y1) in zip(logits, quality, boxes_px, strict=True):
        grid = of_box[int(np.argmax(scores))].astype(np.float32, copy=False)
        step_x, step_y = framing.scale_x * grid.shape[1] / framing.size_px, framing.scale_y * grid.shape[0] / framing.size_px
        to_grid = np.array([[step_x, 0.0, (x0 + 0.5) * step_x - 0.5], [0.0, step_y, (y0 + 0.5) * step_y - 0.5]])
        inside = cv2.warpAffine(
            grid, to_grid, (x1 - x0, y1 - y0), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
        )
        masks.append(np.asarray(inside > MASK_THRESHOLD, np.bool_))
    return masks
