"""From scored boxes to the boxes that count: thresholds, whole-image boxes, two boxes of one thing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core import UsageError

Box = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class BoxRules:
    """Which boxes count.

    Args:
        box_threshold: a box's best phrase must score more; object goals take 0.5.
        text_threshold: a phrase's noun must score more; object goals take 0.5.
        whole_image_share: a box that covers this share of the image is no thing in it.
        duplicate_iou: two boxes that overlap this much are one thing; the higher score stands.
    """

    box_threshold: float = 0.25
    text_threshold: float = 0.25
    whole_image_share: float = 0.95
    duplicate_iou: float = 0.65

    def __post_init__(self) -> None:
        for name in ("box_threshold", "text_threshold", "whole_image_share", "duplicate_iou"):
            if not 0 <= (value := getattr(self, name)) <= 1:
                raise UsageError(f"{name}={value} is outside 0 to 1: give a share or a confidence.")


LEAST_SCORE = 0.05
"""Boxes none of whose tokens reaches it are not looked at any further."""

OBJECT_GOAL_THRESHOLD = 0.5
"""Both thresholds where the goal is an object."""


@dataclass(frozen=True, slots=True, eq=False)
class ScoredBoxes:
    """What a grounding model says of one image.

    Args:
        boxes_px: (N, 4) x0, y0, x1, y1; they may reach over the image's border.
        scores: (N, Q) of every query, 0 to 1; 0 = not named.
    """

    boxes_px: NDArray[np.float32]
    scores: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class GroundedBox:
    """A box that counts.

    Args:
        query: index of its phrase.
        box_px: x0, y0, x1, y1 in whole pixels inside the image, end exclusive.
        confidence: 0 to 1.
    """

    query: int
    box_px: Box
    confidence: float


def select(found: ScoredBoxes, width_px: int, height_px: int, rules: BoxRules) -> tuple[GroundedBox, ...]:
    """The boxes that count, most confident first; every box carries its best phrase."""
    if not len(found.boxes_px) or not found.scores.shape[1]:
        return ()
    best = found.scores.max(axis=1)
    sound = (best > rules.box_threshold) & np.isfinite(found.boxes_px).all(axis=1)
    best, query = best[sound], found.scores[sound].argmax(axis=1)
    boxes = np.rint(found.boxes_px[sound]).clip(-1e6, 1e6).astype(np.int64)
    boxes[:, 0::2] = boxes[:, 0::2].clip(0, width_px)
    boxes[:, 1::2] = boxes[:, 1::2].clip(0, height_px)
    area = np.maximum(boxes[:, 2] - boxes[:, 0], 0) * np.maximum(boxes[:, 3] - boxes[:, 1], 0)
    counts = (area > 0) & (area < rules.whole_image_share * width_px * height_px)
    columns = zip(best[counts].tolist(), boxes[counts].tolist(), query[counts].tolist(), strict=True)
    kept: list[GroundedBox] = []
    for confidence, (x0, y0, x1, y1), phrase in sorted(columns, key=lambda row: (-row[0], *row[1:])):
        box = (x0, y0, x1, y1)
        if all(_iou(box, other.box_px) < rules.duplicate_iou for other in kept):
            kept.append(GroundedBox(phrase, box, min(confidence, 1.0)))
    return tuple(kept)


def _iou(a: Box, b: Box) -> float:
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    both = width * height
    return both / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - both)
