"""``spacevln replay``: rerun a recorded episode offline and compare."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

SHOWN_CHARS = 600


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
        recorded, replayed = (text if len(text) <= SHOWN_CHARS else text[:SHOWN_CHARS] + " ..." for text in report.difference)
        click.echo(f"first difference\n  recorded {recorded}\n  replayed {replayed}")
    else:
        click.echo("record   every line is the same, times aside")
    if out is not None:
        click.echo(f"record   {out}")
    return 0 if report.same_actions else 1
