"""What ``spacevln bench --dry-run`` prints."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from spacevln.assembly import Configuration
    from spacevln.evaluation.datasets import EpisodeSequence

F = TypeVar("F", bound=Callable[..., Any])


def forecast_options(command: F) -> F:
    """Whether to say what a run will take instead of running."""
    source = click.option(
        "--forecast-from",
        type=click.Path(path_type=Path, exists=True, file_okay=False),
        default=None,
        metavar="RUN",
        help="A recorded run to learn the averages from.",
    )
    dry = click.option("--dry-run", is_flag=True, help="Say what it will take: calls, tokens, USD, hours; run nothing.")
    return dry(source(command))


def tell_forecast(
    configuration: Configuration, episodes: EpisodeSequence, directory: Path | None, workers: int, source: Path | None
) -> None:
    """Print what the episodes that have no result yet will take: calls, tokens, USD, hours.

    Args:
        configuration: of the run.
        episodes: of the suite.
        directory: of the run, where it was begun before.
        workers: side by side.
        source: a recorded run to learn averages from; None takes the package's.
    """
    from spacevln.core import Role
    from spacevln.evaluation.forecast import forecast, known_averages, recorded_averages
    from spacevln.recording import episode_directory, task_fields

    if directory is None:
        left = len(episodes)
    else:
        left = sum(not (episode_directory(directory, name) / "result.json").exists() for name in episodes.ids)
    click.echo(f"episodes {left} to run of {len(episodes)}, {workers} at a time")
    models = configuration.models
    if models is None:
        click.echo("models   none are asked, so nothing is spent")
        return
    kinds = {Role.PLANNER: configuration.planner, Role.EXECUTOR: configuration.executor}
    choices = {role: choice for role, choice in models.choices.items() if kinds[role] == "vlm"}
    kind, _ = task_fields(episodes[0].spec.task)
    averages = known_averages(kind) if source is None else recorded_averages(source)
    expected = forecast(averages, choices, left, workers)
    for role, part in expected.roles.items():
        usage, usd = part.usage, "price not known" if part.usd is None else f"{part.usd:.2f} USD"
        click.echo(
            f"{role:8s} {part.calls:,.0f} calls to {part.model}: {usage.input_tokens / 1e6:.2f} M tokens in "
            f"({usage.cached_tokens / 1e6:.2f} cached), {usage.output_tokens / 1e6:.2f} M out, {usd}"
        )
    total = "not known: give --price IN/OUT or --usd-per-hour" if expected.usd is None else f"{expected.usd:.2f} USD"
    click.echo(f"cost     {total}")
    click.echo(f"time     {expected.hours:.1f} hours")
    click.echo(f"learnt   from {expected.source}")
