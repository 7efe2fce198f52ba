"""The paper's Table 4 as presets, and what of a run its configuration's hash holds."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from pydantic import ValidationError

from spacevln.agent import Components
from spacevln.assembly import ABLATIONS, ComponentSettings, Configuration, PromptOptions, ablation_of, prompt_settings
from spacevln.reasoning.spatial_cot import Layout, PromptSettings

TABLE_4 = {  # HSM, L-LM, P-SCoT, E-SCoT, SC
    "-HSM-LLM": "00111",
    "-HSM": "01111",
    "-LLM": "10111",
    "-P-E-SC": "11000",
    "-P-SC": "11010",
    "-P-E": "11001",
    "-P": "11011",
    "-E": "11101",
    "full": "11111",
}


def test_the_presets_are_the_nine_rows_of_the_papers_table_4() -> None:
    def row(components: ComponentSettings) -> str:
        switches = (components.hsm, components.landmark_memory, components.planner_scot, components.executor_scot)
        return "".join(str(int(switch)) for switch in (*switches, components.stagewise))

    assert {name: row(components) for name, components in ABLATIONS.items()} == TABLE_4


@pytest.mark.parametrize("name", TABLE_4)
def test_a_row_is_known_by_its_components(name: str) -> None:
    assert ablation_of(ABLATIONS[name]) == name


def test_other_components_are_no_row() -> None:
    assert ablation_of(ComponentSettings(stagewise=False)) is None


def test_every_row_and_every_prompt_setting_has_its_own_hash() -> None:
    changes: list[dict[str, Any]] = [{"view_count": 6}, {"layout": "mosaic"}, {"view_width_px": 384}, {"jpeg_quality": 50}]
    changes += [{"forward_width_px": 384}, {"show_detections": False}, {"turn_steps": 2}]
    runs = [Configuration(components=components) for components in ABLATIONS.values()]
    runs += [Configuration(prompts=PromptOptions.model_validate(change)) for change in changes]
    assert len({run.hash for run in runs}) == len(runs)


def test_settings_reach_prompts_and_agent_alike() -> None:
    configuration = Configuration(components=ABLATIONS["-P-SC"], prompts=PromptOptions(view_count=6, layout=Layout.MOSAIC))
    settings = prompt_settings(configuration)
    assert (settings.planner_scot, settings.stagewise, settings.view_count, settings.layout) == (False, False, 6, "mosaic")
    assert prompt_settings(Configuration()) == PromptSettings()
    switches = {field.name for field in dataclasses.fields(Components)}
    assert switches == set(ComponentSettings.model_fields)
    assert {field.name for field in dataclasses.fields(PromptSettings)} == switches | set(PromptOptions.model_fields)


@pytest.mark.parametrize(
    "change", [{"jpeg_quality": 0}, {"view_width_px": 10}, {"view_count": 0}, {"layout": "row"}, {"turn_steps": 9}]
)
def test_impossible_prompt_settings_are_refused(change: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        PromptOptions.model_validate(change)
