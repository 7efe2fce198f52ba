"""Find things that are named in every picture of a video file or of a camera, and write what was found as a video.

    python examples/detect_video.py kitchen.mp4 "white sofa" doorway --out found.avi
    python examples/detect_video.py 0 chair                             # the first camera, until Ctrl-C

Needs ``pip install 'spacevln[perception]'`` and weights (``spacevln models download grounding-dino-tiny sam2.1-tiny``).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from spacevln.core import UsageError
from spacevln.perception.open_vocabulary.detector import ImageDetector
from spacevln.perception.open_vocabulary.drawing import draw_detections
from spacevln.perception.open_vocabulary.opening import DetectorChoice, open_detector

FRAMES_PER_S = 10.0
"""Where the source does not say."""


def detect_video(source: str, phrases: Sequence[str], detector: ImageDetector, out: Path, every: int = 1) -> int:
    """Draw what is found in every n-th picture; how many pictures were looked at.

    Raises:
        UsageError: the source cannot be opened.
    """
    video = cv2.VideoCapture(int(source) if source.isdigit() else source)
    if not video.isOpened():
        raise UsageError(f"{source!r} is no video: give a file, or the number of a camera such as 0.")
    writer: cv2.VideoWriter | None = None
    count = seen = 0
    try:
        while (read := video.read())[0]:
            count += 1
            if (count - 1) % every:
                continue
            rgb = cv2.cvtColor(read[1], cv2.COLOR_BGR2RGB).astype(np.uint8)
            (found,) = detector.detect_images([rgb], phrases)
            drawn = cv2.cvtColor(draw_detections(rgb, found), cv2.COLOR_RGB2BGR)
            if writer is None:
                rate = (video.get(cv2.CAP_PROP_FPS) or FRAMES_PER_S) / every
                writer = cv2.VideoWriter(str(out), cv2.VideoWriter.fourcc(*"MJPG"), rate, (drawn.shape[1], drawn.shape[0]))
            writer.write(drawn)
            seen += 1
            names = ", ".join(f"{each.category} {each.confidence:.2f}" for each in found)
            sys.stdout.write(f"picture {count}: {names or 'nothing'}\n")
    except KeyboardInterrupt:
        sys.stdout.write("stopped\n")
    finally:
        video.release()
        if writer is not None:
            writer.release()
    return seen


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help="a video file, or the number of a camera")
    parser.add_argument("phrases", nargs="+", metavar="PHRASE")
    parser.add_argument("--out", type=Path, default=Path("detections.avi"))
    parser.add_argument("--every", type=int, default=1, help="look at every n-th picture")
    parser.add_argument("--grounder", default="grounding-dino-tiny")
    parser.add_argument("--segmenter", default="sam2.1-tiny")
    chosen = parser.parse_args()
    detector = open_detector(DetectorChoice(chosen.grounder, chosen.segmenter))
    detect_video(chosen.source, chosen.phrases, detector, chosen.out, chosen.every)


if __name__ == "__main__":
    main()
