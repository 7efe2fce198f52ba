"""Turn oscillation (appendix "Action-space constraints", N_turn)."""

from __future__ import annotations

from enum import Enum

from spacevln.core import ExecutedDecision, TurnLeft, TurnRight


class Side(Enum):
    """Side of a turn."""

    LEFT = "left"
    RIGHT = "right"


class TurnMonitor:
    """Counts turn decisions in a row and remembers the side of the last one.

    Forward motion of at least ``effective_m`` clears both. A stalled forward clears neither: the body stands where it stood.

    Args:
        limit: N_turn.
        effective_m: least displacement that counts as motion [m].
    """

    def __init__(self, limit: int, effective_m: float) -> None:
        self._limit = limit
        self._effective_m = effective_m
        self._in_a_row = 0
        self._last: Side | None = None

    def observe(self, decision: ExecutedDecision) -> None:
        """Take note of a decision that was carried out."""
        match decision.asked:
            case TurnLeft():
                self._in_a_row, self._last = self._in_a_row + 1, Side.LEFT
            case TurnRight():
                self._in_a_row, self._last = self._in_a_row + 1, Side.RIGHT
            case _ if decision.moved_m >= self._effective_m:
                self._in_a_row, self._last = 0, None

    @property
    def exhausted(self) -> bool:
        """Whether N_turn turns in a row were made: only forward or STOP is left."""
        return self._in_a_row >= self._limit

    @property
    def reversal(self) -> Side | None:
        """The side that would only undo the last turn, if the last motion was a turn."""
        if self._last is None:
            return None
        return Side.RIGHT if self._last is Side.LEFT else Side.LEFT
