"""``spacevln bench``: a suite, in parallel, resumable."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.options import Driver, agent_options, configuration_from

if TYPE_CHECKING:
    from spacevln.recording import ResultFile


def _seed_range(_context: click.Context, _parameter: click.Parameter, value: str | None) -> tuple[int, int] | None:
    """Parse ``A:B``, half open."""
    if value is None:
        return None
    first, colon, last = value.partition(":")
    if not (colon and first.isdigit() and last.isdigit() and int(first) < int(last)):
        raise click.BadParameter(f"{value!r} is no range of seeds: give A:B with 0 <= A < B, e.g. 0:100.")
    return int(first), int(last)


@click.command()
@click.argument("suite")
@click.option("--split", default=None, help="Of the suite; by default test of the houses suites, val_unseen of R2R-CE and so on.")
@click.option(
    "--seeds",
    callback=_seed_range,
    metavar="A:B",
    default=None,
    help="One fresh episode of each house seed A..B-1 instead of the split.",
)
@click.option(
    "--driver",
    type=click.Choice(["agent", "random", "forward", "oracle"]),
    default="agent",
    show_default=True,
    help="The agent, or a baseline.",
)
@click.option(
    "--probe", type=click.Choice(["none", "swapped", "last-noun"]), default="none", help="Another instruction: does it matter?"
)
@click.option("--episodes", type=click.IntRange(min=1), default=None, help="Only the first so many.")
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
@click.option("--level", type=click.Choice(["light", "full"]), default="light", show_default=True, help="How much is recorded.")
@agent_options
def bench(
    suite: str,
    split: str | None,
    seeds: tuple[int, int] | None,
    episodes: int | None,
    workers: int,
    level: str,
    driver: Driver,
    probe: str,
    out: Path | None,
    **options: Any,
) -> int:
    """Run SUITE (houses-vln or houses-objectnav); the same command on the same --out resumes."""
    from spacevln.cli.output import describe_run, prepare
    from spacevln.core import PrerequisiteError
    from spacevln.evaluation.datasets import BENCHMARKS, Selection
    from spacevln.evaluation.runner import Job, claim_directory
    from spacevln.evaluation.runner import bench as run_suite
    from spacevln.recording import RecordLevel

    if suite in BENCHMARKS:
        raise PrerequisiteError(
            f"Suite {suite!r} needs the Habitat bridge, which this version does not have yet: use houses-vln or houses-objectnav."
        )
    configuration = configuration_from(options, driver)
    selection = Selection.model_validate({"suite": suite, "split": split, "seeds": seeds, "episodes": episodes, "probe": probe})
    total = len(selection.load())
    directory = prepare(out)
    claim_directory(directory, describe_run(selection.name, configuration))
    job = Job(selection, configuration, directory, RecordLevel(level))
    progress = _Progress(total)
    with progress:
        summary = run_suite(job, workers, progress.add)
    click.echo(_table(summary.metrics, progress.results))
    click.echo(f"statuses {', '.join(f'{name} {count}' for name, count in summary.statuses.items())}")
    click.echo(f"rejections {summary.rejections}, fallbacks {summary.fallbacks}, unreachable {summary.unreachable}")
    click.echo(f"record   {directory}")
    failed = {"model_failure", "environment_failure", "safety"} & set(summary.statuses)
    return 1 if failed else 0


class _Progress:
    """A bar with the success so far and the time left; plain lines where there is no terminal."""

    def __init__(self, total: int) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        self.results: list[ResultFile] = []
        self._bar = Progress(
            TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), transient=True
        )
        self._task = self._bar.add_task("starting", total=total)

    def __enter__(self) -> None:
        self._bar.start()

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def add(self, result: ResultFile) -> None:
        """Count a result."""
        self.results.append(result)
        judged = [each.metrics.SR for each in self.results if each.metrics.SR is not None]
        share = f"SR {100 * sum(judged) / len(judged):.0f} %" if judged else "running"
        self._bar.update(self._task, advance=1, description=share)


def _table(metrics: dict[str, float | None], results: list[ResultFile]) -> str:
    from spacevln.evaluation.summary import bootstrap_interval

    lines = []
    for name, unit in (("SR", "%"), ("SPL", "%"), ("OSR", "%"), ("nDTW", "%"), ("NE", "m"), ("steps", ""), ("stages", "")):
        value = metrics.get(name)
        if value is None:
            continue
        scale = 100.0 if unit == "%" else 1.0
        values = [getattr(result.metrics, name) for result in results]
        low, high = bootstrap_interval([scale * each for each in values if each is not None])
        lines.append(f"{name:8s} {value:6.1f} {unit:1s}  [{low:.1f}, {high:.1f}]")
    return "\n".join(lines)
