"""A detector for the server's tests: says what it was shown, so that a lost or swapped answer is noticed."""

from __future__ import annotations

import os
import time
import zlib
from collections.abc import Sequence

import numpy as np

from spacevln.core import Detection, UsageError
from spacevln.perception.open_vocabulary.detector import Image


class Echo:
    def __init__(self, delay_s: float = 0.0) -> None:
        self.delay_s = delay_s
        self.passes: list[int] = []

    def detect_images(self, images: Sequence[Image], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        self.passes.append(len(images))
        time.sleep(self.delay_s)
        if "crash" in phrases:
            os._exit(1)
        if "refuse" in phrases:
            raise UsageError("'refuse' is refused.")
        if "fail" in phrases:
            raise ZeroDivisionError("by zero")
        if "bug" in phrases:
            raise AssertionError("never so")
        return [tuple(echo(image, phrase) for phrase in phrases) for image in images]


def echo(image: Image, phrase: str) -> Detection:
    """The whole picture, its checksum as the confidence, its bright pixels as the mask; for "pid" the process as the category."""
    height, width = image.shape[:2]
    number = zlib.crc32(np.ascontiguousarray(image).tobytes()) / 2**32
    return Detection(f"pid {os.getpid()}" if phrase == "pid" else phrase, (0, 0, width, height), number, image[:, :, 0] > 127)


def make(delay_s: float = 0.0) -> Echo:
    return Echo(delay_s)


def unusable() -> Echo:
    raise UsageError("These settings are not usable: give others.")


class Quick:
    """Finds the same thing at once, so that a round trip is all that takes time."""

    def detect_images(self, images: Sequence[Image], phrases: Sequence[str]) -> list[tuple[Detection, ...]]:
        mask = np.ones((240, 256), np.bool_)
        return [(Detection(phrases[0], (100, 100, 356, 340), 0.5, mask),)] * len(images)


def quick() -> Quick:
    return Quick()
