"""``spacevln bench-perception``: how good a detector is in the embedded houses, and what its errors cost the agent."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.data_options import seed_range
from spacevln.cli.detector_options import detector_from, detector_options

if TYPE_CHECKING:
    from spacevln.assembly import Configuration
    from spacevln.evaluation.perception_report import PerceptionReport, Share
    from spacevln.evaluation.perception_success import Level
    from spacevln.evaluation.runs import Run

_seeds = click.option(
    "--seeds", callback=seed_range, metavar="A:B", default="700:712", show_default=True, help="House seeds A..B-1, one walk each."
)
_out = click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=None, help="Where files are written.")
_renderer = click.option("--renderer", type=click.Choice(["auto", "gl", "raycast"]), default="auto", show_default=True)


@click.group("bench-perception")
def bench_perception() -> None:
    """How good a detector is, and what its errors cost."""


@bench_perception.command()
@_seeds
@_renderer
@detector_options
@_out
def houses(seeds: tuple[int, int], renderer: str, out: Path | None, **options: Any) -> int:
    """Judge a detector against the labels of the embedded houses: precision, recall, places, arrival decisions."""
    from spacevln.assembly import Configuration, HousesSettings, build_detector, build_environment
    from spacevln.cli.output import prepare
    from spacevln.evaluation.houses import fresh_episodes
    from spacevln.evaluation.perception_quality import judge_walk
    from spacevln.evaluation.perception_report import panels, report_of
    from spacevln.evaluation.perception_walks import Walk
    from spacevln.viewer.curves import draw_curves

    settings = detector_from(options | {"preset": None})
    configuration = Configuration(detector=settings, environment=HousesSettings.model_validate({"renderer": renderer}))
    detector, directory = build_detector(configuration), prepare(out)
    environment = build_environment(configuration)
    try:
        walks = []
        for episode in fresh_episodes("houses-objectnav", range(*seeds)):
            walks.append(judge_walk(Walk.of(episode), environment, detector))
            click.echo(f"walk     {episode.episode_id}  {walks[-1].images} images")
    finally:
        environment.close()
    report = report_of(walks, settings.model_dump())
    (directory / "perception.json").write_text(report.model_dump_json(indent=1), encoding="utf-8")
    (directory / "perception.svg").write_text(draw_curves(panels(report)), encoding="utf-8")
    _tell(report)
    click.echo(f"files    {directory / 'perception.json'}, {directory / 'perception.svg'}")
    return 0


def _tell(report: PerceptionReport) -> None:
    click.echo(f"walks    {len(report.walks)}, {report.images} images; [95 % interval over walks]")
    click.echo(f"precision {_percent(report.precision)} of {report.whole.detections} detections")
    click.echo(f"recall    {_percent(report.recall)} of {report.whole.instances} instances")
    click.echo("distance    instances  precision  recall  error median  90 %   mask IoU")
    for each in report.by_distance:
        shares = [f"{100 * value:.1f}" if value is not None else "-" for value in (each.precision, each.recall)]
        metres = [f"{value:.2f} m" if value is not None else "-" for value in (each.error_m, each.error90_m)]
        iou = f"{each.mask_iou:.2f}" if each.mask_iou is not None else "-"
        click.echo(
            f"{each.from_m:.0f} to {each.to_m:.0f} m".ljust(12)
            + f"{each.instances:9d}  {shares[0]:>9}  {shares[1]:>6}  {metres[0]:>12}  {metres[1]:>6}  {iou:>8}"
        )
    for decided in report.arrivals:
        needed = "1 picture" if decided.arrival_sightings == 1 else f"{decided.arrival_sightings} pictures"
        rates = (("accuracy", decided.accuracy), ("precision", decided.precision), ("recall", decided.recall))
        told = ", ".join(f"{name} {_percent(share)}" for name, share in rates)
        counts = f"{decided.false_arrivals} false, {decided.true_arrivals} true in {decided.decisions} decisions"
        click.echo(f"arrival by {needed}: {told}; {counts}")


def _percent(share: Share) -> str:
    if share.value is None:
        return "-"
    spread = "" if share.low is None or share.high is None else f" [{100 * share.low:.1f}, {100 * share.high:.1f}]"
    return f"{100 * share.value:.1f} %{spread}"


@bench_perception.command()
@click.argument("suite", type=click.Choice(["houses-vln", "houses-objectnav"]), default="houses-vln")
@_seeds
@click.option("--misses", multiple=True, type=click.FloatRange(0, 1), default=(0.25, 0.5, 0.75), show_default=True)
@click.option("--confusions", multiple=True, type=click.FloatRange(0, 1), default=(0.1, 0.2, 0.4), show_default=True)
@click.option(
    "--arrival-sightings",
    multiple=True,
    type=click.IntRange(min=1),
    default=(1,),
    show_default=True,
    help="Pictures that must show a landmark before it counts as reached; each is tried with every error.",
)
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True)
@_renderer
@_out
def success(suite: str, seeds: tuple[int, int], out: Path | None, renderer: str, workers: int, **options: Any) -> int:
    """Run the agent with simulated errors of its detector; the same command on the same --out resumes."""
    from spacevln.assembly import Configuration, HousesSettings
    from spacevln.cli.output import prepare
    from spacevln.environments.houses.rendering import renderer_info
    from spacevln.evaluation.datasets import Selection
    from spacevln.evaluation.perception_success import levels_of, success_panels, successes
    from spacevln.viewer.curves import draw_curves

    base = Configuration(environment=HousesSettings(renderer=renderer_info(renderer).name))
    selection, directory = Selection(suite=suite, seeds=seeds), prepare(out)
    levels = levels_of(options["misses"], options["confusions"], options["arrival_sightings"])
    runs = {level: _attempted(level, base, selection, directory, workers) for level in levels}
    found = successes(runs)
    for level, rate in found.items():
        spread = "" if rate.low is None or rate.high is None else f" [{rate.low:.0f}, {rate.high:.0f}]"
        click.echo(f"{level.folder:28s} SR {rate.mean:5.1f} %{spread}  n {rate.count}{_against(level, runs)}")
    (directory / "success.svg").write_text(draw_curves(success_panels(found)), encoding="utf-8")
    click.echo(f"picture  {directory / 'success.svg'}")
    return 0


def _attempted(level: Level, base: Configuration, selection: Any, home: Path, workers: int) -> Run:
    """The run of a level, its missing episodes attempted."""
    from spacevln.cli.attempting import Progress
    from spacevln.cli.output import describe_run, prepare
    from spacevln.evaluation.runner import Job, bench, claim_directory
    from spacevln.evaluation.runs import read_run
    from spacevln.recording import RecordLevel

    click.echo(f"level    {level.folder}")
    configuration, folder = level.configured(base), prepare(home / level.folder)
    episodes = selection.load()
    claim_directory(folder, describe_run(selection.name, configuration, episodes.source))
    with (progress := Progress(len(episodes))):
        bench(Job(selection, configuration, folder, RecordLevel.LIGHT), workers, progress.add)
    return read_run(str(folder))


def _against(level: Level, runs: dict[Level, Run]) -> str:
    """How it compares, episode by episode, with the same errors and one picture."""
    from dataclasses import replace

    from spacevln.evaluation.statistics import paired

    plain = replace(level, arrival_sightings=1)
    if plain == level or plain not in runs:
        return ""
    found = paired(runs[plain].values("SR"), runs[level].values("SR"))
    return f"  against one picture: +{len(found.gained)} -{len(found.lost)}"
