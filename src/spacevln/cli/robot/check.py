"""``spacevln robot check``: what is wrong with a robot's data, and how to mend it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.robot.options import profile_from, profile_options

if TYPE_CHECKING:
    from spacevln.environments.robot.checks import Check
    from spacevln.environments.robot.profile import RobotProfile


@click.command()
@click.option("--seconds", type=click.FloatRange(1, 600), default=5.0, show_default=True, help="How long to listen.")
@click.option("--turn", is_flag=True, help="Also turn once around on the spot: depth is compared with odometry.")
@profile_options
def check(seconds: float, turn: bool, **options: Any) -> int:
    """Walk through sensors, rates, clocks and extrinsics; exit code 1 when something is wrong."""
    profile = profile_from(options)
    findings = _listen(profile, seconds)
    for finding in findings:
        _tell(finding)
    if turn and all(finding.ok for finding in findings):
        findings.append(_turn(profile))
        _tell(findings[-1])
    elif turn:
        click.echo("note     the turn waits until everything above is ok")
    return 0 if all(finding.ok for finding in findings) else 1


def _listen(profile: RobotProfile, seconds: float) -> list[Check]:
    from spacevln.environments.robot.checks import check_streams
    from spacevln.environments.robot.clock import SystemClock
    from spacevln.environments.robot.streams import Streams
    from spacevln.environments.robot.transport import open_transport

    transport = open_transport(profile.transport, domain=profile.domain, distro=profile.distro, endpoint=profile.endpoint)
    try:
        clock = SystemClock()
        streams = Streams(transport, profile, clock)
        clock.sleep(1.0)  # until the writers are found
        return check_streams(streams, profile, clock, seconds)
    finally:
        transport.close()


def _turn(profile: RobotProfile) -> Check:
    from spacevln.assembly.robots import connect
    from spacevln.core import EpisodeSpec, InstructionTask, Pose, TurnLeft
    from spacevln.environments.robot.checks import check_turning

    environment, _ = connect(profile)
    try:
        views = [environment.reset(EpisodeSpec("check", "robot", Pose(0.0, 0.0), InstructionTask("turn")))]
        for _ in range(environment.spec.lookaround_count):
            environment.execute(TurnLeft(environment.spec.turn_deg))
            views.append(environment.observe())
    finally:
        environment.close()
    return check_turning(views)


def _tell(finding: Check) -> None:
    click.echo(f"{click.style('ok     ', fg='green') if finding.ok else click.style('wrong  ', fg='red')}  {finding.what}")
    if not finding.ok and finding.mend:
        click.echo(f"         -> {finding.mend}")
