"""RepViT-SAM, the paper's segmenter: RepViT's image encoder before SAM's prompt encoder and mask decoder.

Reads the published ``repvit_sam.pt`` as it is: a flat table with the prefixes ``image_encoder.``, ``prompt_encoder.`` and
``mask_decoder.``, the latter two with the names of the original Segment Anything, which transformers renamed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import nn
from transformers import SamConfig, SamMaskDecoderConfig, SamPromptEncoderConfig, SamVisionConfig
from transformers.models.sam.modeling_sam import SamMaskDecoder, SamPromptEncoder

from spacevln.perception.open_vocabulary.checkpoints import check_layout, load_tensors
from spacevln.perception.open_vocabulary.compute import Compute
from spacevln.perception.open_vocabulary.masks import Framing
from spacevln.perception.open_vocabulary.promptable import PromptableSegmenter
from spacevln.perception.open_vocabulary.repvit import EncoderShape, RepViTEncoder

NORM_EPS = 1e-5
"""Of the original decoder's norms; transformers' default is 1e-6."""

_RENAMED = tuple(
    (re.compile(pattern), name)
    for pattern, name in (
        (
            r"^prompt_encoder\.pe_layer\.positional_encoding_gaussian_matrix$",
            "prompt_encoder.shared_embedding.positional_embedding",
        ),
        (r"^prompt_encoder\.point_embeddings\.", "prompt_encoder.point_embed."),
        (r"^prompt_encoder\.mask_downscaling\.0\.", "prompt_encoder.mask_embed.conv1."),
        (r"^prompt_encoder\.mask_downscaling\.1\.", "prompt_encoder.mask_embed.layer_norm1."),
        (r"^prompt_encoder\.mask_downscaling\.3\.", "prompt_encoder.mask_embed.conv2."),
        (r"^prompt_encoder\.mask_downscaling\.4\.", "prompt_encoder.mask_embed.layer_norm2."),
        (r"^prompt_encoder\.mask_downscaling\.6\.", "prompt_encoder.mask_embed.conv3."),
        (r"^(mask_decoder\.transformer\.layers\.\d+)\.norm(\d)\.", r"\1.layer_norm\2."),
        (r"^mask_decoder\.transformer\.norm_final_attn\.", "mask_decoder.transformer.layer_norm_final_attn."),
        (r"^mask_decoder\.output_upscaling\.0\.", "mask_decoder.upscale_conv1."),
        (r"^mask_decoder\.output_upscaling\.1\.", "mask_decoder.upscale_layer_norm."),
        (r"^mask_decoder\.output_upscaling\.3\.", "mask_decoder.upscale_conv2."),
        (r"^(mask_decoder\.(?:output_hypernetworks_mlps\.\d+|iou_prediction_head))\.layers\.0\.", r"\1.proj_in."),
        (r"^(mask_decoder\.(?:output_hypernetworks_mlps\.\d+|iou_prediction_head))\.layers\.1\.", r"\1.layers.0."),
        (r"^(mask_decoder\.(?:output_hypernetworks_mlps\.\d+|iou_prediction_head))\.layers\.2\.", r"\1.proj_out."),
    )
)


@dataclass(frozen=True, slots=True)
class RepViTSamShape:
    """Sizes of the whole model; the published ones by default.

    Args:
        encoder: of the image encoder.
        image_px: side of the input.
        mlp_width: of the decoder.
    """

    encoder: EncoderShape = EncoderShape()  # noqa: RUF009 - frozen
    image_px: int = 1024
    mlp_width: int = 2048


class RepViTSam(nn.Module):
    """Implements :class:`~spacevln.perception.open_vocabulary.promptable.PromptableModel`."""

    def __init__(self, shape: RepViTSamShape | None = None) -> None:
        super().__init__()
        self.shape = shape = shape or RepViTSamShape()
        width = shape.encoder.out_width
        config = SamConfig(
            vision_config=SamVisionConfig(image_size=shape.image_px, output_channels=width, num_pos_feats=width // 2),
            prompt_encoder_config=SamPromptEncoderConfig(hidden_size=width, image_size=shape.image_px, mask_input_channels=16),
            mask_decoder_config=SamMaskDecoderConfig(
                hidden_size=width, mlp_dim=shape.mlp_width, iou_head_hidden_dim=width, layer_norm_eps=NORM_EPS
            ),
        )
        config.mask_decoder_config._attn_implementation = "eager"  # noqa: SLF001 - what its own model does
        self.image_encoder = RepViTEncoder(shape.encoder)
        self.prompt_encoder = SamPromptEncoder(config)
        self.mask_decoder = SamMaskDecoder(config.mask_decoder_config)

    @property
    def device(self) -> Any:
        """Of the weights."""
        return next(self.parameters()).device

    @property
    def dtype(self) -> Any:
        """Of the weights."""
        return next(self.parameters()).dtype

    def embed(self, pixels: Any) -> Any:
        """Prepared images (B, 3, S, S) to embeddings (B, 256, S / 16, S / 16)."""
        return self.image_encoder(pixels)

    def decode(self, embedding: Any, boxes: Any) -> tuple[Any, Any]:
        """Three masks a box, in input pixels (1, N, 4), and their predicted quality."""
        sparse, dense = self.prompt_encoder(input_points=None, input_labels=None, input_boxes=boxes, input_masks=None)
        masks, quality = self.mask_decoder(
            image_embeddings=embedding,
            image_positional_embeddings=self._position_of_cells(),
            sparse_prompt_embeddings=sparse.to(self.dtype),
            dense_prompt_embeddings=dense.to(self.dtype),
            multimask_output=True,
        )
        return masks[0], quality[0]

    def _position_of_cells(self) -> Any:
        cells = self.prompt_encoder.image_embedding_size[0]
        centres = (torch.arange(cells, device=self.device, dtype=torch.float32) + 0.5) / cells
        grid = torch.stack(torch.meshgrid(centres, centres, indexing="xy"), dim=-1).to(self.dtype)
        return self.prompt_encoder.shared_embedding(grid).permute(2, 0, 1)[None]


def renamed(published: str) -> str:
    """Our name of a tensor of the published file."""
    for pattern, name in _RENAMED:
        if pattern.match(published):
            return pattern.sub(name, published)  # once: the old layers.1 becomes layers.0, which was another
    return published


def load_repvit_sam(path: Path, shape: RepViTSamShape | None = None) -> RepViTSam:
    """The model with the weights of a file in the published layout.

    Raises:
        UsageError: the file is missing, damaged, holds more than weights, or has other names or shapes.
    """
    tensors = load_tensors(path)
    with torch.device("meta"):
        model = RepViTSam(shape)
    ours = {renamed(name): tensor for name, tensor in tensors.items()}
    check_layout(ours, model.state_dict(), path, "repvit-sam")
    model.load_state_dict(ours, assign=True)
    return model


def open_repvit_sam(path: Path, compute: Compute, shape: RepViTSamShape | None = None) -> PromptableSegmenter:
    """A segmenter from the published file.

    Raises:
        UsageError: see :func:`load_repvit_sam`.
    """
    model = compute.place(load_repvit_sam(path, shape))
    return PromptableSegmenter(model, model.shape.image_px, Framing.padded)
