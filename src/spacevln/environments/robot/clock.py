"""Time as a value that can be simulated: everything in this package that waits or measures takes a :class:`Clock`."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """Two times and a wait."""

    def now_s(self) -> float:
        """Steady seconds, for durations and time-outs."""

    def stamp_ns(self) -> int:
        """Time of day, comparable with the stamps of messages [ns]."""

    def sleep(self, duration_s: float) -> None:
        """Wait."""


class SystemClock:
    """The machine's own."""

    def now_s(self) -> float:
        """Steady seconds."""
        return time.monotonic()

    def stamp_ns(self) -> int:
        """Time of day [ns]."""
        return time.time_ns()

    def sleep(self, duration_s: float) -> None:
        """Wait."""
        time.sleep(duration_s)
