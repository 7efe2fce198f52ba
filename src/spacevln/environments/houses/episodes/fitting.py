"""Fits the weights of :mod:`.weights` to R2R's statistics by maximum entropy, on houses of the dev range only.

``python -m spacevln.environments.houses.episodes.fitting 0 400`` rewrites ``weights.json`` beside this file.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from spacevln.environments.houses.episodes.episode import Split
from spacevln.environments.houses.episodes.generate import episode_rng, features, pool_of
from spacevln.environments.houses.episodes.grounds import Grounds
from spacevln.environments.houses.episodes.weights import targets
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.plan import House

Float = NDArray[np.float64]
_STEADY = 0.02  # pull of the weights towards zero, per house


def fit(pools: list[list[dict[str, float]]]) -> dict[str, float]:
    """Weights under which the expected features of a choice from each pool meet the targets on average."""
    wanted = targets()
    names = sorted(wanted)
    goal = np.array([wanted[name] for name in names])
    matrices = [np.array([[f.get(name, 0.0) for name in names] for f in pool]) for pool in pools if pool]
    scale = np.maximum(goal * (1.0 - np.minimum(goal, 0.95)), 0.004)  # rare templates must be met as closely, relatively

    def loss(theta: Float) -> tuple[float, Float]:
        value, slope = -float(theta @ goal) * len(matrices), -goal * len(matrices)
        for matrix in matrices:
            score = matrix @ theta
            top = score.max()
            p = np.exp(score - top)
            value += top + float(np.log(p.sum()))
            slope = slope + (p / p.sum()) @ matrix
        value += 0.5 * _STEADY * len(matrices) * float((scale * theta**2).sum())
        return value / len(matrices), (slope + _STEADY * len(matrices) * scale * theta) / len(matrices)

    theta = minimize(loss, np.zeros(len(names)), jac=True, method="L-BFGS-B", options={"maxiter": 500}).x
    return {name: round(float(w), 3) for name, w in zip(names, theta, strict=True)}


def pools(seeds: Iterable[int], split: Split, houses: Callable[[int], House] = build_house) -> list[list[dict[str, float]]]:
    """Features of every candidate instruction of the houses."""
    out = []
    for seed in seeds:
        grounds = Grounds(houses(seed))
        found = pool_of(grounds, split, episode_rng(grounds.house, 0, split))
        out.append([features(grounds.topology, candidate) for candidate in found])
    return out


def main() -> None:
    """Fit both splits on house seeds A..B-1 and write them down."""
    first, end = int(sys.argv[1]), int(sys.argv[2])
    splits: tuple[Split, ...] = ("dev", "test")
    fitted = {split: fit(pools(range(first, end), split)) for split in splits}
    path = Path(__file__).with_name("weights.json")
    path.write_text(json.dumps(fitted, indent=1, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
