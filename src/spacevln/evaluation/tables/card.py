"""The reproduction card of a run: what someone needs to run it again."""

from __future__ import annotations

from typing import Any

from spacevln.evaluation.runs import Run
from spacevln.models import ModelChoice, price_of


def reproduction_card(run: Run) -> str:
    """Versions, configuration, data, seeds, models, prices, hardware and date of a run, as Markdown."""
    file, configuration = run.file, run.file.configuration
    lines = [
        f"### {run.label}",
        "",
        f"- command: `{' '.join(file.command)}`",
        f"- date: {file.created}",
        f"- spacevln {file.version}, revision {file.git_revision or 'of an installed package'}",
        f"- Python {file.python} on {file.platform}",
        f"- packages: {', '.join(f'{name} {version}' for name, version in sorted(file.packages.items()))}",
        f"- suite: {file.suite}, {len(run.results)} episodes",
        f"- data: {_data(run)}",
        f"- configuration: {file.configuration_hash}",
        f"- seeds: {_seeds(configuration)}",
        f"- models: {_models(configuration)}",
        f"- hardware: {_hardware(run)}",
    ]
    return "\n".join(lines) + "\n"


def _data(run: Run) -> str:
    if not run.file.dataset:
        return "made by the program from the seeds in the suite's name"
    return ", ".join(f"{name} sha256 {digest}" for name, digest in run.file.dataset.items())


def _seeds(configuration: dict[str, Any]) -> str:
    detector = configuration.get("detector", {})
    return f"detector {detector.get('seed', 0)}; everything else is a function of the episode's id"


def _models(configuration: dict[str, Any]) -> str:
    """Names, settings and prices of the chat models."""
    models = configuration.get("models")
    if not models:
        return "none, rules reason"
    parts = []
    for role, choice in models.items():
        kept = {key: value for key, value in choice.items() if key not in ("model", "price") and value is not None}
        price = price_of(ModelChoice.model_validate(choice))
        settings = ", ".join(f"{key} {value}" for key, value in kept.items())
        parts.append(f"{role} {choice['model']} ({settings}; price {'not known' if price is None else price})")
    return "; ".join(parts)


def _hardware(run: Run) -> str:
    names = sorted({name for used in run.resources.values() for name in (used.processor, used.gpu) if name})
    return ", ".join(names) or "not recorded"
