"""What the pages say of a run and its episodes, in words and formatted numbers."""

from __future__ import annotations

import json
import os
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from spacevln.recording import ResultFile, RunFile, SummaryFile
from spacevln.viewer.pages.charts import Chart, by_outcome, histogram
from spacevln.viewer.pages.story import Story

Json = dict[str, Any]
SHOWN = (
    ("SR", "SR", "%"), ("SPL", "SPL", "%"), ("OSR", "OSR", "%"), ("NE", "NE", "m"), ("nDTW", "nDTW", "%"), ("SDTW", "SDTW", "%"),
    ("steps", "steps", ""), ("stages", "stages", ""), ("collisions", "collisions", ""),
)  # fmt: skip


def run(file: RunFile) -> Json:
    """The reproduction card."""
    configuration = file.configuration
    return {
        "suite": file.suite,
        "created": file.created.replace("T", " ").replace("+00:00", " UTC"),
        "driver": configuration.get("driver", "agent"),
        "planner": configuration.get("planner", "–"),
        "executor": configuration.get("executor", "–"),
        "command": shlex.join(file.command),
        "version": file.version,
        "revision": file.git_revision,
        "hash": file.configuration_hash,
        "python": file.python,
        "platform": file.platform,
        "packages": ", ".join(f"{name} {version}" for name, version in sorted(file.packages.items())),
        "dataset": sorted(file.dataset.items()),
        "configuration": json.dumps(configuration, indent=2),
        "format": file.format,
    }


def summary(file: SummaryFile) -> Json:
    """Means with their intervals."""
    metrics = []
    for key, name, unit in SHOWN:
        mean = file.metrics.get(key)
        if mean is None:
            continue
        spread = file.intervals.get(key)
        metrics.append(
            {
                "name": f"{name} ({unit})" if unit else name,
                "mean": f"{mean:.1f}",
                "interval": "–" if spread is None else f"{spread[0]:.1f} to {spread[1]:.1f}",
            }
        )
    statuses = ", ".join(f"{count} {status.replace('_', ' ')}" for status, count in file.statuses.items())
    counts = f"{file.rejections} rejected replies, {file.fallbacks} fallbacks, {file.unreachable} unreachable goals"
    return {"metrics": metrics, "statuses": statuses, "counts": counts}


def diagnoses(file: SummaryFile, results: Sequence[ResultFile]) -> list[Json]:
    """Classes of failures, most frequent first."""
    paper = {result.diagnosis.name: result.diagnosis.paper for result in results if result.diagnosis}
    return [{**line, "paper": paper.get(line["name"])} for line in _shares(file.diagnoses, file.episodes)]


def kinds(file: SummaryFile) -> list[Json]:
    """Failures by the paper's kinds."""
    return _shares(file.diagnoses_paper, file.episodes)


def _shares(counts: dict[str, int], episodes: int) -> list[Json]:
    total = sum(counts.values())
    ordered = sorted(((name, count) for name, count in counts.items() if count), key=lambda item: (-item[1], item[0]))
    return [
        {"name": name, "count": count, "share": f"{100 * count / total:.0f} %", "of_all": f"{100 * count / episodes:.0f} %"}
        for name, count in ordered
    ]


def outcome(result: ResultFile | None) -> Json:
    """How an episode ended, as a chip."""
    if result is None:
        return {"kind": "unfinished", "text": "no result"}
    if result.metrics.SR is None:
        return {"kind": "unjudged", "text": result.status.replace("_", " ")}
    return {"kind": "success", "text": "success"} if result.metrics.SR else {"kind": "failure", "text": "failure"}


def line(folder: Path, result: ResultFile | None) -> Json:
    """An episode in the list of a run."""
    pictures = os.listdir(folder / "images") if (folder / "images").is_dir() else []  # noqa: PTH208 - names only: a run has many
    last_view = max((name for name in pictures if name.endswith("_rgb.jpg")), default=None)
    usage = result.usage.values() if result else ()
    metrics = result.metrics if result else None
    diagnosis = result.diagnosis if result else None
    return {
        "id": result.episode_id if result else folder.name,
        "folder": f"episodes/{folder.name}".replace("%", "%25"),
        "task": result.task_text if result else "",
        "outcome": outcome(result),
        "diagnosis": diagnosis.name if diagnosis else None,
        "decisive": diagnosis.step if diagnosis else None,
        "thumbnail": f"images/{last_view}" if last_view else None,
        "thumbnail_text": f"Last view of {result.episode_id if result else folder.name}",
        "geodesic": result.truth.geodesic_m if result and result.truth and result.truth.geodesic_m < float("inf") else None,
        "NE": metrics.NE if metrics else None,
        "SPL": metrics.SPL if metrics else None,
        "steps": metrics.steps if metrics else None,
        "stages": metrics.stages if metrics else None,
        "seconds": result.timing_s if result else None,
        "calls": sum(part.calls for part in usage),
        "usd": sum(part.usd for part in usage),
    }


def columns(*, costs: bool) -> list[Json]:
    """Heads of the list of episodes."""
    names = ["length m", "NE m", "SPL", "steps", "stages", "time s", *(["calls", "USD"] if costs else [])]
    return [{"name": "episode", "number": False}, {"name": "outcome", "number": False}] + [
        {"name": name, "number": True} for name in names
    ]


def episode(folder: Path, result: ResultFile | None, story: Story) -> Json:
    """Head of an episode's page."""
    started = story.started
    chips, metrics = [], []
    if result is not None:
        chips.append(result.status.replace("_", " "))
        chips.append(("forced by " if result.forced_stop else "stop by ") + result.stop_reason.replace("_", " "))
        if result.restarts:
            chips.append(f"restarted {result.restarts} times")
        if result.loaded_memory:
            chips.append("began with an earlier memory")
        metrics = _metrics(result)
    task = result.task_text if result else started.task_text if started else "No task was recorded"
    return {
        "id": result.episode_id if result else started.episode_id if started else folder.name,
        "task": task,
        "kind": result.task_kind if result else started.task_kind if started else "vln",
        "outcome": outcome(result),
        "chips": chips,
        "metrics": metrics,
        "detail": "The episode did not end: this is what was recorded." if result is None else result.detail,
    }


def _metrics(result: ResultFile) -> list[Json]:
    values = result.metrics
    found: list[tuple[str, str | None]] = [
        ("distance to goal", None if values.NE is None else f"{values.NE:.2f} m"),
        ("SPL", None if values.SPL is None else f"{values.SPL:.2f}"),
        ("nDTW", None if values.nDTW is None else f"{values.nDTW:.2f}"),
        ("path", f"{values.path_length:.1f} m"),
        ("shortest path", f"{result.truth.geodesic_m:.1f} m" if result.truth else None),
        ("steps", f"{values.steps} ({values.lookaround_steps} looking around)"),
        ("stages", str(values.stages)),
        ("collisions", str(values.collisions)),
        ("rejections", str(values.rejections)),
        ("fallbacks", str(values.fallbacks)),
        ("time", f"{result.timing_s:.1f} s"),
    ]
    parts = result.usage.values()
    if parts:
        tokens = sum(part.tokens.input_tokens + part.tokens.output_tokens for part in parts)
        found.append(("calls", str(sum(part.calls for part in parts))))
        found.append(("tokens", f"{tokens:,}"))
        found.append(("latency", f"{sum(part.latency_s for part in parts):.1f} s"))
        found.append(("cost", f"{sum(part.usd for part in parts):.4f} USD"))
    return [{"name": name, "value": value} for name, value in found if value is not None]


def charts(results: Sequence[ResultFile]) -> list[Chart]:
    """Charts of a run with more than a few episodes."""
    if len(results) < 5:
        return []
    lengths = [
        (result.truth.geodesic_m, bool(result.metrics.SR))
        for result in results
        if result.truth is not None and result.truth.geodesic_m < float("inf")
    ]
    calls = [result for result in results if result.usage]
    drawn = [
        by_outcome(lengths, "Successes (green) and failures (red) by length of the shortest path [m]", "m"),
        histogram([result.metrics.steps for result in results], "Episodes by steps", "steps", whole=True),
        histogram([result.timing_s for result in results], "Episodes by time [s]", "s"),
        histogram([sum(part.usd for part in result.usage.values()) for result in calls], "Episodes by cost [USD]", "USD"),
        histogram(
            [sum(part.latency_s for part in result.usage.values()) for result in calls],
            "Episodes by latency of their calls [s]",
            "s",
        ),
    ]
    return [chart for chart in drawn if chart is not None]
