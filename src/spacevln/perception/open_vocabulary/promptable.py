"""Box-prompted segmentation by models of the Segment-Anything family: one embedding per image, then masks for all its boxes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image as Pillow

from spacevln.perception.open_vocabulary.detector import Box, Image
from spacevln.perception.open_vocabulary.masks import Framing, best_masks

MEAN = np.array([123.675, 116.28, 103.53], np.float32)
DEVIATION = np.array([58.395, 57.12, 57.375], np.float32)
"""ImageNet's colours, which the whole family is trained with."""


class PromptableModel(Protocol):
    """What differs between the models."""

    @property
    def device(self) -> Any:
        """Where it computes."""

    @property
    def dtype(self) -> Any:
        """How precisely."""

    def embed(self, pixels: Any) -> Any:
        """Embeddings of prepared images (1, 3, size, size)."""

    def decode(self, embedding: Any, boxes: Any) -> tuple[Any, Any]:
        """Mask logits (N, masks, h, w) and their predicted quality (N, masks) for boxes (1, N, 4) in input pixels."""


@dataclass(frozen=True, slots=True)
class PromptableSegmenter:
    """Implements :class:`~spacevln.perception.open_vocabulary.detector.Segmenter`.

    Args:
        model: embeds and decodes.
        size_px: side of its square input.
        framing: how an image lies in it: ``Framing.padded`` or ``Framing.stretched``.
    """

    model: PromptableModel
    size_px: int
    framing: Callable[[int, int, int], Framing]

    @torch.inference_mode()
    def segment(self, image: Image, boxes_px: Sequence[Box]) -> list[NDArray[np.bool_]]:
        """See :meth:`~spacevln.perception.open_vocabulary.detector.Segmenter.segment`."""
        height, width = image.shape[:2]
        framing = self.framing(width, height, self.size_px)
        pixels = torch.from_numpy(prepared(image, framing)).to(self.model.device, self.model.dtype)
        boxes = torch.from_numpy(framing.to_input(boxes_px))[None].to(self.model.device)
        logits, quality = self.model.decode(self.model.embed(pixels), boxes)
        return best_masks(logits.float().cpu().numpy(), quality.float().cpu().numpy(), boxes_px, framing)


def prepared(image: Image, framing: Framing) -> NDArray[np.float32]:
    """An image as the family reads it: (1, 3, size, size), resized with antialiasing, normalised, then padded with zeros."""
    height, width = image.shape[:2]
    size = (round(width * framing.scale_x), round(height * framing.scale_y))
    resized = np.asarray(Pillow.fromarray(image).resize(size, Pillow.Resampling.BILINEAR), np.float32)
    pixels = np.zeros((1, 3, framing.size_px, framing.size_px), np.float32)
    pixels[0, :, : size[1], : size[0]] = ((resized - MEAN) / DEVIATION).transpose(2, 0, 1)
    return pixels
