"""What the benchmarks' sources disagree about, as explicit values: the paper's settings and the official ones, side by side.

A preset fills a :class:`~.configuration.HabitatSettings` or :class:`~.configuration.GNBenchSettings`, whose values are recorded
with every run. Sources: VLN-CE's, OVON's and GN-Bench's task configurations, the paper's appendix, the authors' configurations;
docs/habitat.md and docs/benchmarks/gn-bench.md list who says what.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spacevln.control.budgets import GN_BENCH_STEPS
from spacevln.core import UnknownNameError


@dataclass(frozen=True, slots=True)
class BenchmarkPreset:
    """Values of one source for one benchmark.

    Args:
        values: of the settings of the benchmark's simulator.
        step_budget: environment steps per episode, STOP included.
    """

    values: Mapping[str, Any]
    step_budget: int


_LOCOBOT: Mapping[str, Any] = {
    "width_px": 640,
    "height_px": 480,
    "hfov_deg": 79.0,
    "camera_height_m": 0.88,
    "agent_height_m": 0.88,
    "agent_radius_m": 0.1,
    "cell_height_m": 0.2,
    "max_climb_m": 0.2,
    "turn_deg": 30.0,
    "sliding": True,
    "depth_min_m": 0.5,
    "depth_max_m": 5.0,
}
_VLN_CE: Mapping[str, Any] = {
    **_LOCOBOT,
    "width_px": 256,
    "height_px": 256,
    "hfov_deg": 90.0,
    "camera_height_m": 1.25,
    "agent_height_m": 1.5,
    "turn_deg": 15.0,
    "depth_min_m": 0.0,
    "depth_max_m": 10.0,
}
_OVON: Mapping[str, Any] = {**_LOCOBOT, "agent_radius_m": 0.18, "cell_height_m": 0.05, "max_climb_m": 0.1, "sliding": False}
_STRETCH: Mapping[str, Any] = {
    **_OVON,
    "width_px": 360,
    "height_px": 640,
    "hfov_deg": 42.0,
    "camera_height_m": 1.31,
    "agent_height_m": 1.41,
    "agent_radius_m": 0.17,
}

_SPLATS: Mapping[str, Any] = {
    "width_px": 640,
    "height_px": 480,
    "hfov_deg": 79.0,
    "camera_height_m": 0.88,
    "turn_deg": 30.0,
    "depth_min_m": 0.5,
    "depth_max_m": 5.0,
}
_GN_BENCH: Mapping[str, Any] = {
    "width_px": 480,
    "height_px": 360,
    "hfov_deg": 2 * math.degrees(math.atan(math.tan(math.radians(70.0) / 2) * 480 / 360)),  # its 70 is drawn as the vertical one
    "camera_height_m": 1.3,
    "turn_deg": 15.0,
    "depth_min_m": 0.0,
    "depth_max_m": 10.0,
}

PRESETS: Mapping[str, Mapping[str, BenchmarkPreset]] = {
    "r2r-ce": {"paper": BenchmarkPreset(_LOCOBOT, 260), "official": BenchmarkPreset(_VLN_CE, 500)},
    "rxr-ce": {
        "paper": BenchmarkPreset(_LOCOBOT, 260),
        "official": BenchmarkPreset({**_LOCOBOT, "agent_radius_m": 0.18, "sliding": False}, 500),
    },
    "hm3d-ovon": {"paper": BenchmarkPreset(_OVON, 280), "official": BenchmarkPreset(_STRETCH, 500)},
    "gn-bench": {"paper": BenchmarkPreset(_SPLATS, GN_BENCH_STEPS), "official": BenchmarkPreset(_GN_BENCH, 500)},
}
"""By suite and source, the default first."""


def preset_of(suite: str, name: str) -> BenchmarkPreset:
    """The preset of a suite.

    Raises:
        UnknownNameError: no bridged simulator runs the suite, or there is no such preset.
    """
    if suite not in PRESETS:
        raise UnknownNameError("suite of a bridged simulator", suite, PRESETS)
    if name not in PRESETS[suite]:
        raise UnknownNameError(f"preset of {suite}", name, PRESETS[suite])
    return PRESETS[suite][name]
