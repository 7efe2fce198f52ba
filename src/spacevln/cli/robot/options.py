"""Which robot, and how it is reached."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from spacevln.environments.robot.profile import RobotProfile

F = TypeVar("F", bound=Callable[..., Any])


def profile_options(command: F) -> F:
    """The profile, and what of it differs today."""
    for option in reversed(
        (
            click.option(
                "--profile", default="generic", show_default=True, help="tx-q1, turtlebot4, generic, or a TOML file of yours."
            ),
            click.option(
                "--transport", type=click.Choice(["dds", "zenoh", "rclpy"]), default=None, help="Instead of the profile's."
            ),
            click.option("--domain", type=click.IntRange(0, 232), default=None, help="ROS_DOMAIN_ID."),
            click.option("--endpoint", default=None, help="Zenoh router, or DDS peers; see docs/robot.md."),
        )
    ):
        command = option(command)
    return command


def profile_from(options: dict[str, Any]) -> RobotProfile:
    """The profile that these options say; takes them out of ``options``.

    Raises:
        UsageError: there is no such profile, or it is wrong.
    """
    from spacevln.environments.robot.profile import load_profile

    profile = load_profile(options.pop("profile"))
    changes = {name: value for name in ("transport", "domain", "endpoint") if (value := options.pop(name)) is not None}
    return profile.model_copy(update=changes)
