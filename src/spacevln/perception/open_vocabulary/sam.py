"""SAM and SAM 2 through transformers. SAM 2 is the well-kept default outside the faithful preset."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from transformers import AutoConfig, Sam2Config, Sam2Model, SamModel

from spacevln.core import UsageError
from spacevln.perception.open_vocabulary.checkpoints import from_folder
from spacevln.perception.open_vocabulary.compute import Compute
from spacevln.perception.open_vocabulary.masks import Framing
from spacevln.perception.open_vocabulary.promptable import PromptableSegmenter

KINDS = ("sam", "sam2", "sam2_video")
"""The published SAM 2 folders are of the video model, whose image part is all that is used."""


@dataclass(frozen=True, slots=True)
class TransformersSam:
    """Implements :class:`~spacevln.perception.open_vocabulary.promptable.PromptableModel` for both models of transformers."""

    model: Any

    @property
    def device(self) -> Any:
        """Of the weights."""
        return self.model.device

    @property
    def dtype(self) -> Any:
        """Of the weights."""
        return self.model.dtype

    def embed(self, pixels: Any) -> Any:
        """One embedding, or several scales of it."""
        return self.model.get_image_embeddings(pixels)

    def decode(self, embedding: Any, boxes: Any) -> tuple[Any, Any]:
        """Three masks a box."""
        outputs = self.model(image_embeddings=embedding, input_boxes=boxes.to(self.dtype), multimask_output=True)
        return outputs.pred_masks[0], outputs.iou_scores[0]


def open_sam(folder: Path, compute: Compute) -> PromptableSegmenter:
    """A segmenter from a folder as published.

    Raises:
        UsageError: the folder is incomplete, damaged or of another model.
    """
    config = from_folder(AutoConfig, folder)
    if config.model_type == "sam":
        model = compute.place(from_folder(SamModel, folder, use_safetensors=True))
        return PromptableSegmenter(TransformersSam(model), int(config.vision_config.image_size), Framing.padded)
    if config.model_type in KINDS:
        image_part = Sam2Config(
            vision_config=config.vision_config,
            prompt_encoder_config=config.prompt_encoder_config,
            mask_decoder_config=config.mask_decoder_config,
        )
        model = compute.place(from_folder(Sam2Model, folder, use_safetensors=True, config=image_part))
        return PromptableSegmenter(TransformersSam(model), int(config.prompt_encoder_config.image_size), Framing.stretched)
    raise UsageError(f"The model in {str(folder)!r} is a {config.model_type}: give one of {', '.join(KINDS)}.")
