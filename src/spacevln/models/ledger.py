"""What all workers of a run share: one rate limit and one purse, in a small SQLite file of the run directory."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from spacevln.core import RecordError, SpendingLimit

LOCK_S = 60.0
_TABLES = """
CREATE TABLE IF NOT EXISTS gate (one INTEGER PRIMARY KEY CHECK (one = 1), next_s REAL NOT NULL, paused_until_s REAL NOT NULL);
CREATE TABLE IF NOT EXISTS purse (one INTEGER PRIMARY KEY CHECK (one = 1), usd REAL NOT NULL);
INSERT OR IGNORE INTO gate VALUES (1, 0, 0);
INSERT OR IGNORE INTO purse VALUES (1, 0);
"""


class RunLedger:
    """Shared by every worker of a run, whatever its process.

    Args:
        path: of the file; None keeps it in memory, for one process.
        requests_per_minute: limit over all workers; None = none of ours.
        max_usd: what the run may spend, earlier calls of a resumed run included; None = no limit.
        clock: seconds since the epoch, the same for all processes.

    Raises:
        RecordError: the file cannot be opened.
    """

    def __init__(
        self,
        path: Path | None = None,
        *,
        requests_per_minute: float | None = None,
        max_usd: float | None = None,
        clock: Callable[[], float] = time.time,
    ) -> None:
        self._interval_s = 60.0 / requests_per_minute if requests_per_minute else 0.0
        self._max_usd = max_usd
        self._clock = clock
        self._lock = threading.Lock()  # a hedged request comes from another thread
        try:
            self._base = sqlite3.connect(path or ":memory:", timeout=LOCK_S, isolation_level=None, check_same_thread=False)
            self._base.executescript(_TABLES)
        except sqlite3.Error as error:
            raise RecordError(f"Cannot open the run's ledger {str(path)!r} ({error}): give a writable --out.") from error

    def close(self) -> None:
        """Close the file. May be called twice."""
        with self._lock:
            self._base.close()

    def reserve(self) -> float:
        """Take the next free place among the requests of all workers; seconds to wait until then."""
        with self._change() as base:
            next_s, paused_until_s = base.execute("SELECT next_s, paused_until_s FROM gate").fetchone()
            now_s = self._clock()
            start_s = max(now_s, next_s, paused_until_s)
            base.execute("UPDATE gate SET next_s = ?", (start_s + self._interval_s,))
        return float(start_s - now_s)

    def pause(self, seconds: float) -> None:
        """No worker sends a request for so long: the server said that we are too many."""
        with self._change() as base:
            base.execute("UPDATE gate SET paused_until_s = max(paused_until_s, ?)", (self._clock() + seconds,))

    @property
    def spent_usd(self) -> float:
        """By all workers, since the run began."""
        with self._lock:
            return float(self._base.execute("SELECT usd FROM purse").fetchone()[0])

    def spend(self, usd: float) -> None:
        """Note what a call cost."""
        with self._change() as base:
            base.execute("UPDATE purse SET usd = usd + ?", (usd,))

    def check(self) -> None:
        """Called before each call.

        Raises:
            SpendingLimit: the run has spent what it may.
        """
        if self._max_usd is not None and self.spent_usd >= self._max_usd:
            raise SpendingLimit(
                f"The run has spent {self.spent_usd:.4f} USD of --max-usd {self._max_usd:g}: "
                "run the same command with a larger one to resume."
            )

    @contextmanager
    def _change(self) -> Iterator[sqlite3.Connection]:
        with self._lock:
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield self._base
            except BaseException:
                self._base.execute("ROLLBACK")
                raise
            self._base.execute("COMMIT")
