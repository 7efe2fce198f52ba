"""``spacevln robot bench``: the paper's real-robot table from a file of routes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.options import agent_options
from spacevln.cli.robot.options import profile_from, profile_options

if TYPE_CHECKING:
    from spacevln.assembly.simulated_robot import SimulatedRobotProcess
    from spacevln.environments.robot.profile import RobotProfile
    from spacevln.evaluation.robot_routes import Row, Trial

ROWS = "rows.jsonl"


@click.command()
@click.argument("routes", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "--stop",
    type=click.Choice(["tracked", "measured"]),
    default="tracked",
    show_default=True,
    help="Who says where the robot stopped: its own pose, or your tape.",
)
@click.option("--simulate", is_flag=True, help="Routes in embedded houses, on the simulated robot; its true pose judges.")
@profile_options
@agent_options
def bench(routes: Path, stop: str, simulate: bool, out: Path | None, **options: Any) -> int:
    """Run every instruction of ROUTES and print NE and SR by setting; goes on where it was interrupted.

    An instruction succeeds when the robot stops, by itself, within 2 m of the goal.
    """
    from spacevln.cli.output import describe_run, prepare
    from spacevln.cli.robot.drive import robot_configuration
    from spacevln.evaluation.robot_routes import load_routes, table, trials
    from spacevln.evaluation.runner import claim_directory

    listed = load_routes(routes)
    profile, directory = profile_from(options), prepare(out)
    claim_directory(directory, describe_run(f"robot bench {listed.name}", robot_configuration(options)))
    rows = _rows(directory / ROWS)
    done = {row.episode_id for row in rows}
    for trial in trials(listed):
        if trial.spec.episode_id in done:
            continue
        row = _try(trial, listed.radius_m, "simulated" if simulate else stop, profile, directory, dict(options))
        with (directory / ROWS).open("a", encoding="utf-8") as file:
            file.write(row.model_dump_json() + "\n")
        rows.append(row)
        click.echo(
            f"{row.episode_id}: {row.status}, {row.NE_m:.2f} m from the goal, {'success' if row.success else 'no success'}"
        )
    click.echo(table("SpaceVLN (rules)" if options["model"] is None else f"SpaceVLN ({options['model']})", rows))
    return 0


def _rows(path: Path) -> list[Row]:
    from spacevln.evaluation.robot_routes import Row

    if not path.exists():
        return []
    return [Row.model_validate_json(line) for line in path.read_text(encoding="utf-8").splitlines()]


def _try(trial: Trial, radius_m: float, judge: str, profile: RobotProfile, directory: Path, options: dict[str, Any]) -> Row:
    from spacevln.assembly.robots import connect, simulated_profile
    from spacevln.assembly.simulated_robot import SimulatedRobotProcess
    from spacevln.cli.robot.drive import attempt
    from spacevln.evaluation.episode import Episode
    from spacevln.evaluation.robot_routes import Row
    from spacevln.recording import episode_directory

    spec, peer = trial.spec, None
    if judge == "simulated":
        if trial.route.scene is None or trial.route.start is None:
            raise click.UsageError(f"Route {trial.route.id!r} has no scene and start: --simulate needs both.")
        profile = simulated_profile()
        peer = SimulatedRobotProcess(profile, spec.scene, spec.start, trial.variant)
    else:
        click.pause(f"{spec.episode_id}: put the robot at the start of {trial.route.id!r}, then press a key ...")
    try:
        environment, _ = connect(profile, place=None if peer is None else peer.place, simulated=peer is not None)
        folder = episode_directory(directory, spec.episode_id)
        result = attempt(environment, Episode(spec), folder, options, directory, [])
        error_m = _error_m(trial, judge, folder, peer)
    finally:
        if peer is not None:
            peer.close()
    stopped = result.status == "stopped"
    return Row(
        episode_id=spec.episode_id,
        setting=trial.route.setting,
        status=result.status,
        stopped=stopped,
        NE_m=round(error_m, 3),
        success=stopped and error_m <= radius_m,
        judged_by=judge,
        seconds=result.timing_s,
    )


def _error_m(trial: Trial, judge: str, folder: Path, peer: SimulatedRobotProcess | None) -> float:
    """Horizontal distance from where the robot stopped to the goal [m]."""
    from spacevln.recording import read_events
    from spacevln.recording.schema import EpisodeEndedLine

    x, y = trial.route.goal_m
    if peer is not None:
        return peer.measure().pose.distance_m(x, y)
    if judge == "measured":
        return float(click.prompt("distance from the robot to the goal [m]", type=click.FloatRange(min=0)))
    ends = [line.pose for line in read_events(folder) if isinstance(line, EpisodeEndedLine)]
    return ends[-1].distance_m(x, y) if ends else math.hypot(x, y)
