"""``spacevln run``: one episode, in an embedded house or of a benchmark in its simulator, with a live display."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.attempting import FAILED_STATUSES
from spacevln.cli.bench import placed
from spacevln.cli.costs import usage_line
from spacevln.cli.habitat_options import habitat_options
from spacevln.cli.model_options import access_from
from spacevln.cli.options import agent_options, configuration_from

if TYPE_CHECKING:
    from spacevln.evaluation.datasets import Selection
    from spacevln.recording import ResultFile

BRIDGED_SUITES = ("r2r-ce", "rxr-ce", "hm3d-ovon", "gn-bench")

MAX_INSTRUCTION_CHARS = 4000


@click.command()
@click.option(
    "--task", type=click.Choice(["vln", "objectnav"]), default="vln", show_default=True, help="Follow a route, or find an object."
)
@click.option("--seed", type=click.IntRange(0, 999_999), default=9, show_default=True, help="Which house.")
@click.option("--instruction", default=None, help="Your own route instruction; it has no truth, so its metrics are null.")
@click.option("--goal", default=None, help="Your own goal object, e.g. 'teapot' (with --task objectnav).")
@click.option(
    "--memory",
    type=click.Path(path_type=Path, dir_okay=False),
    default=None,
    help="Begin with the memory.npz that an episode in this house left; the result says so.",
)
@click.option("--suite", type=click.Choice(BRIDGED_SUITES), default=None, help="An episode of a benchmark, in its simulator.")
@click.option("--data", type=click.Path(path_type=Path), default=None, help="Folder or file of the benchmark's episodes.")
@click.option("--split", default=None, help="Of the benchmark.")
@click.option("--id", "episode_id", default=None, help="Which of its episodes; else the first.")
@habitat_options
@agent_options
def run(
    task: str, seed: int, instruction: str | None, goal: str | None, memory: Path | None, out: Path | None, **options: Any
) -> int:
    """Run one episode and show what happens.

    Ends with one line of truth, the record's path, a picture from above, and pages that show every decision.
    """
    _check(task, instruction, goal)
    selection = _benchmark(options, given=_seed_is_given() or instruction is not None or goal is not None)
    from spacevln.assembly import KnownBuilding
    from spacevln.cli.output import describe_run, prepare
    from spacevln.cli.progress import EpisodeProgress
    from spacevln.evaluation.attempt import Session
    from spacevln.evaluation.houses import pick_episode
    from spacevln.evaluation.runner import claim_directory, finished
    from spacevln.evaluation.summary import summarise
    from spacevln.recording import episode_directory, write_file
    from spacevln.viewer import write_site

    configuration = configuration_from(options)
    if selection is not None:
        configuration = placed(configuration, selection, options)
    if memory is not None:
        configuration = configuration.model_copy(update={"memory": KnownBuilding.of(memory)})
    directory = prepare(out)
    name = selection.name if selection else f"{task} {seed} {instruction or goal or ''}".strip()
    claim_directory(directory, describe_run(f"run {name}", configuration))
    with EpisodeProgress() as progress:
        progress.say("reading the episodes" if selection else "building the house")
        episode = selection.load()[0] if selection else pick_episode(task, seed, instruction=instruction, goal=goal)
        folder = episode_directory(directory, episode.episode_id)
        result = finished(directory, episode.episode_id)
        if result is None:
            progress.begin(episode.spec)
            with Session(configuration, access=access_from(options, directory)) as session:
                result = session.attempt(episode, folder, chase=options["chase"], sinks=(progress,))
    write_file(directory / "summary.json", summarise([result]))
    click.echo(outcome_line(result))
    if result.usage:
        click.echo(usage_line(result.usage))
    click.echo(f"record   {folder}")
    if (folder / "topdown.png").exists():
        click.echo(f"picture  {folder / 'topdown.png'}")
    click.echo(f"pages    {write_site(directory)}")
    return exit_code(result)


def _benchmark(options: dict[str, Any], *, given: bool) -> Selection | None:
    """The benchmark's episode that is asked for, if any; its options are taken out.

    Args:
        options: of the command.
        given: whether an embedded house's seed, instruction or goal was named too.
    """
    from spacevln.evaluation.datasets import Filters, Selection

    suite, data, split, episode_id = (options.pop(name) for name in ("suite", "data", "split", "episode_id"))
    if suite is None:
        if any(value is not None for value in (data, split, episode_id, options["habitat_python"], options["scenes"])):
            raise click.UsageError(f"These options are of benchmarks: add --suite, one of {', '.join(BRIDGED_SUITES)}.")
        return None
    if given:
        raise click.UsageError("--seed, --instruction and --goal are of embedded houses: leave them out, or leave --suite out.")
    filters = Filters.of({} if episode_id is None else {"ids": (episode_id,)})
    return Selection(suite=suite, path=data, split=split, filters=filters, episodes=1)


def _seed_is_given() -> bool:
    """Whether the user named a house."""
    source = click.get_current_context().get_parameter_source("seed")
    return source is not None and source.name != "DEFAULT"


def _check(task: str, instruction: str | None, goal: str | None) -> None:
    if instruction is not None and task != "vln":
        raise click.UsageError("--instruction belongs to --task vln: leave it out, or give --goal.")
    if goal is not None and task != "objectnav":
        raise click.UsageError("--goal belongs to --task objectnav: add --task objectnav.")
    if instruction is not None and not instruction.strip():
        raise click.UsageError("--instruction '' is empty: say where to go, e.g. 'Leave the bedroom and stop by the sofa.'")
    if instruction is not None and len(instruction) > MAX_INSTRUCTION_CHARS:
        raise click.UsageError(
            f"--instruction has {len(instruction):,} characters, at most {MAX_INSTRUCTION_CHARS:,} are allowed: shorten it."
        )


def outcome_line(result: ResultFile) -> str:
    """One honest line about an episode."""
    metrics = result.metrics
    parts = [f"status {result.status}"]
    if result.forced_stop:
        parts.append(f"STOP forced by {result.stop_reason}")
    if metrics.SR is not None:
        distance = "unreachable" if metrics.NE is None else f"{metrics.NE:.2f} m from the goal"
        parts += [distance, "success" if metrics.SR else "no success", f"SPL {metrics.SPL:.2f}"]
    else:
        parts.append("no truth, so no success is claimed")
    if result.loaded_memory is not None:
        parts.append(f"began with the memory {result.loaded_memory}")
    parts += [f"{metrics.steps} steps", f"{metrics.stages} stages", f"{result.timing_s:.1f} s"]
    if result.detail and result.status != "stopped":
        parts.append(result.detail)
    return "result   " + ", ".join(parts)


def exit_code(result: ResultFile) -> int:
    """DESIGN 5.10: 0 done, 1 a failure of model or world, 130 interrupted."""
    if result.status == "interrupted":
        return 130
    return int(result.status in FAILED_STATUSES)
