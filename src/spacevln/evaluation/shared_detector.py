"""A detector that several workers of a Ray cluster share: one actor holds it and asks it in batches."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from spacevln.assembly import Configuration, build_detector
from spacevln.core import Detection, Observation
from spacevln.perception.serving.batching import Batcher

MAX_BATCH_IMAGES = 24
"""Images of one call: two look-arounds."""


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


class DetectorActor:
    """Body of a shared detector on a node: what waits while it works, and has the same queries, is its next batch.

    Args:
        configuration: in JSON; names the detector.
    """

    def __init__(self, configuration: str) -> None:
        detector = build_detector(Configuration.model_validate_json(configuration))
        self._batcher = Batcher(detector.detect, MAX_BATCH_IMAGES)

    async def detect(self, observations: list[Observation], queries: tuple[str, ...]) -> list[tuple[Detection, ...]]:
        """As :meth:`spacevln.core.Detector.detect`, for any number of callers."""
        return await asyncio.wrap_future(self._batcher.submit(observations, queries))
