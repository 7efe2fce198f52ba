"""The ONNX segmenter on a made-up pair of files. Needs the extra ``onnx`` and the ``onnx`` package."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("onnxruntime", reason="needs the extra 'onnx'; .ci/run installs it and runs this")
pytest.importorskip("onnx", reason="needs the package onnx; .ci/run installs it and runs this")

from tiny_onnx import efficient_sam

from spacevln.core import UsageError
from spacevln.perception.open_vocabulary.onnx_sam import ENCODER, OnnxSegmenter


def test_the_best_mask_is_cut_to_its_box_without_torch(tmp_path: Path) -> None:
    image = np.zeros((40, 60, 3), np.uint8)
    image[10:30, 20:40, 1] = 255  # the second mask is the green channel
    image[:, :, 0] = 255
    first, second = OnnxSegmenter(efficient_sam(tmp_path)).segment(image, [(15, 5, 45, 35), (50, 0, 60, 9)])
    assert first.shape == (30, 30)
    assert first[5:25, 5:25].all()
    assert first.sum() == 400
    assert second.shape == (9, 10)
    assert not second.any()


def test_missing_damaged_and_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="spacevln models download efficient-sam-onnx"):
        OnnxSegmenter(tmp_path)
    efficient_sam(tmp_path)
    decoder = tmp_path / "efficient_sam_vitt_decoder.onnx"
    whole = (tmp_path / ENCODER).read_bytes()
    (tmp_path / ENCODER).write_bytes(decoder.read_bytes())
    with pytest.raises(UsageError, match="instead of"):
        OnnxSegmenter(tmp_path)
    (tmp_path / ENCODER).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UsageError, match="cannot be read"):
        OnnxSegmenter(tmp_path)
