"""Options that ``run`` and ``bench`` share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from spacevln.cli.detector_options import detector_from, detector_options
from spacevln.cli.model_options import REASONERS, access_options, choice_options, models_from
from spacevln.cli.option_groups import option_group
from spacevln.cli.prompt_options import ablation_options, components_from, prompt_options, prompts_from

if TYPE_CHECKING:
    from spacevln.assembly import Configuration


agent_options = option_group(
    click.option("--planner", type=REASONERS, default=None, help="Who reasons; vlm where --model is given, else rules."),
    click.option("--executor", type=REASONERS, default=None, help="Who acts, if not the planner's kind."),
    choice_options,
    access_options,
    ablation_options,
    prompt_options,
    click.option("--renderer", type=click.Choice(["auto", "gl", "raycast"]), default="auto", show_default=True),
    click.option("--sliding/--no-sliding", default=True, show_default=True, help="Slide along obstacles, as VLN-CE does."),
    detector_options,
    click.option(
        "--arrival-sightings",
        type=click.IntRange(min=1),
        default=1,
        show_default=True,
        help="Pictures that must show a landmark before it counts as reached (temporal verification).",
    ),
    click.option(
        "--glimpses/--no-glimpses",
        default=True,
        show_default=True,
        help="Of object goals, tell the rule planner what the images on the way show, too; models see them anyway.",
    ),
    click.option(
        "--short-looks/--whole-looks",
        default=True,
        show_default=True,
        help="Of object goals with glimpses, look only to where the map knows no floor yet; or once around, as the paper does.",
    ),
    click.option("--steps", type=click.IntRange(min=1), default=None, help="Step budget, STOP included."),
    click.option("--chase", is_flag=True, help="Record a camera that follows the robot, too (embedded houses)."),
    click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=None, help="Run directory."),
)
"""Who reasons, with which components, in which world, and where the record goes."""


Driver = Literal["agent", "random", "forward", "frontier", "oracle", "reference"]
Reasoner = Literal["rules", "vlm"]


def configuration_from(options: dict[str, Any], driver: Driver = "agent") -> Configuration:
    """The configuration that these options say, with the renderer that this machine will really use."""
    from spacevln.assembly import Configuration, HousesSettings
    from spacevln.environments.houses.rendering import renderer_info

    models = models_from(options)
    planner: Reasoner = options["planner"] or ("rules" if models is None else "vlm")
    executor: Reasoner = options["executor"] or planner
    _check_models(planner, executor, asked=models is not None)
    return Configuration(
        driver=driver,
        environment=HousesSettings(renderer=renderer_info(options["renderer"]).name, sliding=options["sliding"]),
        detector=detector_from(options),
        components=components_from(options, planner, executor),
        planner=planner,
        executor=executor,
        models=models,
        prompts=prompts_from(options),
        step_budget=options["steps"],
        arrival_sightings=options["arrival_sightings"],
        glimpses=options["glimpses"],
        short_looks=options["short_looks"],
    )


def _check_models(planner: str, executor: str, *, asked: bool) -> None:
    needed = "vlm" in (planner, executor)
    if needed and not asked:
        raise click.UsageError(
            "A model-written planner or executor needs --model, e.g. --model paper-qwen3.5, --model ollama:qwen3-vl:8b, "
            "or --model NAME --base-url URL."
        )
    if asked and not needed:
        raise click.UsageError("--model is given and nobody asks it: leave --planner rules out, or leave --model out.")
