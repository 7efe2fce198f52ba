"""``spacevln robot run``: one instruction on a robot."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.options import agent_options, configuration_from
from spacevln.cli.robot.options import profile_from, profile_options

if TYPE_CHECKING:
    from spacevln.core import EventSink
    from spacevln.environments.robot.environment import RobotEnvironment
    from spacevln.environments.robot.guard.status import WheelLink
    from spacevln.evaluation.episode import Episode
    from spacevln.recording import ResultFile

ROBOT_VIEWS = 8


@click.command()
@click.option("--instruction", default=None, help="Where to go, e.g. 'Leave the room and stop by the sofa.'")
@click.option("--goal", default=None, help="Or what to find, e.g. 'chair'.")
@click.option("--dry-run", is_flag=True, help="No motion: see what would be decided.")
@click.option("--confirm", is_flag=True, help="Approve every stage before the robot moves.")
@profile_options
@agent_options
def run(instruction: str | None, goal: str | None, dry_run: bool, confirm: bool, out: Path | None, **options: Any) -> int:
    """Follow an instruction, or find an object, on a robot.

    The episode begins where the robot stands. Read the safety checklist in docs/robot.md first.
    """
    from spacevln.assembly.robots import connect
    from spacevln.cli.robot.operator import require_terminal

    episode = free_episode(instruction, goal)
    if confirm:
        require_terminal()
    profile = profile_from(options)
    environment, link = connect(profile, dry=dry_run)
    click.echo(f"robot    {profile.name} over {profile.transport}, wheels {'held at zero' if dry_run else 'guarded'}")
    return drive(environment, link, episode, f"robot run {profile.name}", out, options, confirm=confirm)


def free_episode(instruction: str | None, goal: str | None) -> Episode:
    """A task without truth.

    Raises:
        UsageError: not exactly one of instruction and goal is given.
    """
    from spacevln.core import EpisodeSpec, InstructionTask, ObjectGoalTask, Pose
    from spacevln.evaluation.episode import Episode

    given = [text.strip() for text in (instruction, goal) if text is not None and text.strip()]
    if len(given) != 1:
        raise click.UsageError("Give either --instruction 'where to go' or --goal 'what to find'.")
    task = InstructionTask(given[0]) if instruction is not None else ObjectGoalTask(given[0])
    return Episode(EpisodeSpec("robot-000001", "robot", Pose(0.0, 0.0), task))


def drive(
    environment: RobotEnvironment,
    link: WheelLink,
    episode: Episode,
    what: str,
    out: Path | None,
    options: dict[str, Any],
    *,
    confirm: bool = False,
) -> int:
    """Run an episode with the operator at the keys, and say how it went."""
    from spacevln.cli.output import describe_run, prepare
    from spacevln.cli.progress import EpisodeProgress
    from spacevln.cli.robot.operator import OperatorKeys, StageConfirmation
    from spacevln.cli.run import exit_code, outcome_line
    from spacevln.evaluation.runner import claim_directory
    from spacevln.evaluation.summary import summarise
    from spacevln.recording import episode_directory, write_file

    configuration = robot_configuration(options)
    directory = prepare(out)
    claim_directory(directory, describe_run(what, configuration))
    folder = episode_directory(directory, episode.episode_id)
    progress = EpisodeProgress()
    sinks: list[EventSink] = [StageConfirmation(link)] if confirm else [progress]
    with nullcontext() if confirm else progress, OperatorKeys(link) if not confirm else nullcontext():
        if not confirm:
            progress.begin(episode.spec)
        result = attempt(environment, episode, folder, options, directory, sinks)
    write_file(directory / "summary.json", summarise([result]))
    click.echo(outcome_line(result))
    click.echo(time_line(environment, result))
    click.echo(f"record   {folder}")
    return exit_code(result)


def robot_configuration(options: dict[str, Any]) -> Any:
    """The configuration that the options say, with as many views as the robot takes."""
    configuration = configuration_from(options)
    if options["views"] is None:
        prompts = configuration.prompts.model_copy(update={"view_count": ROBOT_VIEWS})
        configuration = configuration.model_copy(update={"prompts": prompts})
    return configuration


def attempt(
    environment: RobotEnvironment,
    episode: Episode,
    folder: Path,
    options: dict[str, Any],
    directory: Path,
    sinks: list[EventSink],
) -> ResultFile:
    """One attempt; the robot is let go of afterwards."""
    from spacevln.cli.model_options import access_from
    from spacevln.evaluation.attempt import Session

    access = access_from(options, directory)
    with Session(robot_configuration(options), environment, access) as session:
        return session.attempt(episode, folder, sinks=sinks)


def time_line(environment: RobotEnvironment, result: ResultFile) -> str:
    """Where the time went."""
    times = environment.times
    first = "no motion" if times.first_motion_s is None else f"first motion after {times.first_motion_s:.1f} s"
    idle = 100 * times.idle_share(result.timing_s)
    return f"time     {first}, idle {idle:.0f} %, held by the guard {times.held_s:.1f} s of {result.timing_s:.1f} s"
