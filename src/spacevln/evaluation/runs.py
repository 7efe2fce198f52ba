"""Runs read back from their directories: results, resources, and metrics over episodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from spacevln.core import UsageError
from spacevln.evaluation import resources
from spacevln.evaluation.diagnosis import CLASSES, PAPER_KINDS, failure_class, failure_kind
from spacevln.evaluation.resources import ResourcesFile
from spacevln.recording import ResultFile, RunFile, read_file, read_result


@dataclass(frozen=True, slots=True)
class Run:
    """A run directory.

    Args:
        label: how tables call it.
        directory: where it lies.
        file: its ``run.json``.
        results: of its episodes, by id.
        resources: of its episodes, where they were measured.
    """

    label: str
    directory: Path
    file: RunFile
    results: Mapping[str, ResultFile]
    resources: Mapping[str, ResourcesFile]

    @property
    def suite(self) -> str:
        """Name of the suite, e.g. ``"houses-vln"``."""
        return self.file.suite.partition(" ")[0]

    @property
    def driver(self) -> str:
        """``"agent"``, or which baseline."""
        return str(self.file.configuration.get("driver", "agent"))

    def values(self, metric: str) -> dict[str, float]:
        """A metric of every episode that has it, by id, in the unit of tables (percent for shares).

        Raises:
            UsageError: there is no such metric.
        """
        if metric not in EPISODE_METRICS:
            raise UsageError(f"Unknown metric {metric!r}: known are {', '.join(EPISODE_METRICS)}.")
        read = EPISODE_METRICS[metric]
        found = {name: read(result, self.resources.get(name)) for name, result in self.results.items()}
        return {name: value for name, value in found.items() if value is not None}

    def tagged(self, tag: str, value: object) -> Run:
        """The same run with the episodes that have a value of a tag."""
        kept = {name: result for name, result in self.results.items() if result.tags.get(tag) == value}
        return replace(self, results=kept)


def read_run(text: str) -> Run:
    """The run of ``DIR`` or ``LABEL=DIR``.

    Raises:
        RecordError: it is no run directory, or a file of it is damaged.
        UsageError: it holds no result.
    """
    label, equals, path = text.partition("=")
    directory = Path(path if equals else text)
    file = read_file(directory / "run.json", RunFile)
    results: dict[str, ResultFile] = {}
    measured: dict[str, ResourcesFile] = {}
    for folder in sorted((directory / "episodes").glob("*")):
        result = read_result(folder)
        if result is None or result.status == "interrupted":
            continue
        results[result.episode_id] = result
        if (folder / resources.NAME).exists():
            measured[result.episode_id] = read_file(folder / resources.NAME, ResourcesFile)
    if not results:
        raise UsageError(f"{str(directory)!r} holds no result: give a run that has finished at least one episode.")
    return Run(label if equals else directory.name, directory, file, results, measured)


Read = Callable[[ResultFile, ResourcesFile | None], float | None]


def _metric(name: str, scale: float = 1.0) -> Read:
    def read(result: ResultFile, _: ResourcesFile | None) -> float | None:
        value = getattr(result.metrics, name)
        return None if value is None else scale * float(value)

    return read


def _per_call(role: str) -> Read:
    def read(_: ResultFile, used: ResourcesFile | None) -> float | None:
        calls = getattr(used, f"{role}_calls", 0)
        return getattr(used, f"{role}_s") / calls if calls else None

    return read


def _failed_as(name: str, of: Callable[[ResultFile], str | None]) -> Read:
    return lambda result, _: None if result.metrics.SR is None else 100.0 * (of(result) == name)


def _unusable_share(result: ResultFile) -> float | None:
    calls = sum(part.calls for part in result.usage.values())
    return 100.0 * sum(part.unusable + part.failed for part in result.usage.values()) / calls if calls else None


def _sum(read: Callable[[ResultFile], float]) -> Read:
    """Of usage; episodes without a call of a model have none."""
    return lambda result, _: read(result) if result.usage else None


EPISODE_METRICS: dict[str, Read] = {
    **{
        name: _metric(name, 100.0)
        for name in (
            "SR",
            "SPL",
            "OSR",
            "nDTW",
            "SDTW",
            "SoftSPL",
            "SR_no_stop",
            "SPL_no_stop",
            "SR_viewpoint",
            "SR_viewpoint_1m",
        )
    },
    **{
        name: _metric(name)
        for name in (
            "NE",
            "oracle_NE",
            "path_length",
            "steps",
            "lookaround_steps",
            "align_steps",
            "collisions",
            "stages",
            "rejections",
            "fallbacks",
        )
    },
    "SR_unforced": lambda result, _: None if result.forced_stop or result.metrics.SR is None else 100.0 * result.metrics.SR,
    "forced": lambda result, _: 100.0 * result.forced_stop,
    "restarts": lambda result, _: float(result.restarts),
    "minutes": lambda result, _: result.timing_s / 60,
    "planner_s": _per_call("planner"),
    "executor_s": _per_call("executor"),
    "cpu_s": lambda _, used: None if used is None else used.cpu_s,
    "memory_gb": lambda _, used: None if used is None else used.peak_memory_mb / 1024,
    "gpu_gb": lambda _, used: None if used is None or used.peak_gpu_mb is None else used.peak_gpu_mb / 1024,
    "calls": _sum(lambda result: sum(part.calls for part in result.usage.values())),
    "input_tokens": _sum(lambda result: sum(part.tokens.input_tokens for part in result.usage.values())),
    "cached_tokens": _sum(lambda result: sum(part.tokens.cached_tokens for part in result.usage.values())),
    "output_tokens": _sum(lambda result: sum(part.tokens.output_tokens for part in result.usage.values())),
    "unusable_share": lambda result, _: _unusable_share(result),
    "usd": lambda result, _: _usd(result),
    **{name: _failed_as(name, failure_kind) for name in PAPER_KINDS},
    **{name: _failed_as(name, failure_class) for name in CLASSES},
}
"""Every metric of an episode by its name: percent for shares and classes of failures, seconds per call, gigabytes."""


def _usd(result: ResultFile) -> float | None:
    """Cost; None without calls, and where a price is not known."""
    if not result.usage or any(part.unpriced for part in result.usage.values()):
        return None
    return sum(part.usd for part in result.usage.values())
