"""Options that ``run`` and ``bench`` share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import click

if TYPE_CHECKING:
    from spacevln.assembly import Configuration

F = TypeVar("F", bound=Callable[..., Any])

COMPONENTS = ("hsm", "landmark_memory", "planner_scot", "executor_scot", "stagewise")


def agent_options(command: F) -> F:
    """Who reasons, with which components, in which world, and where the record goes."""
    for option in reversed(
        (
            click.option("--planner", type=click.Choice(["rules"]), default="rules", show_default=True, help="Who reasons."),
            click.option("--without", multiple=True, type=click.Choice(COMPONENTS), help="Switch a component off (ablation)."),
            click.option("--renderer", type=click.Choice(["auto", "gl", "raycast"]), default="auto", show_default=True),
            click.option(
                "--sliding/--no-sliding", default=True, show_default=True, help="Slide along obstacles, as VLN-CE does."
            ),
            click.option(
                "--miss-rate", type=click.FloatRange(0, 1), default=0.0, help="Share of instances the detector overlooks."
            ),
            click.option("--confusion-rate", type=click.FloatRange(0, 1), default=0.0, help="Share it calls by a similar name."),
            click.option("--steps", type=click.IntRange(min=1), default=None, help="Step budget, STOP included."),
            click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=None, help="Run directory."),
        )
    ):
        command = option(command)
    return command


Driver = Literal["agent", "random", "forward", "oracle"]


def configuration_from(options: dict[str, Any], driver: Driver = "agent") -> Configuration:
    """The configuration that these options say, with the renderer that this machine will really use."""
    from spacevln.assembly import (
        ComponentSettings,
        Configuration,
        HousesSettings,
        LabelDetectorSettings,
    )
    from spacevln.environments.houses.rendering import renderer_info

    return Configuration(
        driver=driver,
        environment=HousesSettings(renderer=renderer_info(options["renderer"]).name, sliding=options["sliding"]),
        detector=LabelDetectorSettings(miss_rate=options["miss_rate"], confusion_rate=options["confusion_rate"]),
        components=ComponentSettings(**dict.fromkeys(options["without"], False)),
        planner=options["planner"],
        step_budget=options["steps"],
    )
