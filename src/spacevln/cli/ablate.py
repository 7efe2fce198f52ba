"""``spacevln ablate``: the nine rows of the paper's Table 4 on a suite."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.bench import Progress, placed, run_options
from spacevln.cli.data_options import data_options, selection_from
from spacevln.cli.habitat_options import habitat_options
from spacevln.cli.model_options import access_from
from spacevln.cli.options import agent_options, configuration_from

if TYPE_CHECKING:
    from spacevln.assembly import Configuration


@click.command()
@click.argument("suite")
@data_options
@run_options
@habitat_options
@agent_options
def ablate(suite: str, workers: int, deadline: float | None, level: str, out: Path | None, **options: Any) -> None:
    """Run SUITE with each of the paper's nine presets and print its Table 4; the same command on the same --out resumes."""
    from spacevln.assembly import ABLATIONS
    from spacevln.cli.output import describe_run, prepare
    from spacevln.evaluation.runner import Job, bench, claim_directory
    from spacevln.evaluation.runs import read_run
    from spacevln.evaluation.tables import build_table, render
    from spacevln.recording import RecordLevel

    selection = selection_from(suite, options)
    base = placed(configuration_from(options), selection, options)
    if base.components != ABLATIONS["full"]:
        raise click.UsageError("`ablate` goes through the presets itself: leave --preset and --without out.")
    episodes = selection.load()
    home = prepare(out)
    presets, same = distinct_presets(base)
    for name, configuration in presets.items():
        directory = prepare(home / _folder(name))
        claim_directory(directory, describe_run(selection.name, configuration, episodes.source))
        job = Job(selection, configuration, directory, RecordLevel(level), access_from(options, directory))
        click.echo(f"preset   {name}")
        progress = Progress(len(episodes))
        with progress:
            bench(job, workers, progress.add, deadline_s=deadline)
    order = sorted(presets, key=lambda name: name == "full")  # the full pipeline comes last, as in the paper
    runs = [read_run(str(home / _folder(name))) for name in order]
    click.echo(render(build_table(runs, "ablation"), "md", intervals=True), nl=False)
    for name, other in same.items():
        click.echo(f"- {name}: does not apply, as rules have no reasoning text; it is the same program as {other}")
    click.echo(f"record   {home}")


def distinct_presets(base: Configuration) -> tuple[dict[str, Configuration], dict[str, str]]:
    """Configurations of the presets, and presets that are the same program as another because rules reason.

    Args:
        base: everything but the components.

    Returns:
        Configuration by preset, and for each left out the preset that it equals.
    """
    from spacevln.assembly import ABLATIONS

    presets: dict[str, Configuration] = {}
    same: dict[str, str] = {}
    seen: dict[str, str] = {}
    for name, components in ABLATIONS.items():
        without_text = {"planner_scot": base.planner == "rules", "executor_scot": base.executor == "rules"}
        told = components.model_copy(update={field: True for field, rules in without_text.items() if rules})
        key = told.model_dump_json()
        if key in seen:
            same[name] = seen[key]
        else:
            seen[key] = name
            presets[name] = base.model_copy(update={"components": told})
    return presets, same


def _folder(preset: str) -> str:
    return preset.replace("-", "without-", 1) if preset.startswith("-") else preset
