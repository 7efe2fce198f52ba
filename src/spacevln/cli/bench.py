"""``spacevln bench``: a suite, in parallel, resumable."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.attempting import FAILED_STATUSES, attempt_all, run_options
from spacevln.cli.costs import usage_line
from spacevln.cli.data_options import data_options, selection_from
from spacevln.cli.forecast import forecast_options, tell_forecast
from spacevln.cli.habitat_options import habitat_options, in_simulator
from spacevln.cli.options import Driver, agent_options, configuration_from

if TYPE_CHECKING:
    from spacevln.assembly import Configuration
    from spacevln.evaluation.datasets import Selection
    from spacevln.recording import ResultFile, SummaryFile


@click.command()
@click.argument("suite")
@data_options
@click.option(
    "--driver",
    type=click.Choice(["agent", "random", "forward", "frontier", "oracle", "reference"]),
    default="agent",
    show_default=True,
    help="The agent, or a baseline.",
)
@run_options
@habitat_options
@forecast_options
@agent_options
def bench(suite: str, driver: Driver, out: Path | None, **options: Any) -> int:
    """Run SUITE (houses-vln, houses-objectnav, r2r-ce, rxr-ce, hm3d-ovon, gn-bench); the same command and --out resume."""
    from spacevln.cli.output import prepare
    from spacevln.viewer import write_site

    selection = selection_from(suite, options)
    configuration = configuration_from(options, driver)
    if options["habitat_python"] is not None or not options["dry_run"]:  # a forecast needs no simulator
        configuration = placed(configuration, selection, options)
    episodes = selection.load()
    for note in episodes.notes:
        click.echo(f"data     {note}")
    if options["dry_run"]:
        tell_forecast(configuration, episodes, out, options["workers"], options["forecast_from"])
        return 0
    directory = prepare(out)
    summary, results = attempt_all(selection, configuration, episodes, directory, options)
    tell(summary, results)
    click.echo(f"record   {directory}")
    click.echo(f"pages    {write_site(directory, missing_only=True)}")
    return 1 if FAILED_STATUSES & set(summary.statuses) else 0


def placed(configuration: Configuration, selection: Selection, options: dict[str, Any]) -> Configuration:
    """The configuration in the world that the suite needs.

    Raises:
        PrerequisiteError: that world is not here.
    """
    from spacevln.assembly import LabelDetectorSettings
    from spacevln.evaluation.datasets import HOUSES_SUITES

    if selection.suite in HOUSES_SUITES:
        if options["habitat_python"] is not None:
            raise click.UsageError(f"Suite {selection.suite!r} runs in the embedded houses: leave --habitat-python out.")
        return configuration
    if options["chase"]:
        raise click.UsageError("--chase films the robot of the embedded houses: leave it out.")
    sees = configuration.driver in ("agent", "frontier")
    if selection.suite == "gn-bench" and sees and isinstance(configuration.detector, LabelDetectorSettings):
        raise click.UsageError("GN-Bench's pictures have no labels: add e.g. --detector grounding-dino-tiny.")
    said = click.get_current_context().get_parameter_source("sliding")
    given = said is not None and said.name != "DEFAULT"
    return in_simulator(configuration, selection.suite, options, sliding=options["sliding"] if given else None)


def tell(summary: SummaryFile, results: list[ResultFile]) -> None:
    """Print the metrics of a run with their intervals, and how its episodes ended."""
    from spacevln.evaluation.statistics import interval

    for name, unit in (("SR", "%"), ("SPL", "%"), ("OSR", "%"), ("nDTW", "%"), ("NE", "m"), ("steps", ""), ("stages", "")):
        value = summary.metrics.get(name)
        if value is None:
            continue
        scale = 100.0 if unit == "%" else 1.0
        values = [getattr(result.metrics, name) for result in results]
        found = interval([scale * each for each in values if each is not None])
        spread = "" if found.low is None or found.high is None else f"  [{found.low:.1f}, {found.high:.1f}]"
        click.echo(f"{name:8s} {value:6.1f} {unit:1s}{spread}")
    click.echo(f"statuses {', '.join(f'{name} {count}' for name, count in summary.statuses.items())}")
    click.echo(f"rejections {summary.rejections}, fallbacks {summary.fallbacks}, unreachable {summary.unreachable}")
    if summary.usage:
        click.echo(usage_line(summary.usage))
