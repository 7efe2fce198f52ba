"""Many clients on one detector server for a while: every answer must be the asker's, and nothing may be left behind.

Run with ``python benchmarks/detector_soak.py --clients 8 --minutes 10``; the detector echoes what it was shown, so that a lost,
swapped or leaked request is noticed. The tests do the same for half a minute.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

ECHO = Path(__file__).parents[1] / "tests" / "perception"
sys.path.insert(0, str(ECHO))

from echo_detector import echo  # noqa: E402

from spacevln.perception.serving import SharedDetector  # noqa: E402


def one_client(number: int, folder: Path, seconds: float) -> tuple[int, int, int]:
    """Ask with pictures and phrases of its own; requests, images, retries."""
    client, images, count = SharedDetector("echo_detector:make", {"delay_s": 0.01}, folder), 0, 0
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        rng = np.random.default_rng([number, count])
        shown = [rng.integers(0, 255, (48 + number, 64, 3), np.uint8) for _ in range(1 + count % 3)]
        phrases = ["sofa", "door"][: 1 + (number + count) % 2]
        found = client.detect_images(shown, phrases)
        for image, detections in zip(shown, found, strict=True):
            assert [detection.category for detection in detections] == phrases
            for detection in detections:
                wanted = echo(image, detection.category)
                assert (detection.box_px, detection.confidence) == (wanted.box_px, wanted.confidence)
                assert np.array_equal(detection.mask, wanted.mask)  # type: ignore[arg-type]
        images, count = images + len(shown), count + 1
    assert client.counts.requests == count
    retries = client.counts.retries
    client.close()
    return count, images, retries


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clients", type=int, default=8)
    parser.add_argument("--minutes", type=float, default=10.0)
    chosen = parser.parse_args()
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ECHO), *filter(None, sys.path)])
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(chosen.clients) as pool:
        told = [pool.submit(one_client, n, Path(folder) / "s", 60 * chosen.minutes) for n in range(chosen.clients)]
        counts = np.array([each.result() for each in told])
    descriptors = len(list(Path("/proc/self/fd").iterdir()))
    sys.stdout.write(
        f"{chosen.clients} clients, {chosen.minutes:g} minutes: {counts[:, 0].sum()} requests, {counts[:, 1].sum()} images, "
    )
    sys.stdout.write(f"every answer the asker's, {counts[:, 2].sum()} retries; {descriptors} descriptors left open\n")


if __name__ == "__main__":
    main()
