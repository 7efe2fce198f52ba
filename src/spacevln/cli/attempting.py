"""Attempting the episodes of a suite, as ``bench`` and ``ablate`` do: options, workers, progress."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.model_options import access_from
from spacevln.cli.option_groups import option_group

if TYPE_CHECKING:
    from spacevln.assembly import Configuration
    from spacevln.evaluation.datasets import EpisodeSequence, Selection
    from spacevln.evaluation.pool import Workplace
    from spacevln.recording import ResultFile, SummaryFile

FAILED_STATUSES = frozenset({"model_failure", "environment_failure", "safety"})
"""Statuses that make a run's exit code 1 (DESIGN 5.10)."""

run_options = option_group(
    click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="How many run side by side."),
    click.option(
        "--deadline",
        type=click.FloatRange(min=0, min_open=True),
        default=None,
        metavar="S",
        help="A worker that takes longer for an episode is killed, which counts as its death.",
    ),
    click.option(
        "--level", type=click.Choice(["light", "full"]), default="light", show_default=True, help="How much is recorded."
    ),
    click.option(
        "--ray", "ray_address", default=None, metavar="ADDRESS", help="Workers on a Ray cluster: HOST:PORT, auto or local."
    ),
    click.option(
        "--ray-detectors",
        type=click.IntRange(min=1),
        default=None,
        metavar="N",
        help="N detectors on the cluster, shared by its workers, instead of one in each.",
    ),
)
"""How a suite is run."""


def attempt_all(
    selection: Selection, configuration: Configuration, episodes: EpisodeSequence, directory: Path, options: dict[str, Any]
) -> tuple[SummaryFile, list[ResultFile]]:
    """Attempt every episode that has no result in ``directory`` yet; the summary, and all results.

    Raises:
        UsageError: the directory belongs to another run.
    """
    from spacevln.cli.output import describe_run
    from spacevln.evaluation.runner import Job, bench, claim_directory
    from spacevln.recording import RecordLevel

    workplace = _workplace(configuration, options)
    claim_directory(directory, describe_run(selection.name, configuration, episodes.source))
    level, access = RecordLevel(options["level"]), access_from(options, directory)
    job = Job(selection, configuration, directory, level, access, options["chase"])
    progress = Progress(len(episodes))
    with progress:
        summary = bench(job, options["workers"], progress.add, deadline_s=options["deadline"], workplace=workplace)
    return summary, progress.results


def _workplace(configuration: Configuration, options: dict[str, Any]) -> Workplace | None:
    """Where workers live; None for processes of this machine."""
    address, detectors = options["ray_address"], options["ray_detectors"]
    if address is None:
        if detectors is not None:
            raise click.UsageError("--ray-detectors needs --ray: give the cluster's address.")
        return None
    from spacevln.evaluation.ray_cluster import RayCluster, require_ray

    require_ray()
    return RayCluster(address, configuration, detectors or 0)


LINE_EVERY_S = 30.0
"""Where there is no terminal, progress is a line so often."""


class Progress:
    """How far a run is, its success and cost so far, and the time left: a bar, or plain lines where there is no terminal."""

    def __init__(self, total: int) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        self.results: list[ResultFile] = []
        self._total = total
        self._old = 0
        self._begun_s = self._told_s = time.monotonic()
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        self._bar = Bar(*columns, transient=True)
        self._task = self._bar.add_task("starting", total=total)

    def __enter__(self) -> None:
        if self._bar.console.is_terminal:
            self._bar.start()

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def add(self, result: ResultFile) -> None:
        """Count a result."""
        self.results.append(result)
        judged = [each.metrics.SR for each in self.results if each.metrics.SR is not None]
        words = [f"SR {100 * sum(judged) / len(judged):.0f} %" if judged else "running"]
        usd = sum(part.usd for each in self.results for part in each.usage.values())
        words += [f"{usd:.2f} USD"] if usd else []
        self._bar.update(self._task, advance=1, description=", ".join(words))
        if not self._bar.console.is_terminal:
            self._tell(", ".join(words))

    def _tell(self, words: str) -> None:
        now = time.monotonic()
        done = len(self.results)
        if now - self._begun_s < 1.0:  # results of an earlier call are counted at once
            self._old = done
        elif now - self._told_s >= LINE_EVERY_S:
            self._told_s = now
            left_s = (now - self._begun_s) * (self._total - done) / (done - self._old)
            click.echo(f"progress {done} of {self._total}, {words}, {left_s / 60:.0f} min left")
