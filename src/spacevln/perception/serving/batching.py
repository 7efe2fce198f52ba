"""Requests of many clients, put together while the model is busy: a free model takes at once all that waits and fits."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from spacevln.core import Detection, EnvironmentFailure, SpaceVLNError

Seen = TypeVar("Seen")
"""What is looked at: an image, or an observation."""

Found = list[tuple[Detection, ...]]

MODEL_ERRORS = (SpaceVLNError, ArithmeticError, LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError)
"""What a detector and its libraries raise over a request: its callers are told, and the next request is served.
Anything else is a bug, after which nothing is known of the detector."""


@dataclass(frozen=True, slots=True, eq=False)
class _Request(Generic[Seen]):
    images: Sequence[Seen]
    phrases: tuple[str, ...]
    answer: Future[Found] = field(default_factory=Future)


class Batcher(Generic[Seen]):
    """Runs one detector in one thread for any number of callers.

    Nobody waits for company: a lone request goes through at once. Requests with the same phrases share a pass, the oldest first.

    Args:
        detect: what was found in each image, given the images and the phrases; called in that thread alone.
        max_images: of requests put together; a single larger request goes through alone.
    """

    def __init__(self, detect: Callable[[Sequence[Seen], Sequence[str]], Found], max_images: int = 12) -> None:
        self._detect, self._max_images = detect, max_images
        self._waiting: deque[_Request[Seen]] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self._at_work: list[_Request[Seen]] = []
        self._thread = threading.Thread(target=self._work, name="detector", daemon=True)
        self._thread.start()

    def submit(self, images: Sequence[Seen], phrases: Sequence[str]) -> Future[Found]:
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

    @property
    def is_alive(self) -> bool:
        """Whether requests are still served."""
        return self._thread.is_alive() and not self._closed

    def _work(self) -> None:
        try:
            while requests := self._next():
                self._serve(requests)
        finally:  # nobody waits for ever, though a bug ends the thread
            self._abandon()

    def _serve(self, requests: Sequence[_Request[Seen]]) -> None:
        images = [image for request in requests for image in request.images]
        try:
            found = self._detect(images, requests[0].phrases)
        except MODEL_ERRORS as error:
            for request in requests:
                request.answer.set_exception(error)
            return
        at = 0
        for request in requests:
            request.answer.set_result(found[at : at + len(request.images)])
            at += len(request.images)

    def _abandon(self) -> None:
        with self._changed:
            self._closed = True
            left = [request for request in (*self._at_work, *self._waiting) if not request.answer.done()]
            self._waiting.clear()
        for request in left:
            request.answer.set_exception(EnvironmentFailure("The detector ended by a bug: see the traceback in its log."))

    def _next(self) -> list[_Request[Seen]]:
        """The oldest request and what may go along with it; empty when all is done."""
        with self._changed:
            while not self._waiting and not self._closed:
                self._changed.wait()
            if not self._waiting:
                return []
            self._at_work = chosen = [self._waiting.popleft()]
            count = len(chosen[0].images)
            for request in tuple(self._waiting):
                if request.phrases == chosen[0].phrases and count + len(request.images) <= self._max_images:
                    self._waiting.remove(request)
                    chosen.append(request)
                    count += len(request.images)
            return chosen
