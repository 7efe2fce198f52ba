"""``spacevln replay``: rerun a recorded episode offline and compare."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

SHOWN_CHARS = 600
BEFORE_CHARS = 150
"""Of a line before the place where the two part."""


@click.command()
@click.argument("record", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--episode", "episode_id", default=None, help="Which episode, where RECORD is a run of many.")
@click.option("--loose", is_flag=True, help="Give the recorded reply even where the request has changed.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=None, help="Keep the replay's own record here.")
def replay(record: Path, episode_id: str | None, loose: bool, out: Path | None) -> int:
    """Rerun the episode in RECORD from its stored replies, without any model, and compare what the agent does.

    The world is rebuilt too, which only embedded houses can be: look at any other with `spacevln view`.
    Ends with 0 when every action is the same to the byte, else with 1.
    """
    from spacevln.evaluation.replay import find_episode
    from spacevln.evaluation.replay import replay as rerun

    with tempfile.TemporaryDirectory(prefix="spacevln-replay-") as temporary:
        report = rerun(find_episode(record, episode_id), out or Path(temporary), strict=not loose)
    click.echo(f"calls    {report.calls} answered from the record")
    click.echo(f"actions  {report.actions} of {report.recorded_actions} are the same")
    if report.difference is not None:
        parts = next((i for i, (a, b) in enumerate(zip(*report.difference, strict=False)) if a != b), 0)
        begin = max(0, parts - BEFORE_CHARS)
        recorded, replayed = (_excerpt(line, begin) for line in report.difference)
        click.echo(f"first difference\n  recorded {recorded}\n  replayed {replayed}")
    else:
        click.echo("record   every line is the same, times aside")
    if out is not None:
        click.echo(f"record   {out}")
    return 0 if report.same_actions else 1


def _excerpt(line: str, begin: int) -> str:
    shown = line[begin : begin + SHOWN_CHARS]
    return f"{'... ' if begin else ''}{shown}{' ...' if len(line) > begin + SHOWN_CHARS else ''}"
