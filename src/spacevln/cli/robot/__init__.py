"""``spacevln robot``: the agent on a ROS 2 robot."""

from __future__ import annotations

import click

from spacevln.cli.robot.bench import bench, routes
from spacevln.cli.robot.check import check
from spacevln.cli.robot.demo import demo
from spacevln.cli.robot.drive import run
from spacevln.cli.robot.recording import map_log, record, teleop_scan

__all__ = ["robot"]


@click.group()
def robot() -> None:
    """Drive a ROS 2 robot, with or without a ROS installation here.

    \b
    spacevln robot check --profile turtlebot4     sensors, rates, clocks, extrinsics: what is wrong and how to mend it
    spacevln robot run --instruction "..."        follow an instruction; space stops, r resumes
    spacevln robot record --out DIR               a posed RGB-D log of what the robot sees
    spacevln robot teleop-scan --out DIR          drive by hand, the robot looks around where you say
    spacevln robot map LOG                        the map of a log or of a ROS 2 bag (MCAP)
    spacevln robot bench ROUTES.yaml              many instructions, a table of the paper's shape
    spacevln robot routes ROUTES.yaml             the paper's 50 instructions, in embedded houses
    spacevln robot demo                           a simulated robot in an embedded house, over the real transport
    """  # noqa: D301 - click reads the backspace as "keep these lines"


robot.add_command(run)
robot.add_command(check)
robot.add_command(record)
robot.add_command(teleop_scan)
robot.add_command(map_log)
robot.add_command(bench)
robot.add_command(routes)
robot.add_command(demo)
