"""``spacevln table``: run directories as the paper's tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from spacevln.evaluation.runs import Run

SHAPES = (
    *("auto", "vln", "gn-bench", "ovon", "ablation", "robot", "runtime", "deployment"),
    *("full", "endings", "failures", "errors", "calls"),
)


@click.command()
@click.argument("runs", nargs=-1, required=True, metavar="[LABEL=]DIR...")
@click.option("--format", "form", type=click.Choice(["md", "latex", "csv"]), default="md", show_default=True)
@click.option(
    "--shape",
    "shapes",
    type=click.Choice(SHAPES),
    multiple=True,
    default=("auto",),
    show_default=True,
    help="Which table; auto is the paper's for the suite. May be given several times.",
)
@click.option("--published", is_flag=True, help="Print the paper's rows above ours.")
@click.option("--intervals", is_flag=True, help="Print 95 % bootstrap intervals over episodes.")
@click.option("--by", "tag", default=None, metavar="TAG", help="One row per value of an episode tag, e.g. floors, length_bin.")
@click.option("--card", is_flag=True, help="Print what one needs to run it again.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=None, help="Write into a file.")
def table(
    runs: tuple[str, ...],
    form: str,
    shapes: tuple[str, ...],
    published: bool,
    intervals: bool,
    tag: str | None,
    card: bool,
    out: Path | None,
) -> None:
    """Print runs as a table; rows with one LABEL are one method on several benchmarks."""
    from spacevln.core import RecordError
    from spacevln.evaluation.runs import read_run
    from spacevln.evaluation.tables import build_table, render, shape_for
    from spacevln.evaluation.tables.card import reproduction_card

    read = [read_run(text) for text in runs]
    rows = read if tag is None else [part for run in read for part in _by_tag(run, tag)]
    parts = []
    for shape in dict.fromkeys(shapes):
        chosen = shape_for(read) if shape == "auto" else shape
        parts.append(render(build_table(rows, chosen, with_published=published), form, intervals=intervals))
    parts += [reproduction_card(run) for run in read] if card else []
    text = "\n".join(parts)
    if out is None:
        click.echo(text, nl=False)
        return
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise RecordError(f"--out {str(out)!r} cannot be written ({error.strerror}): give a file that you may write.") from error
    click.echo(out)


def _by_tag(run: Run, tag: str) -> list[Run]:
    """The run in parts by the values of a tag."""
    from dataclasses import replace

    values = {result.tags[tag] for result in run.results.values() if tag in result.tags}
    if not values:
        known = sorted({name for result in run.results.values() for name in result.tags})
        raise click.UsageError(f"--by {tag}: no episode of {run.label} has this tag; there are {', '.join(known) or 'none'}.")
    ordered = sorted(values, key=lambda value: (isinstance(value, str), _leading_number(value), str(value)))
    return [replace(run.tagged(tag, value), label=f"{run.label}, {tag} {value}") for value in ordered]


def _leading_number(value: object) -> float:
    """``7`` of ``"7-10"``, so that bins come in order."""
    head = str(value).partition("-")[0]
    return float(head) if head.replace(".", "", 1).isdigit() else float("inf")
