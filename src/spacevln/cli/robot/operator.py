"""The operator at the keyboard: space stops, r resumes; in confirm mode every stage is asked for."""

from __future__ import annotations

import select
import sys
import termios
import threading
import time
import tty
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

import click

from spacevln.core import Event, SubtaskIssued, UsageError
from spacevln.environments.robot.guard.status import GuardState, WheelLink

_POLL_S = 0.1
_RESUMED_S = 2.0


class OperatorKeys:
    """Reads single keys while a robot drives; does nothing where there is no terminal."""

    def __init__(self, link: WheelLink) -> None:
        self._link, self._ended = link, threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._saved: list[Any] | None = None

    def __enter__(self) -> Self:
        if sys.stdin.isatty():
            self._saved = termios.tcgetattr(sys.stdin)
            tty.setcbreak(sys.stdin)  # Ctrl-C still interrupts
            click.echo("keys     space: stop, r: resume, Ctrl-C: end")
            self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._ended.set()
        if self._saved is not None:
            self._thread.join()
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._saved)

    def _read(self) -> None:
        words = {" ": "stop", "r": "resume"}
        while not self._ended.is_set():
            ready, _, _ = select.select([sys.stdin], [], [], _POLL_S)
            word = words.get(sys.stdin.read(1)) if ready else None
            if word is not None and self._link.status().state is not GuardState.ENDED:
                self._link.operate(word)


class StageConfirmation:
    """An event sink that holds the wheels until the operator approves of the stage; a refused one leaves them stopped.

    Args:
        link: to the guard.
        ask: puts the question.
    """

    def __init__(self, link: WheelLink, ask: Callable[[str], bool] = click.confirm) -> None:
        self._link, self._ask = link, ask

    def emit(self, event: Event) -> None:
        """Ask about a new subtask."""
        if not isinstance(event, SubtaskIssued) or event.subtask.complete:
            return
        self._link.operate("stop")
        subtask = event.subtask
        goal = subtask.next_anchor.space if subtask.next_anchor is not None else "the goal"
        if self._ask(f"stage {event.stage}: {subtask.direction}, to {goal}: {subtask.instruction}; go?"):
            self._link.operate("resume")
            end_s = time.monotonic() + _RESUMED_S
            while self._link.status().state is GuardState.STOPPED and time.monotonic() < end_s:
                time.sleep(_POLL_S / 10)  # until the guard's report says so


def require_terminal() -> None:
    """Confirm mode asks.

    Raises:
        UsageError: nobody can answer.
    """
    if not sys.stdin.isatty():
        raise UsageError("--confirm asks the operator before every stage and needs a terminal: run it in one, or leave it out.")
