"""OWLv2 through transformers: an alternative to GroundingDINO that scores every phrase by itself."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from transformers import AutoTokenizer, Owlv2Config, Owlv2ForObjectDetection
from transformers.models.owlv2.image_processing_pil_owlv2 import Owlv2ImageProcessorPil

from spacevln.core import UsageError
from spacevln.perception.open_vocabulary.boxes import ScoredBoxes
from spacevln.perception.open_vocabulary.checkpoints import from_folder
from spacevln.perception.open_vocabulary.compute import Compute
from spacevln.perception.open_vocabulary.detector import Image
from spacevln.perception.open_vocabulary.grounding_dino import corners_px
from spacevln.perception.open_vocabulary.queries import Query

TEMPLATE = "a photo of a {}"
"""What the model's authors ask with."""


class Owlv2:
    """Implements :class:`~spacevln.perception.open_vocabulary.detector.Grounder`.

    A phrase has one score, so the text threshold, which is about the words of a caption, does not apply.

    Args:
        folder: with ``config.json``, ``model.safetensors``, tokenizer and image processor, as published.
        compute: where.

    Raises:
        UsageError: the folder is incomplete, damaged or of another model.
    """

    def __init__(self, folder: Path, compute: Compute) -> None:
        config = from_folder(Owlv2Config, folder)
        self._max_tokens = int(config.text_config.max_position_embeddings)
        self._tokenizer = from_folder(AutoTokenizer, folder)
        self._processor = from_folder(Owlv2ImageProcessorPil, folder)
        self._model = compute.place(from_folder(Owlv2ForObjectDetection, folder, use_safetensors=True))

    @torch.inference_mode()
    def ground(
        self,
        images: Sequence[Image],
        queries: Sequence[Query],
        text_threshold: float,  # noqa: ARG002 - of the protocol
    ) -> list[ScoredBoxes]:
        """See :meth:`~spacevln.perception.open_vocabulary.detector.Grounder.ground`."""
        texts = [TEMPLATE.format(query.text) for query in queries]
        text = self._tokenizer(texts, padding="max_length", max_length=self._max_tokens, return_tensors="pt")
        if text["input_ids"].shape[1] > self._max_tokens:
            longest = max(queries, key=lambda query: len(query.text)).phrase
            raise UsageError(f"The landmark {longest!r} has more than {self._max_tokens} tokens: name it in fewer words.")
        pixels = self._processor(images=list(images), return_tensors="pt")["pixel_values"]
        outputs = self._model(
            input_ids=text["input_ids"].repeat(len(images), 1).to(self._model.device),
            attention_mask=text["attention_mask"].repeat(len(images), 1).to(self._model.device),
            pixel_values=pixels.to(self._model.device, self._model.dtype),
        )
        scores = outputs.logits.float().sigmoid().cpu().numpy().astype(np.float32)
        boxes = outputs.pred_boxes.float().cpu().numpy()
        sides = [max(image.shape[:2]) for image in images]  # images are padded to a square before they are resized
        return [ScoredBoxes(corners_px(b, side, side), s) for b, s, side in zip(boxes, scores, sides, strict=True)]
