"""What the stamps of one stream tell: a message may be late for a moment; late for good, or early, it shows another clock."""

from __future__ import annotations

from collections import deque
from statistics import median

from spacevln.environments.robot.profile import Watchdog

LEARNT_S = 2.0
"""How long a stream is watched before its usual lateness is known: what starts is late."""
FOR_GOOD_S = 2.0
"""A busy network or machine is late for less."""
_REMEMBERED = 50


class Stamps:
    """Judges one stream.

    Args:
        watch: ``skew_s``, ``clock_jump_s``.
    """

    def __init__(self, watch: Watchdog) -> None:
        self._skew_s, self._jump_s = watch.skew_s, watch.clock_jump_s
        self._usual = deque[float](maxlen=_REMEMBERED)
        self._first_s: float | None = None
        self._late_since_s: float | None = None
        self.jumped = False

    def late_s(self, now_s: float, skew_s: float) -> float:
        """How much later than usual a message is that comes ``skew_s`` after its stamp [s]; 0 = in time."""
        self._first_s = now_s if self._first_s is None else self._first_s
        learnt = now_s - self._first_s >= LEARNT_S
        usual_s = (median(self._usual) if learnt else min(self._usual)) if self._usual else 0.0
        if skew_s < -self._skew_s or (learnt and skew_s < usual_s - self._jump_s):
            self.jumped = True  # no message comes before it was sent
        if skew_s <= min(usual_s + self._jump_s if self._usual else self._skew_s, self._skew_s):
            self._usual.append(skew_s)
            self._late_since_s = None
            return 0.0
        self._late_since_s = now_s if self._late_since_s is None else self._late_since_s
        self.jumped = self.jumped or now_s - self._late_since_s >= FOR_GOOD_S
        return skew_s - usual_s
