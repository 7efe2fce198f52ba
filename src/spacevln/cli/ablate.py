"""``spacevln ablate``: the nine rows of the paper's Table 4 on a suite."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from spacevln.cli.attempting import attempt_all, run_options
from spacevln.cli.bench import placed
from spacevln.cli.data_options import data_options, selection_from
from spacevln.cli.habitat_options import habitat_options
from spacevln.cli.options import agent_options, configuration_from


@click.command()
@click.argument("suite")
@data_options
@run_options
@habitat_options
@agent_options
def ablate(suite: str, out: Path | None, **options: Any) -> None:
    """Run SUITE with each of the paper's nine presets and print its Table 4; the same command on the same --out resumes."""
    from spacevln.assembly import ABLATIONS, same_programs
    from spacevln.cli.output import prepare
    from spacevln.evaluation.runs import read_run
    from spacevln.evaluation.tables import build_table, render

    selection = selection_from(suite, options)
    base = placed(configuration_from(options), selection, options)
    if base.components != ABLATIONS["full"]:
        raise click.UsageError("`ablate` goes through the presets itself: leave --preset and --without out.")
    episodes = selection.load()
    home = prepare(out)
    same = same_programs(base.planner, base.executor)
    folders = {name: home / _folder(name) for name in ABLATIONS if name not in same}
    for name, folder in folders.items():
        click.echo(f"preset   {name}")
        configuration = base.model_copy(update={"components": ABLATIONS[name]})
        attempt_all(selection, configuration, episodes, prepare(folder), options)
    runs = [read_run(str(folder)) for folder in folders.values()]
    click.echo(render(build_table(runs, "ablation"), "md", intervals=True), nl=False)
    click.echo(f"record   {home}")
    click.echo(f"table    spacevln table {home}/* --shape ablation --published --format latex")


def _folder(preset: str) -> str:
    return preset.replace("-", "without-", 1) if preset.startswith("-") else preset
