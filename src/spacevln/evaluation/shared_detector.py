"""A detector that several workers of a Ray cluster share: one actor holds it and asks it in batches."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from spacevln.assembly import Configuration, build_detector
from spacevln.core import Detection, Detector, Observation

MAX_BATCH_IMAGES = 24
"""Images of one call: two look-arounds. A request is never split."""


@dataclass(frozen=True, slots=True)
class SharedDetector:
    """Implements :class:`spacevln.core.Detector` by asking an actor.

    Args:
        actor: handle of a :class:`DetectorActor`.
    """

    actor: Any

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        """See :meth:`spacevln.core.Detector.detect`."""
        import ray

        found: list[tuple[Detection, ...]] = ray.get(self.actor.detect.remote(list(observations), tuple(queries)))
        return found


@dataclass(frozen=True, slots=True)
class _Request:
    observations: list[Observation]
    queries: tuple[str, ...]
    answer: asyncio.Future[list[tuple[Detection, ...]]]


class Batcher:
    """Asks a detector for several callers: what came while it worked, and has the same queries, is its next batch.

    Args:
        detector: asked once at a time, in a thread.
    """

    def __init__(self, detector: Detector) -> None:
        self._detector = detector
        self._waiting: list[_Request] = []
        self._serving: asyncio.Task[None] | None = None

    async def detect(self, observations: list[Observation], queries: tuple[str, ...]) -> list[tuple[Detection, ...]]:
        """As :meth:`spacevln.core.Detector.detect`."""
        request = _Request(observations, queries, asyncio.get_running_loop().create_future())
        self._waiting.append(request)
        if self._serving is None or self._serving.done():
            self._serving = asyncio.create_task(self._serve())
        return await request.answer

    async def _serve(self) -> None:
        while self._waiting:
            batch = self._next_batch()
            images = [image for request in batch for image in request.observations]
            try:
                found = await asyncio.to_thread(self._detector.detect, images, batch[0].queries)
            except Exception as error:  # noqa: BLE001 - every caller gets it, as if it had asked alone
                for request in batch:
                    request.answer.set_exception(error)
                continue
            rest = iter(found)
            for request in batch:
                request.answer.set_result([next(rest) for _ in request.observations])

    def _next_batch(self) -> list[_Request]:
        """The first that waits, and those with its queries while they fit."""
        first = self._waiting[0]
        batch, count = [first], len(first.observations)
        left: list[_Request] = []
        for request in self._waiting[1:]:
            fits = request.queries == first.queries and count + len(request.observations) <= MAX_BATCH_IMAGES
            (batch if fits else left).append(request)
            count += len(request.observations) if fits else 0
        self._waiting = left
        return batch


class DetectorActor(Batcher):
    """Body of a shared detector on a node.

    Args:
        configuration: in JSON; names the detector.
    """

    def __init__(self, configuration: str) -> None:
        super().__init__(build_detector(Configuration.model_validate_json(configuration)))
