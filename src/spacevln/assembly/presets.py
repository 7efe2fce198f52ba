"""Named settings of the components: the nine rows of the paper's Table 4, and the faithful mode."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from spacevln.assembly.configuration import ComponentSettings

ABLATIONS: Mapping[str, ComponentSettings] = MappingProxyType(
    {
        "full": ComponentSettings(),
        "-HSM-LLM": ComponentSettings(hsm=False, landmark_memory=False),
        "-HSM": ComponentSettings(hsm=False),
        "-LLM": ComponentSettings(landmark_memory=False),
        "-P-E-SC": ComponentSettings(planner_scot=False, executor_scot=False, stagewise=False),
        "-P-SC": ComponentSettings(planner_scot=False, stagewise=False),
        "-P-E": ComponentSettings(planner_scot=False, executor_scot=False),
        "-P": ComponentSettings(planner_scot=False),
        "-E": ComponentSettings(executor_scot=False),
    }
)
"""Rows of Table 4 by what they leave out: HSM, LLM (Local Landmark Memory), P and E (planner and executor Spatial-CoT), SC
(stagewise control)."""

PAPER = "paper"
"""Faithful mode: all components, planner and executor written by models, prompts as their defaults (DESIGN 6)."""


def ablation_of(components: ComponentSettings) -> str | None:
    """Row of Table 4 with these components; None when it is none of them."""
    return next((name for name, row in ABLATIONS.items() if row == components), None)


def same_programs(planner: str, executor: str) -> dict[str, str]:
    """Presets that are another preset's program, by name: rules have no reasoning text that one could leave out.

    Args:
        planner, executor: who reasons, ``"rules"`` or ``"vlm"``.
    """
    textless = {"planner_scot": planner == "rules", "executor_scot": executor == "rules"}
    idle = {switch: True for switch, rules in textless.items() if rules}
    first: dict[ComponentSettings, str] = {}
    same: dict[str, str] = {}
    for name, components in ABLATIONS.items():
        program = components.model_copy(update=idle)
        if first.setdefault(program, name) != name:
            same[name] = first[program]
    return same
