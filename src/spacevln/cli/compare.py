"""``spacevln compare``: two runs on the same episodes, and the episodes that flipped."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from spacevln.evaluation.runs import Run

METRICS = ("SR", "SPL", "OSR", "NE", "nDTW", "SDTW", "steps", "collisions", "usd", "minutes")
TEXT_CHARS = 70


@click.command()
@click.argument("first", metavar="[LABEL=]A")
@click.argument("second", metavar="[LABEL=]B")
@click.option("--flips/--no-flips", default=True, show_default=True, help="List the episodes that flipped.")
def compare(first: str, second: str, flips: bool) -> None:
    """Compare run B with run A episode by episode: differences with 95 % intervals, p-values, and the episodes that flipped."""
    from spacevln.evaluation.runs import read_run
    from spacevln.evaluation.statistics import paired

    a, b = read_run(first), read_run(second)
    common = [name for name in a.results if name in b.results]
    if not common:
        raise click.UsageError(f"{a.label} and {b.label} have no episode in common: compare runs of one suite.")
    click.echo(f"{len(common)} common episodes; only in {a.label}: {len(a.results) - len(common)}, only in {b.label}: ", nl=False)
    click.echo(len(b.results) - len(common))
    click.echo(
        f"{'':10s} {a.label[:14]:>14s} {b.label[:14]:>14s} {'difference':>12s} {'95 % interval':>20s} {'p':>8s}  better/worse"
    )
    for metric in METRICS:
        found = paired(a.values(metric), b.values(metric))
        if not found.count or found.p_value is None:
            continue
        better, worse = len(found.gained), len(found.lost)
        if metric in ("NE", "steps", "collisions", "usd", "minutes"):
            better, worse = worse, better
        low, high = found.difference.low, found.difference.high
        spread = "--" if low is None or high is None else f"[{low:+.1f}, {high:+.1f}]"
        click.echo(
            f"{metric:10s} {found.first:14.1f} {found.second:14.1f} {found.difference.mean:+12.1f} {spread:>20s} "
            f"{found.p_value:8.3f}  {better}/{worse}"
        )
    if flips:
        success = paired(a.values("SR"), b.values("SR"))
        _list(f"won by {b.label}", success.gained, a, b)
        _list(f"lost by {b.label}", success.lost, a, b)


def _list(title: str, names: tuple[str, ...], a: Run, b: Run) -> None:
    click.echo(f"\n{title}: {len(names)}")
    for name in names:
        text = b.results[name].task_text
        shown = text if len(text) <= TEXT_CHARS else text[: TEXT_CHARS - 1] + "…"
        click.echo(f"  {name:24s} {_outcome(a, name):>43s} -> {_outcome(b, name):<43s} {shown}")


def _outcome(run: Run, name: str) -> str:
    from spacevln.evaluation.diagnosis import failure_class

    result = run.results[name]
    distance = result.metrics.NE
    near = "no way" if distance is None or math.isinf(distance) else f"{distance:.1f} m"
    return f"{failure_class(result) or 'success'}, {near}"
