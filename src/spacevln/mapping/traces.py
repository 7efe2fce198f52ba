"""Where the agent was: the whole episode, and the current stage as its tail."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]


class Trace:
    """A growing list of (x, y, floor), shape (N, 3); memory doubles when it is full."""

    def __init__(self) -> None:
        self._rows = np.empty((64, 3))
        self._count = 0
        self.stage_from = 0

    @classmethod
    def restored(cls, rows: Float, stage_from: int) -> Trace:
        """A trace with these places (N, 3), its stage begun at the given one."""
        trace = cls()
        trace._rows, trace._count, trace.stage_from = np.array(rows, np.float64).reshape(-1, 3), len(rows), stage_from
        return trace

    def __len__(self) -> int:
        return self._count

    def append(self, x_m: float, y_m: float, floor: int) -> None:
        """Add a place; a repeated one (a turn) is dropped."""
        if self._count and np.array_equal(self._rows[self._count - 1], (x_m, y_m, floor)):
            return
        if self._count == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty((max(64, self._count), 3))])
        self._rows[self._count] = x_m, y_m, floor
        self._count += 1

    def relabel(self, first: int, floor: int) -> None:
        """The places from the given one on turn out to lie on a floor."""
        self._rows[first : self._count, 2] = floor

    def start_stage(self) -> None:
        """The stage trace begins anew at the last place."""
        self.stage_from = max(0, self._count - 1)

    @property
    def episode(self) -> Float:
        """Every place (N, 3): x, y [m], floor."""
        return self._rows[: self._count]

    @property
    def stage(self) -> Float:
        """Places of the current stage (N, 3)."""
        return self._rows[self.stage_from : self._count]

    @property
    def nbytes(self) -> int:
        """Bytes held."""
        return self._rows.nbytes
