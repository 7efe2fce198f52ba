"""Detections drawn on their picture."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core import Detection
from spacevln.language.names import plain_name

COLOURS = ((230, 60, 60), (40, 140, 230), (40, 170, 80), (220, 150, 20), (160, 70, 200), (20, 170, 170))
TINT = 0.45  # of a mask over the picture


def draw_detections(rgb: NDArray[np.uint8], detections: Sequence[Detection]) -> NDArray[np.uint8]:
    """A copy with masks tinted, boxes framed and named; one colour a phrase. No mask lies over a name."""
    canvas = rgb.copy()
    names = sorted({detection.category for detection in detections})
    colours = {name: COLOURS[index % len(COLOURS)] for index, name in enumerate(names)}
    for detection in reversed(detections):
        if detection.mask is not None:
            x0, y0, x1, y1 = detection.box_px
            window = canvas[y0:y1, x0:x1]
            window[detection.mask] = (1 - TINT) * window[detection.mask] + TINT * np.array(colours[detection.category])
    size = max(0.4, rgb.shape[1] / 1280)
    for detection in reversed(detections):
        x0, y0, x1, y1 = detection.box_px
        cv2.rectangle(canvas, (x0, y0), (x1 - 1, y1 - 1), colours[detection.category], 2)
        words = f"{plain_name(detection.category)} {detection.confidence:.2f}"
        _name(canvas, words, (x0, y0), colours[detection.category], size)
    return canvas


def _name(canvas: NDArray[np.uint8], text: str, corner: tuple[int, int], colour: tuple[int, int, int], size: float) -> None:
    (width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, 1)
    x = max(0, min(corner[0], canvas.shape[1] - width))
    y = corner[1] if corner[1] > height + below + 2 else corner[1] + height + below + 2
    cv2.rectangle(canvas, (x, y - height - below - 2), (x + width, y), colour, -1)
    cv2.putText(canvas, text, (x, y - below), cv2.FONT_HERSHEY_SIMPLEX, size, (255, 255, 255), 1, cv2.LINE_AA)
