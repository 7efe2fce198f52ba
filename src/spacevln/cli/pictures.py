"""``spacevln figure``, ``video`` and ``rerun``: pictures of an episode."""

from __future__ import annotations

from pathlib import Path

import click

EPISODE = click.argument("record", type=click.Path(path_type=Path, exists=True, file_okay=False))
WHICH = click.option("--episode", "episode_id", default=None, help="Which episode, where RECORD is a run of many.")


@click.command()
@EPISODE
@WHICH
@click.option("--stage", type=click.IntRange(min=1), default=None, help="By default the decisive or the longest one.")
@click.option("--failure", is_flag=True, help="Add why the episode failed and what the agent thought.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=None, help="The file, PNG and PDF are written.")
def figure(record: Path, episode_id: str | None, stage: int | None, failure: bool, out: Path | None) -> None:
    """Draw the paper's figure of the episode in RECORD: the planner's row and the executor's row."""
    from spacevln.evaluation.replay import find_episode
    from spacevln.viewer import draw_figure

    episode = find_episode(record, episode_id)
    number = None if stage is None else stage - 1
    for path in draw_figure(episode, out or episode / "figure.png", stage=number, failure=failure):
        click.echo(path)


@click.command()
@EPISODE
@WHICH
@click.option("--speed", type=click.IntRange(1, 60), default=8, show_default=True, help="Steps per second.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=None, help="The MP4.")
def video(record: Path, episode_id: str | None, speed: int, out: Path | None) -> None:
    """Write a video of the episode in RECORD: first-person view, map, subtask and reasoning."""
    from spacevln.evaluation.replay import find_episode
    from spacevln.viewer import write_video

    episode = find_episode(record, episode_id)
    click.echo(write_video(episode, out or episode / "episode.mp4", frames_per_s=speed))


@click.command()
@EPISODE
@WHICH
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=None, help="The .rrd file.")
def rerun(record: Path, episode_id: str | None, out: Path | None) -> None:
    """Write a log of the episode in RECORD for the Rerun viewer: camera, depth, map, graph, landmarks, way and words."""
    from spacevln.evaluation.replay import find_episode
    from spacevln.viewer import write_spatial_log

    episode = find_episode(record, episode_id)
    click.echo(write_spatial_log(episode, out or episode / "episode.rrd"))
