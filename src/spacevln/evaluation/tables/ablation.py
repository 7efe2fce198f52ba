"""The rows of the paper's Table 4: their names, their order, and those that do not apply to rules."""

from __future__ import annotations

from collections.abc import Sequence

from spacevln.assembly import ABLATIONS, ComponentSettings, ablation_of, same_programs
from spacevln.evaluation.runs import Run

ABLATION_WORDS = {
    "full": "Full pipeline",
    "-HSM-LLM": "w/o HSM+L-LM",
    "-HSM": "w/o HSM",
    "-LLM": "w/o L-LM",
    "-P-E-SC": "w/o P-SCoT+E-SCoT+SC",
    "-P-SC": "w/o P-SCoT+SC",
    "-P-E": "w/o P-SCoT+E-SCoT",
    "-P": "w/o P-SCoT",
    "-E": "w/o E-SCoT",
}
"""The paper's names of the presets."""

_ORDER = [ABLATION_WORDS[preset] for preset in ABLATIONS if preset != "full"] + [ABLATION_WORDS["full"]]


def preset_of(run: Run) -> str | None:
    """The preset that an agent's run was made with; None where there is none."""
    if run.driver != "agent":
        return None
    return ablation_of(ComponentSettings.model_validate(run.file.configuration.get("components", {})))


def ablation_label(run: Run) -> str | None:
    """The paper's name of a run's row, unless a person gave it another."""
    preset = preset_of(run)
    return None if preset is None or run.label != run.directory.name else ABLATION_WORDS[preset]


def paper_place(method: str) -> int:
    """Place of a row in the paper's order, the full pipeline last; other rows come first."""
    return _ORDER.index(method) if method in _ORDER else -1


def idle_presets(runs: Sequence[Run]) -> dict[str, str]:
    """Presets without a run of their own because they are the program of another one's: rules have no reasoning text.

    Returns:
        The preset that did run, by the one that need not.
    """
    agents = [run for run in runs if run.driver == "agent"]
    reasoners = {(run.file.configuration.get("planner"), run.file.configuration.get("executor")) for run in agents}
    if len(reasoners) != 1:
        return {}
    present = {preset_of(run) for run in agents}
    same = same_programs(*map(str, reasoners.pop()))
    return {preset: other for preset, other in same.items() if preset not in present and other in present}


def idle_note(preset: str, other: str) -> str:
    """One line for below the table."""
    return f"{ABLATION_WORDS[preset]}: does not apply, rules have no reasoning text; the same program as {ABLATION_WORDS[other]}"
