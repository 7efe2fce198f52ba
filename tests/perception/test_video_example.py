"""The example on a video that the test makes."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest

from spacevln.core import Detection, UsageError


def example() -> ModuleType:
    path = Path(__file__).parents[2] / "examples" / "detect_video.py"
    spec = importlib.util.spec_from_file_location("detect_video", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Bright:
    """Finds the bright square."""

    def detect_images(self, images: Sequence[np.ndarray], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        found = []
        for image in images:
            rows, columns = np.nonzero(image[:, :, 0] > 128)
            box = (int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1)
            found.append((Detection(phrases[0], box, 0.5),))
        return found


def test_every_second_picture_is_looked_at_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    writer = cv2.VideoWriter(str(tmp_path / "in.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (160, 120))
    for k in range(6):
        picture = np.zeros((120, 160, 3), np.uint8)
        picture[40:80, 20 + 10 * k : 60 + 10 * k] = 255
        writer.write(picture)
    writer.release()
    seen = example().detect_video(str(tmp_path / "in.avi"), ["white square"], Bright(), tmp_path / "out.avi", every=2)
    assert seen == 3
    assert capsys.readouterr().out.splitlines()[0] == "picture 1: white square 0.50"
    video = cv2.VideoCapture(str(tmp_path / "out.avi"))
    pictures = []
    while (read := video.read())[0]:
        pictures.append(read[1])
    assert len(pictures) == 3
    assert pictures[0][78, 40, 2] > pictures[0][78, 40, 0] + 60  # the lower edge of a red frame


def test_what_is_no_video_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="is no video"):
        example().detect_video(str(tmp_path / "nothing.avi"), ["sofa"], Bright(), tmp_path / "out.avi")
