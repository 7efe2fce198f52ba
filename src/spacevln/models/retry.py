"""The one place where calls are tried again (DESIGN 5.5)."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from spacevln.core import ModelError
from spacevln.models.choice import RetrySettings
from spacevln.models.endpoint import CallFailed
from spacevln.models.ledger import RunLedger

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Timing:
    """Clock, sleeper and dice; tests bring their own.

    Args:
        clock: seconds, monotonic.
        sleep: waits so many seconds.
        rng: of the jitter; never touches what the agent does.
    """

    clock: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep
    rng: np.random.Generator = field(default_factory=np.random.default_rng)


@dataclass(frozen=True, slots=True)
class Retried:
    """An attempt that failed and is made again.

    Args:
        attempt: its number, from 1.
        wait_s: pause before the next.
    """

    attempt: int
    failure: CallFailed
    wait_s: float


@dataclass(frozen=True, slots=True)
class Retrier(Generic[T]):
    """Sends a request until it is answered, within the bounds of :class:`RetrySettings`.

    What is never tried again: anything that the server refuses for what it is (HTTP 400, 401, 403, 404, 422 ...) and an exhausted
    quota or balance. A rate limit pauses every worker of the run.
    """

    settings: RetrySettings
    ledger: RunLedger
    timing: Timing = field(default_factory=Timing)

    def run(self, ask: Callable[[float], T], on_retry: Callable[[Retried], None]) -> tuple[T, int]:
        """The answer and the number of attempts.

        Args:
            ask: one request, given the seconds it may take.
            on_retry: told of every failure that is tried again.

        Raises:
            CallFailed: it is of a kind that is never retried.
            ModelError: attempts or time ran out.
        """
        deadline = self.timing.clock() + self.settings.total_s
        for attempt in range(1, self.settings.attempts + 1):
            self._take_turn(deadline)
            left_s = deadline - self.timing.clock()
            try:
                return self._hedged(ask, min(self.settings.attempt_s, left_s)), attempt
            except CallFailed as failure:
                if not failure.retryable:
                    raise
                wait_s = self._wait(attempt, failure)
                last = f"the last because of {failure.kind}: {failure.detail}"
                if attempt == self.settings.attempts:
                    many = "The request" if attempt == 1 else f"All {attempt} requests"
                    raise ModelError(f"{many} to the model failed, {last}.") from failure
                if self.timing.clock() + wait_s >= deadline:
                    raise ModelError(
                        f"The model gave no reply within {round(self.settings.total_s, 1):g} s ({attempt} requests, {last})."
                    ) from failure
                on_retry(Retried(attempt, failure, wait_s))
                self.timing.sleep(wait_s)
        raise AssertionError("RetrySettings.attempts is positive")

    def _take_turn(self, deadline: float) -> None:
        wait_s = self.ledger.reserve()
        if self.timing.clock() + wait_s >= deadline:
            raise ModelError(
                f"The run's rate limit leaves no place for this request within {round(self.settings.total_s, 1):g} s: "
                "raise --requests-per-minute or use fewer --workers."
            )
        if wait_s > 0:
            self.timing.sleep(wait_s)

    def _wait(self, attempt: int, failure: CallFailed) -> float:
        if failure.retry_after_s is not None:
            self.ledger.pause(failure.retry_after_s)
            return failure.retry_after_s
        base_s: float = min(self.settings.first_wait_s * 2 ** (attempt - 1), self.settings.longest_wait_s)
        return base_s * (1 + self.settings.jitter * float(self.timing.rng.uniform(-1, 1)))

    def _hedged(self, ask: Callable[[float], T], timeout_s: float) -> T:
        """One attempt; with ``hedge_after_s`` a second request joins a slow first, and the first reply counts."""
        hedge_after_s = self.settings.hedge_after_s
        if hedge_after_s is None or hedge_after_s >= timeout_s:
            return ask(timeout_s)
        pool = ThreadPoolExecutor(max_workers=2, thread_name_prefix="hedge")
        try:
            first = pool.submit(ask, timeout_s)
            done, _ = wait([first], timeout=hedge_after_s)
            if done:
                return first.result()
            return _first_reply({first, pool.submit(ask, timeout_s - hedge_after_s)})
        finally:
            pool.shutdown(wait=False)  # a late reply is billed by its own thread and otherwise dropped


def _first_reply(running: set[Future[T]]) -> T:
    failure: CallFailed | None = None
    while running:
        done, running = wait(running, return_when=FIRST_COMPLETED)
        for future in done:
            try:
                return future.result()
            except CallFailed as error:
                failure = error
    assert failure is not None  # noqa: S101 - every future ended by failing
    raise failure
