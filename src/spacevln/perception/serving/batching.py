"""Requests of many clients, put together while the model is busy: a free model takes at once all that waits and fits."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

from spacevln.core import Detection
from spacevln.perception.open_vocabulary.detector import Image, ImageDetector

Found = list[tuple[Detection, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class _Request:
    images: Sequence[Image]
    phrases: tuple[str, ...]
    answer: Future[Found] = field(default_factory=Future)


class Batcher:
    """Runs one detector in one thread for any number of callers.

    Nobody waits for company: a lone request goes through at once. Requests with the same phrases share a pass, the oldest first.

    Args:
        detector: that does the work.
        max_images: of requests put together; a single larger request goes through alone.
    """

    def __init__(self, detector: ImageDetector, max_images: int = 12) -> None:
        self._detector, self._max_images = detector, max_images
        self._waiting: deque[_Request] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="detector", daemon=True)
        self._thread.start()

    def submit(self, images: Sequence[Image], phrases: Sequence[str]) -> Future[Found]:
        """What will be found in the images; the future carries the detector's error where there is one."""
        request = _Request(images, tuple(phrases))
        with self._changed:
            if self._closed:
                raise RuntimeError("the batcher is closed")
            self._waiting.append(request)
            self._changed.notify()
        return request.answer

    def close(self) -> None:
        """Finish what waits and end the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()

    def _work(self) -> None:
        while requests := self._next():
            images = [image for request in requests for image in request.images]
            try:
                found = self._detector.detect_images(images, requests[0].phrases)
            except Exception as error:  # noqa: BLE001 - every caller is told, and the server lives on
                for request in requests:
                    request.answer.set_exception(error)
                continue
            at = 0
            for request in requests:
                request.answer.set_result(found[at : at + len(request.images)])
                at += len(request.images)

    def _next(self) -> list[_Request]:
        """The oldest request and what may go along with it; empty when all is done."""
        with self._changed:
            while not self._waiting and not self._closed:
                self._changed.wait()
            if not self._waiting:
                return []
            chosen, count = [self._waiting.popleft()], 0
            count = len(chosen[0].images)
            for request in tuple(self._waiting):
                if request.phrases == chosen[0].phrases and count + len(request.images) <= self._max_images:
                    self._waiting.remove(request)
                    chosen.append(request)
                    count += len(request.images)
            return chosen
