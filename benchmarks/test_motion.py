"""One step of the disc among the obstacles of a large house."""

from __future__ import annotations

from typing import Any

import numpy as np

from spacevln.environments.houses.walking.motion import sweep_disc


def test_a_step_among_hundreds_of_obstacles(benchmark: Any) -> None:
    rng = np.random.default_rng(0)
    centres, halves, yaws = rng.uniform(-9, 9, (300, 2)), rng.uniform(0.1, 0.5, (300, 2)), rng.uniform(0, 6, 300)
    boxes = np.column_stack([centres, np.cos(yaws), np.sin(yaws), halves])
    discs = np.empty((0, 3))
    sweep_disc((0, 0), (0.25, 0), boxes, discs)
    benchmark(sweep_disc, (0, 0), (0.25, 0), boxes, discs)
