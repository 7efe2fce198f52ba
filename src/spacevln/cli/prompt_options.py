"""Options about ablations and prompts: which components are on, and what a model is shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.option_groups import option_group

if TYPE_CHECKING:
    from spacevln.assembly import ComponentSettings, PromptOptions

COMPONENTS = ("hsm", "landmark_memory", "planner_scot", "executor_scot", "stagewise")
PRESETS = ("paper", "full", "-HSM-LLM", "-HSM", "-LLM", "-P-E-SC", "-P-SC", "-P-E", "-P", "-E")
LOOKAROUND_VIEWS = 12  # of a simulated body, which turns by 30 degrees


ablation_options = option_group(
    click.option(
        "--preset",
        type=click.Choice(PRESETS),
        default=None,
        help="A row of the paper's Table 4 by what it leaves out (LLM = Local Landmark Memory), or its faithful mode.",
    ),
    click.option("--without", multiple=True, type=click.Choice(COMPONENTS), help="Switch a component off (ablation)."),
)
"""Which components are on."""

_WIDTH = click.IntRange(64, 4096)
prompt_options = option_group(
    click.option("--views", type=click.IntRange(min=1), default=None, help="Views shown to the planner.  [default: 12]"),
    click.option("--layout", type=click.Choice(["separate", "mosaic"]), default=None, help="Of the views."),
    click.option("--view-width", type=_WIDTH, default=None, metavar="PX", help="Of a view.  [default: 512]"),
    click.option("--forward-width", type=_WIDTH, default=None, metavar="PX", help="Of the front view.  [default: 512]"),
    click.option("--jpeg-quality", type=click.IntRange(1, 100), default=None, help="Of all views.  [default: 75]"),
    click.option("--detections/--no-detections", default=None, help="Show detections in the planner's views."),
)
"""What a model is shown."""


def components_from(options: dict[str, Any], planner: str, executor: str) -> ComponentSettings:
    """The components that ``--preset`` and ``--without`` leave on."""
    from spacevln.assembly import ABLATIONS, PAPER

    preset = options["preset"]
    if preset == PAPER and "rules" in (planner, executor):
        raise click.UsageError("--preset paper means a model-written planner and executor: add --model, leave rules out.")
    components = ABLATIONS["full" if preset in (None, PAPER) else preset]
    components = components.model_copy(update=dict.fromkeys(options["without"], False))
    for role, kind, scot in (("planner", planner, components.planner_scot), ("executor", executor, components.executor_scot)):
        if kind == "rules" and not scot:
            click.echo(
                f"note     the {role}'s Spatial-CoT is not applicable to rules: switching it off changes nothing", err=True
            )
    return components


def prompts_from(options: dict[str, Any]) -> PromptOptions:
    """What a model is shown."""
    from spacevln.assembly import PromptOptions

    if options["views"] is not None and LOOKAROUND_VIEWS % options["views"]:
        raise click.UsageError(
            f"--views {options['views']} does not divide the {LOOKAROUND_VIEWS} of a look-around: give 1, 2, 3, 4, 6 or 12."
        )
    given = {
        "view_count": options["views"],
        "layout": options["layout"],
        "view_width_px": options["view_width"],
        "forward_width_px": options["forward_width"],
        "jpeg_quality": options["jpeg_quality"],
        "show_detections": options["detections"],
    }
    return PromptOptions.model_validate({name: value for name, value in given.items() if value is not None})
