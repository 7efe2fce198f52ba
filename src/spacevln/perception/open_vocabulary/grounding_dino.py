"""GroundingDINO and MM-Grounding-DINO through transformers (paper Sec. 4.1, "Deployment": GroundingDINO)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from transformers import AutoConfig, AutoTokenizer
from transformers.models.auto.modeling_auto import AutoModelForZeroShotObjectDetection
from transformers.models.grounding_dino.image_processing_pil_grounding_dino import GroundingDinoImageProcessorPil

from spacevln.core import UsageError
from spacevln.perception.open_vocabulary.boxes import LEAST_SCORE, ScoredBoxes
from spacevln.perception.open_vocabulary.checkpoints import from_folder
from spacevln.perception.open_vocabulary.compute import Compute
from spacevln.perception.open_vocabulary.detector import Image
from spacevln.perception.open_vocabulary.queries import Caption, Query, captions_of, score_phrases

KINDS = ("grounding-dino", "mm-grounding-dino")


class GroundingDino:
    """Implements :class:`~spacevln.perception.open_vocabulary.detector.Grounder`.

    Args:
        folder: with ``config.json``, ``model.safetensors``, tokenizer and image processor, as published.
        compute: where.

    Raises:
        UsageError: the folder is incomplete, damaged or of another model.
    """

    def __init__(self, folder: Path, compute: Compute) -> None:
        config = from_folder(AutoConfig, folder)
        if config.model_type not in KINDS:
            raise UsageError(f"The model in {str(folder)!r} is a {config.model_type}: give one of {', '.join(KINDS)}.")
        self._tokenizer = from_folder(AutoTokenizer, folder)
        self._processor = from_folder(GroundingDinoImageProcessorPil, folder)
        model = from_folder(AutoModelForZeroShotObjectDetection, folder, use_safetensors=True)
        self._model = compute.place(model)
        self._max_tokens = int(config.max_text_len)
        self._captions = lru_cache(maxsize=64)(self._captions_of)

    def ground(self, images: Sequence[Image], queries: Sequence[Query], text_threshold: float) -> list[ScoredBoxes]:
        """See :meth:`~spacevln.perception.open_vocabulary.detector.Grounder.ground`."""
        pixels = self._processor(images=list(images), return_tensors="pt")
        parts: list[list[ScoredBoxes]] = [[] for _ in images]
        for caption in self._captions(tuple(queries)):
            for part, found in zip(parts, self._forward(images, pixels, caption, len(queries), text_threshold), strict=True):
                part.append(found)
        return [
            ScoredBoxes(np.concatenate([each.boxes_px for each in part]), np.concatenate([each.scores for each in part]))
            for part in parts
        ]

    @torch.inference_mode()
    def _forward(
        self, images: Sequence[Image], pixels: Any, caption: Caption, count: int, text_threshold: float
    ) -> list[ScoredBoxes]:
        text = self._tokenizer([caption.text] * len(images), return_tensors="pt").to(self._model.device)
        outputs = self._model(
            **text,
            pixel_values=pixels["pixel_values"].to(self._model.device, self._model.dtype),
            pixel_mask=pixels["pixel_mask"].to(self._model.device),
        )
        tokens = outputs.logits.float().sigmoid().cpu().numpy()
        boxes = outputs.pred_boxes.float().cpu().numpy()
        found = []
        for image, token_scores, relative in zip(images, tokens, boxes, strict=True):
            likely = token_scores.max(axis=1) > LEAST_SCORE
            height, width = image.shape[:2]
            found.append(
                ScoredBoxes(
                    corners_px(relative[likely], width, height),
                    score_phrases(token_scores[likely], caption, count, text_threshold),
                )
            )
        return found

    def _captions_of(self, queries: tuple[Query, ...]) -> tuple[Caption, ...]:
        return captions_of(queries, self._offsets, self._max_tokens)

    def _offsets(self, text: str) -> list[tuple[int, int]]:
        return list(self._tokenizer(text, return_offsets_mapping=True, verbose=False)["offset_mapping"])


def corners_px(
    relative: np.ndarray[Any, np.dtype[np.float32]], width: float, height: float
) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Boxes (N, 4) from centre and size in shares of a frame to corners in its pixels."""
    centre, half = relative[:, :2], relative[:, 2:] / 2
    scale = np.array([width, height, width, height], np.float32)
    return np.concatenate([centre - half, centre + half], axis=1).astype(np.float32) * scale
