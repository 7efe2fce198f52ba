"""``spacevln map``: the memory that an episode left, as pictures."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("map")
@click.argument("record", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--episode", "episode_id", default=None, help="Which episode, where RECORD is a run of many.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=None, help="Where the pictures go.")
def memory_map(record: Path, episode_id: str | None, out: Path | None) -> None:
    """Draw the memory of the episode in RECORD: metric map, spaces with the graph, and what its planner was shown.

    By default the pictures go to ``memory/`` in the episode's own directory.
    """
    from spacevln.evaluation.replay import find_episode
    from spacevln.viewer import draw_memory

    episode = find_episode(record, episode_id)
    for path in draw_memory(episode, out or episode / "memory"):
        click.echo(str(path))
