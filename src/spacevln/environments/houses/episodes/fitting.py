"""Fits the weights of :mod:`.weights` to R2R's statistics by maximum entropy, on houses of the dev range only.

``python -m spacevln.environments.houses.episodes.fitting 0 400`` rewrites ``weights.json`` beside this file.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from spacevln.environments.houses.episodes.episode import Split
from spacevln.environments.houses.episodes.generate import episode_rng, features, pool_of
from spacevln.environments.houses.episodes.grounds import Grounds
from spacevln.environments.houses.episodes.realise import realise
from spacevln.environments.houses.episodes.weights import targets
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.plan import House

Float = NDArray[np.float64]
_STEADY = 0.04  # pull of the weights towards zero, per house


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


def pools(seeds: Iterable[int], houses: Callable[[int], House] = build_house) -> dict[Split, list[list[dict[str, float]]]]:
    """Features of every candidate instruction of the houses, worded with the phrases of each split."""
    out: dict[Split, list[list[dict[str, float]]]] = {"dev": [], "test": []}
    for seed in seeds:
        grounds = Grounds(houses(seed))
        rng = episode_rng(grounds.house, 0, "dev")
        found = pool_of(grounds, "dev", rng)
        for split, rows in out.items():
            worded = [replace(candidate, text=realise(candidate.clauses, split, rng)) for candidate in found]
            rows.append([features(grounds.topology, candidate) for candidate in worded])
    return out


def main() -> None:
    """Fit both splits on house seeds A..B-1 and write them down."""
    first, end = int(sys.argv[1]), int(sys.argv[2])
    fitted = {split: fit(found) for split, found in pools(range(first, end)).items()}
    path = Path(__file__).with_name("weights.json")
    path.write_text(json.dumps(fitted, indent=1, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
