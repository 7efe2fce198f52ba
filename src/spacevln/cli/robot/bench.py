"""``spacevln robot bench``: the paper's real-robot table from a file of routes; ``robot routes`` writes such a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.options import agent_options
from spacevln.cli.robot.options import profile_from, profile_options

if TYPE_CHECKING:
    from spacevln.cli.robot.trials import Setup
    from spacevln.evaluation.robot_routes import Row

ROWS = "rows.jsonl"


@click.command()
@click.argument("path", metavar="ROUTES.yaml", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--first-seed", type=click.IntRange(0, 999_000), default=600, show_default=True, help="First house to look at.")
def routes(path: Path, first_seed: int) -> int:
    """Write the paper's protocol in embedded houses: 18 open, 18 cluttered and 14 cross-area instructions.

    Houses from 100000 on speak with the phrases of the test split.
    """
    from spacevln.evaluation.robot_protocol import protocol_routes, write_routes

    found = protocol_routes(first_seed)
    write_routes(found, path)
    click.echo(f"{path}: {len(found.routes)} routes, {sum(len(route.instructions) for route in found.routes)} instructions")
    return 0


@click.command()
@click.argument("routes", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "--on",
    type=click.Choice(["robot", "simulated", "lockstep", "ideal"]),
    default="robot",
    show_default=True,
    help="The robot; or, for routes in embedded houses, the simulated robot in real time, it under a simulated clock, or the "
    "simulator of the benchmarks, without body or noise.",
)
@click.option(
    "--stop",
    type=click.Choice(["tracked", "measured"]),
    default="tracked",
    show_default=True,
    help="Who says where a real robot stopped: its own pose, or your tape.",
)
@click.option("--trials", "most", type=click.IntRange(1), default=None, help="How many now at most; go on with the same --out.")
@profile_options
@agent_options
def bench(routes: Path, on: str, stop: str, most: int | None, out: Path | None, **options: Any) -> int:
    """Run every instruction of ROUTES and print NE and SR by setting; goes on where it was interrupted.

    An instruction succeeds when the robot stops, by itself, within 2 m of the goal. Of simulated robots the true pose judges.
    """
    from spacevln.cli.output import describe_run, prepare
    from spacevln.cli.robot.drive import robot_configuration
    from spacevln.cli.robot.trials import Setup
    from spacevln.evaluation.robot_routes import load_routes, table, trials
    from spacevln.evaluation.runner import claim_directory

    listed = load_routes(routes)
    setup = Setup(on, stop, listed.radius_m, profile_from(options), prepare(out), options)
    claim_directory(setup.directory, describe_run(f"robot bench {listed.name} on {on}", robot_configuration(options)))
    rows = _rows(setup.directory / ROWS)
    done = {row.episode_id for row in rows}
    for trial in [trial for trial in trials(listed) if trial.spec.episode_id not in done][:most]:
        row = setup.attempt(trial)
        if row.status == "interrupted":  # no outcome: it is driven again
            return 130
        with (setup.directory / ROWS).open("a", encoding="utf-8") as file:
            file.write(row.model_dump_json() + "\n")
        rows.append(row)
        click.echo(_line(row))
    click.echo(table(_name(options, setup), rows))
    return 0


def _rows(path: Path) -> list[Row]:
    from spacevln.evaluation.robot_routes import Row

    if not path.exists():
        return []
    return [Row.model_validate_json(line) for line in path.read_text(encoding="utf-8").splitlines()]


def _name(options: dict[str, Any], setup: Setup) -> str:
    mind = "rules" if options["model"] is None else options["model"]
    return f"SpaceVLN ({mind}), {setup.on}"


def _line(row: Row) -> str:
    judged = "success" if row.success else "no success"
    touched = f", {row.contacts} contacts up to {row.hardest_contact_m_s:.2f} m/s" if row.contacts else ""
    return f"{row.episode_id}: {row.status}, {row.NE_m:.2f} m from the goal, {judged}, {row.seconds:.0f} s{touched}"
