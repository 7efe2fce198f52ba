"""The live display of ``spacevln run``: an event sink that draws."""

from __future__ import annotations

import math
from types import TracebackType
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.spinner import Spinner
from rich.text import Text

from spacevln.core import (
    CallRetried,
    DecisionMade,
    EpisodeSpec,
    Event,
    FallbackUsed,
    InstructionTask,
    LandmarkPool,
    LookedAround,
    ReplyRefused,
    StageEnded,
    StepTaken,
    SubtaskIssued,
    describe,
    egocentric_label,
)


class EpisodeProgress:
    """Shows stage, subtask, step, action and landmark distance; one line per stage where there is no terminal."""

    def __init__(self, console: Console | None = None) -> None:
        self._console = console or Console(highlight=False)
        self._live = Live(console=self._console, refresh_per_second=8, transient=True)
        self._note = ""
        self._subtask = ""
        self._step = 0
        self._action = ""
        self._landmark = ""
        self._spinner = Spinner("dots")

    def __enter__(self) -> Self:
        self._live.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._live.stop()

    def say(self, note: str) -> None:
        """Show what is being prepared."""
        self._note = note
        self._draw()

    def begin(self, episode: EpisodeSpec) -> None:
        """Show the task."""
        kind = "instruction" if isinstance(episode.task, InstructionTask) else "goal"
        text = episode.task.instruction if isinstance(episode.task, InstructionTask) else episode.task.goal
        self._console.print(f"[bold]{episode.scene}[/bold]  {kind}: [italic]{_plain(text)}[/italic]")
        self._note = "looking around"
        self._draw()

    def emit(self, event: Event) -> None:
        """Take note of an event."""
        match event:
            case StepTaken(step=step, phase=phase, action=action):
                self._step = step
                self._action = describe(action)
                self._note = "looking around" if phase == "lookaround" else "driving"
            case SubtaskIssued(stage=stage, subtask=subtask):
                self._subtask = f"stage {stage + 1}: {subtask.instruction}" if not subtask.complete else "the task is done"
                self._landmark = ""
                self._print(f"  [cyan]{_plain(self._subtask)}[/cyan]")
            case DecisionMade(pool=pool):
                self._landmark = _nearest(pool)
            case StageEnded(feedback=feedback):
                self._print(f"    [dim]ended by {feedback.end.replace('_', ' ')} after {feedback.record.moved_m:.1f} m[/dim]")
            case ReplyRefused(role=role, reason=reason):
                self._print(f"    [yellow]{role} asked again: {_plain(reason)}[/yellow]")
            case LookedAround():
                self._note = "planning"
            case CallRetried(role=role, kind=kind, wait_s=wait_s):
                self._print(f"    [yellow]{role}: {kind.replace('_', ' ')}, next request in {wait_s:.1f} s[/yellow]")
            case FallbackUsed(kind=kind):
                self._print(f"    [yellow]fallback: {kind.replace('_', ' ')}[/yellow]")
            case _:
                return
        self._draw()

    def _print(self, text: str) -> None:
        self._console.print(text)

    def _draw(self) -> None:
        if not self._console.is_terminal:
            return
        status = f" {self._note}   step {self._step}   {self._action}   {self._landmark}"
        self._spinner.update(text=Text(status))
        self._live.update(Group(self._spinner))


def _nearest(pool: LandmarkPool) -> str:
    if not pool:
        return "landmark not seen"
    best = pool[0]
    where = egocentric_label(best.bearing_rad)
    distance = f"{best.distance_m:.1f} m" if math.isfinite(best.distance_m) else "?"
    return f"{best.category} {distance} {where}"


def _plain(text: str) -> str:
    """Text from outside, without rich's markup."""
    return text.replace("[", r"\[")
