"""EfficientSAM by onnxruntime: box-prompted masks without torch (extra ``onnx``)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spacevln.core import UsageError
from spacevln.perception.open_vocabulary.checkpoints import need
from spacevln.perception.open_vocabulary.detector import Box, Image

TOP_LEFT, BOTTOM_RIGHT = 2.0, 3.0
"""Labels of a box's corners among point prompts."""

ENCODER, DECODER = "efficient_sam_vitt_encoder.onnx", "efficient_sam_vitt_decoder.onnx"


class OnnxSegmenter:
    """Implements :class:`~spacevln.perception.open_vocabulary.detector.Segmenter`.

    The encoder reads ``batched_images``, RGB 0 to 1 in the image's own size; the decoder gives masks in that size.

    Args:
        folder: with the encoder and the decoder, as published.

    Raises:
        PrerequisiteError: onnxruntime is missing.
        UsageError: a file is missing, damaged or of another model.
    """

    def __init__(self, folder: Path) -> None:
        self._encoder = _session(folder / ENCODER, {"batched_images"})
        self._decoder = _session(
            folder / DECODER, {"image_embeddings", "batched_point_coords", "batched_point_labels", "orig_im_size"}
        )

    def segment(self, image: Image, boxes_px: Sequence[Box]) -> list[NDArray[np.bool_]]:
        """See :meth:`~spacevln.perception.open_vocabulary.detector.Segmenter.segment`."""
        pixels = image.transpose(2, 0, 1)[None].astype(np.float32) / 255
        (embedding, *_) = self._encoder.run(None, {"batched_images": pixels})
        return [self._mask(embedding, image.shape[:2], box) for box in boxes_px]

    def _mask(self, embedding: NDArray[np.float32], size: tuple[int, ...], box: Box) -> NDArray[np.bool_]:
        x0, y0, x1, y1 = box
        masks, quality, *_ = self._decoder.run(
            None,
            {
                "image_embeddings": embedding,
                "batched_point_coords": np.array([[[[x0, y0], [x1, y1]]]], np.float32),
                "batched_point_labels": np.array([[[TOP_LEFT, BOTTOM_RIGHT]]], np.float32),
                "orig_im_size": np.array(size, np.int64),
            },
        )
        best = masks[0, 0, int(np.argmax(quality[0, 0]))]
        return np.asarray(best[y0:y1, x0:x1] > 0, np.bool_)


def _session(path: Path, inputs: set[str]) -> Any:
    runtime = need("onnxruntime", "onnx")
    if not path.is_file():
        raise UsageError(f"The model {str(path)!r} does not exist: run spacevln models download efficient-sam-onnx.")
    errors = need("onnxruntime.capi.onnxruntime_pybind11_state", "onnx")
    refusals = (errors.Fail, errors.InvalidArgument, errors.InvalidGraph, errors.InvalidProtobuf, errors.NotImplemented, OSError)
    try:
        session = runtime.InferenceSession(path, providers=runtime.get_available_providers())
    except refusals as error:
        raise UsageError(
            f"The model {str(path)!r} cannot be read ({str(error).splitlines()[0]}): fetch it with spacevln models download."
        ) from error
    found = {each.name for each in session.get_inputs()}
    if found != inputs:
        raise UsageError(f"The model {str(path)!r} reads {sorted(found)} instead of {sorted(inputs)}: give EfficientSAM's file.")
    return session
