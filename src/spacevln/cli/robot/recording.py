"""``spacevln robot record``, ``teleop-scan`` and ``map``: a robot's own data as a log, and its map."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.robot.options import profile_from, profile_options

if TYPE_CHECKING:
    from collections.abc import Iterator

    from spacevln.core import Observation

OUT = click.option("--out", type=click.Path(path_type=Path, file_okay=False), required=True, help="Directory of the log.")


@click.command()
@click.option("--seconds", type=click.FloatRange(min=0.1), default=None, help="Stop after so long; by default at Ctrl-C.")
@click.option("--hz", type=click.FloatRange(0.1, 30), default=2.0, show_default=True, help="Frames per second.")
@OUT
@profile_options
def record(seconds: float | None, hz: float, out: Path, **options: Any) -> None:
    """Write a posed RGB-D log of what the robot sees; nothing is commanded."""
    from spacevln.environments.playback.log import LogWriter
    from spacevln.environments.robot.capture import capture
    from spacevln.environments.robot.transport import open_transport

    profile = profile_from(options)
    transport = open_transport(profile.transport, domain=profile.domain, distro=profile.distro, endpoint=profile.endpoint)
    writer: LogWriter | None = None
    try:
        for stamp_ns, observation in capture(transport, profile, hz, seconds):
            writer = writer or LogWriter(out, observation.camera, f"robot {profile.name}")
            writer.add(observation, stamp_ns)
    except KeyboardInterrupt:
        click.echo("stopped by the operator")
    finally:
        transport.close()
        if writer is not None:
            writer.close()
    click.echo(f"log      {out}, {0 if writer is None else len(writer)} frames")


@click.command("teleop-scan")
@OUT
@profile_options
def teleop_scan(out: Path, **options: Any) -> None:
    """Drive by hand; at Enter the robot turns once around and logs its eight views.

    The wheels are guarded only while it turns, so that your own teleoperation has them otherwise.
    """
    from spacevln.assembly.robots import connect
    from spacevln.core import EpisodeSpec, InstructionTask, Pose, TurnLeft
    from spacevln.environments.playback.log import LogWriter
    from spacevln.environments.robot.clock import SystemClock
    from spacevln.environments.robot.observer import placed

    profile, scan = profile_from(options), 0
    writer: LogWriter | None = None
    try:
        while click.prompt("Enter: look around here, q: end", default="", show_default=False) != "q":
            environment, _ = connect(profile)
            try:
                seen = environment.reset(EpisodeSpec(f"scan-{scan}", "robot", Pose(0.0, 0.0), InstructionTask("look around")))
                writer = writer or LogWriter(out, seen.camera, f"robot {profile.name}, teleop-scan")
                for _ in range(environment.spec.lookaround_count):
                    environment.execute(TurnLeft(environment.spec.turn_deg))
                    writer.add(placed(environment.observe(), environment.origin), SystemClock().stamp_ns(), f"scan {scan}")
            finally:
                environment.close()
            scan += 1
            click.echo(f"scan {scan}: {len(writer)} views")
    finally:
        if writer is not None:
            writer.close()


@click.command("map")
@click.argument("source", type=click.Path(path_type=Path, exists=True))
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=Path("map.png"), show_default=True)
@click.option("--profile", default="generic", show_default=True, help="Names of a bag's topics.")
def map_log(source: Path, out: Path, profile: str) -> None:
    """Build the metric map of SOURCE, a log or a ROS 2 bag (.mcap, or its directory), and draw it."""
    import cv2
    import numpy as np

    from spacevln.mapping import MetricMap

    grid, path = MetricMap(), list[tuple[float, float]]()
    for observation in _observations(source, profile):
        grid.integrate(observation)
        path.append((observation.pose.x_m, observation.pose.y_m))
    if not path:
        raise click.UsageError(f"{str(source)!r} gives no synchronised frame: see `spacevln robot check` and --profile.")
    points = np.array(path)
    low, high = points.min(axis=0) - 6.0, points.max(axis=0) + 6.0
    xs, ys = np.arange(low[0], high[0], 0.05), np.arange(high[1], low[1], -0.05)
    cells = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    picture = np.full((len(ys) * len(xs), 3), 160, np.uint8)
    picture[grid.is_free(cells)] = 255
    picture[grid.is_obstacle(cells)] = 0
    image = picture.reshape(len(ys), len(xs), 3)
    for x, y in path:
        cv2.circle(image, (round((x - low[0]) / 0.05), round((high[1] - y) / 0.05)), 2, (40, 40, 220), -1)
    if not cv2.imwrite(str(out), image):
        raise click.UsageError(f"--out {str(out)!r} cannot be written: give a file that you may write.")
    click.echo(f"map      {out}: {len(path)} frames, {grid.is_free(cells).sum() * 0.0025:.1f} m2 free")


def _observations(source: Path, profile: str) -> Iterator[Observation]:
    from spacevln.environments.playback.log import Log
    from spacevln.environments.robot.bag import read_bag
    from spacevln.environments.robot.profile import load_profile

    if (source / "log.json").exists():
        yield from Log(source)
    else:
        for _, observation in read_bag(source, load_profile(profile)):
            yield observation
