"""``spacevln robot demo``: the agent drives a simulated robot through an embedded house, over the real transport."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.options import agent_options

if TYPE_CHECKING:
    from spacevln.environments.robot.transport import TransportName


@click.command()
@click.option("--seed", type=click.IntRange(0, 999_999), default=3, show_default=True, help="Which house.")
@click.option("--transport", type=click.Choice(["dds", "zenoh"]), default="dds", show_default=True)
@click.option("--domain", type=click.IntRange(0, 232), default=42, show_default=True, help="ROS_DOMAIN_ID.")
@agent_options
def demo(seed: int, transport: TransportName, domain: int, out: Path | None, **options: Any) -> int:
    """Watch the agent drive a simulated robot in real time.

    Base and sensors live in another process, with wheel slip, noise, latency and lost frames; the wheel guard in a third.
    """
    from spacevln.assembly.robots import connect, simulated_profile
    from spacevln.assembly.simulated_robot import SimulatedRobotProcess
    from spacevln.cli.robot.drive import drive
    from spacevln.environments.robot.transport import require
    from spacevln.evaluation.houses import pick_episode

    require("cyclonedds" if transport == "dds" else "zenoh")
    require("rosbags")
    episode = pick_episode("vln", seed)
    profile = simulated_profile(transport, domain)
    click.echo(f"robot    simulated, in {episode.scene}, over {transport} in another process")
    peer = SimulatedRobotProcess(profile, episode.scene, episode.start, seed)
    try:
        environment, link = connect(profile, place=peer.place, simulated=True)
        code = drive(environment, link, episode, f"robot demo {seed}", out, options)
        truth = peer.measure()
    finally:
        peer.close()
    click.echo(
        f"truth    travelled {truth.travelled_m:.1f} m, {truth.contacts} contacts, hardest {truth.hardest_contact_m_s:.2f} m/s"
    )
    return code
