"""Which columns each kind of table has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from spacevln.evaluation.diagnosis import CLASSES, PAPER_KINDS

HEADERS: dict[str, tuple[str, str]] = {
    "NE": ("NE", "down"),
    "oracle_NE": ("oracle NE", "down"),
    "OSR": ("OSR", "up"),
    "SR": ("SR", "up"),
    "SPL": ("SPL", "up"),
    "nDTW": ("nDTW", "up"),
    "SDTW": ("SDTW", "up"),
    "SoftSPL": ("SoftSPL", "up"),
    "SR_no_stop": ("SR without STOP", "up"),
    "SR_unforced": ("SR unforced", "up"),
    "SR_viewpoint": ("SR 0.25 m view point", "up"),
    "SR_viewpoint_1m": ("SR 1 m view point", "up"),
    "steps": ("Steps", "down"),
    "lookaround_steps": ("look-around steps", ""),
    "collisions": ("collisions", "down"),
    "minutes": ("Time (min)", "down"),
    "gpu_gb": ("GPU (GB)", "down"),
    "memory_gb": ("Memory (GB)", "down"),
    "planner_s": ("Planner (s)", "down"),
    "executor_s": ("Executor (s)", "down"),
    "usd": ("Cost (USD)", "down"),
    "calls": ("calls", "down"),
    "input_tokens": ("input tokens", "down"),
    "cached_tokens": ("cached tokens", "up"),
    "output_tokens": ("output tokens", "down"),
    "unusable_share": ("unusable replies (%)", "down"),
    "forced": ("STOP forced (%)", "down"),
    "rejections": ("rejections", "down"),
    "fallbacks": ("fallbacks", "down"),
    "restarts": ("restarts", "down"),
    **{name: (f"{name} (%)", "") for name in (*CLASSES, *PAPER_KINDS)},
}


@dataclass(frozen=True, slots=True)
class Shape:
    """Which columns a table has.

    Args:
        metrics: of every block.
        flags: check marks.
        digits: where they are not 1.
        by_area: blocks are the areas that episodes are tagged with, and all of them, instead of suites.
        ranked_groups: groups of published rows among which best values are marked; none = all.
    """

    metrics: tuple[str, ...]
    flags: tuple[str, ...] = ()
    digits: Mapping[str, int] = field(default_factory=dict)
    by_area: bool = False
    ranked_groups: tuple[str, ...] = ()


SHAPES: dict[str, Shape] = {
    "vln": Shape(("NE", "OSR", "SR", "SPL"), ranked_groups=("Zero-shot",)),
    "gn-bench": Shape(("NE", "OSR", "SR", "SPL"), ("TF", "ZS")),
    "ovon": Shape(("SR", "SPL"), ("TF",)),
    "ablation": Shape(("NE", "OSR", "SR", "SPL", "steps"), ("HSM", "L-LM", "P-SCoT", "E-SCoT", "SC")),
    "robot": Shape(("NE", "SR"), digits={"NE": 2, "SR": 0}, by_area=True),
    "runtime": Shape(("OSR", "SR", "minutes", "gpu_gb")),
    "deployment": Shape(
        ("OSR", "SR", "planner_s", "executor_s", "minutes", "steps", "usd"),
        digits={"planner_s": 2, "executor_s": 2, "minutes": 2, "usd": 3},
    ),
    "full": Shape(
        (
            "SR",
            "SPL",
            "OSR",
            "NE",
            "nDTW",
            "SDTW",
            "SoftSPL",
            "SR_no_stop",
            "SR_unforced",
            "SR_viewpoint",
            "steps",
            "lookaround_steps",
            "collisions",
            "minutes",
            "memory_gb",
        ),
        digits={"minutes": 2, "memory_gb": 2},
    ),
    "endings": Shape(("SR", "SR_unforced", "SR_no_stop", "forced", "rejections", "fallbacks", "restarts")),
    "failures": Shape(("SR", *CLASSES)),
    "errors": Shape(("SR", *PAPER_KINDS)),
    "calls": Shape(
        ("calls", "unusable_share", "input_tokens", "cached_tokens", "output_tokens", "planner_s", "executor_s", "usd"),
        digits={"planner_s": 2, "executor_s": 2, "usd": 4},
    ),
}
"""Shapes of tables: the paper's Tables 1 to 4, its robot, runtime and deployment tables, and ours: every metric, how episodes
ended (rates per episode), failures by diagnosis and by the paper's kinds of errors, and what the calls of models came to."""

TITLES = {
    "full": "Every metric.",
    "endings": "How episodes ended; rejections, fallbacks and restarts per episode.",
    "failures": "Failed episodes by diagnosis, percent of all episodes.",
    "errors": "Failed episodes by the paper's kinds of errors, percent of all episodes.",
    "calls": "Calls of chat models per episode; seconds per call.",
}
