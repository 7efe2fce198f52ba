"""``spacevln view``: pages of a record."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("record", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("other", type=click.Path(path_type=Path, exists=True, file_okay=False), required=False)
@click.option("--episode", "episode_id", default=None, help="Only this episode, where RECORD is a run of many.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=None, help="Where the pages go.")
def view(record: Path, other: Path | None, episode_id: str | None, out: Path | None) -> None:
    """Write the pages of the run or episode in RECORD; with OTHER, two records of one episode side by side.

    The pages need no server and no network. By default they lie in the record itself, those of a comparison in a folder
    ``compare`` of the first.
    """
    from spacevln.evaluation.replay import find_episode
    from spacevln.viewer import write_comparison, write_site

    if other is not None:
        first, second = find_episode(record, episode_id), find_episode(other, episode_id)
        page = write_comparison(first, second, out or first / "compare")
    else:
        page = write_site(record if episode_id is None else find_episode(record, episode_id), out)
    click.echo(page)
