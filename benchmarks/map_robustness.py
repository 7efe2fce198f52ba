"""How the map's accuracy falls with noise: writes ``docs/images/map-robustness.png`` and prints the table of ``docs/mapping.md``.

Run with ``python benchmarks/map_robustness.py`` (some minutes; needs matplotlib).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tests" / "mapping"))

from house_scores import Score, Witness  # noqa: E402
from house_walks import look, walk  # noqa: E402
from noise import Trouble, troubled  # noqa: E402

from spacevln.mapping import MetricMap  # noqa: E402

SEEDS = (5,)
ROOMS = 2
SWEEPS = {
    "pose noise (1 = 2 cm, 1 degree)": ("pose", (0.0, 0.5, 1.0, 2.0, 3.0)),
    "depth noise (1 = Redwood)": ("depth", (0.0, 0.5, 1.0, 2.0, 3.0)),
    "holes in the depth": ("holes", (0.0, 0.1, 0.2, 0.4)),
    "dropped frames": ("dropped", (0.0, 0.25, 0.5, 0.75)),
}
SHOWN = {
    "precise": "obstacle cells within 10 cm of something",
    "marked": "seen surfaces marked",
    "free": "free cells that are free",
    "explored": "visible floor explored",
}


def measure() -> dict[tuple[str, float], list[Score]]:
    """Scores of every house per kind and amount."""
    found: dict[tuple[str, float], list[Score]] = {}
    for seed in SEEDS:
        walked = walk(seed, ROOMS)
        frames, witness = [image for _, images in look(walked) for image in images], Witness(walked, np.random.default_rng(seed))
        for pose, frame in zip(walked.poses, frames, strict=True):
            witness.see(pose, frame)
        for kind, amounts in SWEEPS.values():
            for amount in amounts:
                world_map = MetricMap()
                for frame in troubled(frames, Trouble(**{kind: amount}), np.random.default_rng(seed)):
                    world_map.integrate(frame)
                found.setdefault((kind, amount), []).append(witness.score(world_map, 0))
    return found


def draw(found: dict[tuple[str, float], list[Score]], path: Path) -> None:
    """One panel per kind of trouble."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(1, len(SWEEPS), figsize=(14, 3.6), sharey=True, layout="constrained")
    for panel, (title, (kind, amounts)) in zip(panels, SWEEPS.items(), strict=True):
        for name, label in SHOWN.items():
            means = [100 * np.mean([getattr(score, name) for score in found[kind, amount]]) for amount in amounts]
            panel.plot(amounts, means, marker="o", label=label)
        panel.set_xlabel(title)
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("share, %")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Measure, draw, print."""
    found = measure()
    draw(found, ROOT / "docs" / "images" / "map-robustness.png")
    for (kind, amount), scores in found.items():
        cells = (f"{100 * float(np.mean([getattr(score, name) for score in scores])):.1f}" for name in SHOWN)
        sys.stdout.write(f"| {kind} {amount:g} | {' | '.join(cells)} |\n")


if __name__ == "__main__":
    main()
