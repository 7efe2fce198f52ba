"""Makes the suites of the houses (:mod:`.stored`) in the file formats of R2R-CE and HM3D-OVON, the same text every time.

The episodes are then read by the same loaders as the benchmarks' (:func:`.houses.stored_episodes`), and other programs can run
them in the exported houses.
"""

from __future__ import annotations

import gzip
import hashlib
import itertools
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spacevln.core import RecordError
from spacevln.environments.bridge.frame import points_to_habitat, pose_to_habitat
from spacevln.environments.houses.episodes import (
    Grounds,
    HouseEpisode,
    NoEpisodeError,
    ObjectGoal,
    object_goal_episode,
    route_episode,
)
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.plan import Item
from spacevln.evaluation.episode import Points
from spacevln.evaluation.houses import REFERENCE_STEP_M, densify, split_of, tags_of
from spacevln.evaluation.metrics import VLN_RADIUS_M


@dataclass(frozen=True, slots=True)
class Plan:
    """What a stored suite holds.

    Args:
        first_seed: of its houses, which no other suite and no ``--seeds`` of ours uses; a house that yields too few episodes
            is passed over for the next seed.
        houses: how many.
        per_house: episodes in each.
    """

    first_seed: int
    houses: int
    per_house: int


PLANS = {"test": Plan(200_000, 50, 4), "dev": Plan(90_000, 50, 1)}
"""Test houses speak the phrases that were never tuned on, dev houses the others (:func:`.houses.split_of`)."""

SCENE_FILE = "houses/{name}/{name}.glb"
VIEW_SPACING_M = 0.25
ATTEMPTS_PER_EPISODE = 4
_NO_TOKENS: dict[str, Any] = {
    "word_list": [],
    "word2idx_dict": {},
    "stoi": {},
    "itos": [],
    "num_vocab": 0,
    "UNK_INDEX": 1,
    "PAD_INDEX": 0,
}


def write_suite(
    suite: str, split: str, folder: Path, plan: Plan | None = None, told: Callable[[int], None] | None = None
) -> Path:
    """Write ``<suite>_<split>.json.gz``, for routes its ``_gt`` too, and beside each the SHA-256 of its unpacked text.

    The text is what is hashed, because two versions of a compressor may pack the same text differently.

    Args:
        suite: ``houses-vln`` or ``houses-objectnav``.
        split: ``test`` or ``dev``.
        folder: is made.
        plan: instead of :data:`PLANS`, for tests.
        told: called with the number of houses that are done.

    Returns:
        The file of the episodes.

    Raises:
        RecordError: it cannot be written.
    """
    chosen = plan or PLANS[split]
    stem = f"{suite}_{split}"
    if suite == "houses-vln":
        content, paths = _routes(stem, chosen, told)
        return _write(folder, {f"{stem}.json.gz": content, f"{stem}_gt.json.gz": paths})
    return _write(folder, {f"{stem}.json.gz": _object_goals(stem, chosen, told)})


def _routes(stem: str, plan: Plan, told: Callable[[int], None] | None) -> tuple[dict[str, Any], dict[str, Any]]:
    episodes: list[dict[str, Any]] = []
    paths: dict[str, Any] = {}
    for grounds, made in _houses(plan, lambda grounds, seed: route_episode(grounds, seed, split_of(grounds.house.seed)), told):
        for episode in made:
            name = f"{stem}-{len(episodes):03d}"
            reference = densify(np.array(episode.shortest_path), REFERENCE_STEP_M)
            episodes.append(
                {
                    "episode_id": name,
                    "trajectory_id": str(len(episodes)),
                    **_start(grounds, episode),
                    "goals": [{"position": point, "radius": VLN_RADIUS_M} for point in _habitat(np.array(episode.goals))],
                    "reference_path": _habitat(np.array(episode.reference_path)),
                    "instruction": {"instruction_text": getattr(episode.spec.task, "instruction", "")},
                }
            )
            paths[name] = {"locations": _habitat(reference), "forward_steps": len(reference) - 1}
    return {"episodes": episodes, "instruction_vocab": _NO_TOKENS}, paths


def _object_goals(stem: str, plan: Plan, told: Callable[[int], None] | None) -> dict[str, Any]:
    episodes: list[dict[str, Any]] = []
    goals: dict[str, list[dict[str, Any]]] = {}
    for grounds, made in _houses(
        plan, lambda grounds, seed: object_goal_episode(grounds, seed, split_of(grounds.house.seed)), told
    ):
        for episode in made:
            category = episode.category or ""
            key = f"{grounds.house.name}.glb_{category}"
            if key not in goals:
                goals[key] = _goals(ObjectGoal(grounds, category))
            start = _start(grounds, episode)
            start["info"]["euclidean_distance"] = _straight_m(episode)
            episodes.append(
                {
                    "episode_id": f"{stem}-{len(episodes):03d}",
                    **start,
                    "goals": [],
                    "object_category": category,
                    "children_object_categories": [],
                }
            )
    return {
        "episodes": episodes,
        "goals_by_category": goals,
        "category_to_task_category_id": {},
        "category_to_scene_annotation_category_id": {},
    }


def _houses(
    plan: Plan, make: Callable[[Grounds, int], HouseEpisode], told: Callable[[int], None] | None
) -> Iterator[tuple[Grounds, list[HouseEpisode]]]:
    """Houses with their episodes, as many as planned."""
    done = 0
    for seed in itertools.count(plan.first_seed):
        if done == plan.houses:
            return
        grounds = Grounds(build_house(seed))
        made: list[HouseEpisode] = []
        for episode_seed in range(ATTEMPTS_PER_EPISODE * plan.per_house):
            if len(made) == plan.per_house:
                break
            try:
                made.append(make(grounds, episode_seed))
            except NoEpisodeError:
                continue
        if len(made) == plan.per_house:
            done += 1
            yield grounds, made
            if told is not None:
                told(done)


def _start(grounds: Grounds, episode: HouseEpisode) -> dict[str, Any]:
    position, rotation = pose_to_habitat(episode.spec.start)
    return {
        "scene_id": SCENE_FILE.format(name=grounds.house.name),
        "start_position": _millimetres(position),
        "start_rotation": [round(value, 9) for value in rotation],
        "info": {"geodesic_distance": episode.geodesic_m, "tags": tags_of(episode)},
    }


def _goals(goal: ObjectGoal) -> list[dict[str, Any]]:
    return [
        {
            "object_category": goal.category,
            "object_id": f"{goal.category}_{item.id}",
            "position": _habitat(np.array([[item.x, item.y, item.z]]))[0],
            "radius": None,
            "view_points": [
                {"agent_state": {"position": position, "rotation": _facing(point, item)}, "iou": 0.0}
                for point, position in zip(thinned, _habitat(thinned), strict=True)
            ],
        }
        for item, region in zip(goal.instances, goal.regions, strict=True)
        for thinned in [_thinned(region)]
    ]


def _thinned(region: Points) -> Points:
    """One place of every 0.25 m square, as OVON's view points lie on such a grid."""
    _, first = np.unique(np.round(region / VIEW_SPACING_M).astype(int), axis=0, return_index=True)
    kept: Points = region[np.sort(first)]
    return kept


def _facing(point: Points, item: Item) -> list[float]:
    yaw = float(np.arctan2(item.y - point[1], item.x - point[0]))
    return [0.0, round(float(np.sin(yaw / 2)), 6) + 0.0, 0.0, round(float(np.cos(yaw / 2)), 6) + 0.0]


def _straight_m(episode: HouseEpisode) -> float:
    steps = np.array(episode.goals) - episode.spec.start.position_m
    return round(float(np.linalg.norm(steps, axis=1).min()), 3)


def _habitat(points: Points) -> list[list[float]]:
    return [_millimetres(point) for point in points_to_habitat(points).tolist()]


def _millimetres(values: Sequence[float]) -> list[float]:
    return [round(value, 3) + 0.0 for value in values]


def _write(folder: Path, files: dict[str, dict[str, Any]]) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files.items():
            text = json.dumps(content, ensure_ascii=False, separators=(",", ":"))
            packed = gzip.compress(text.encode(), compresslevel=9, mtime=0)
            (folder / name).write_bytes(packed)
            digest = hashlib.sha256(text.encode()).hexdigest()
            (folder / f"{name}.sha256").write_text(f"{digest}\n", encoding="utf-8")
    except OSError as error:
        raise RecordError(f"Cannot write {str(folder)!r} ({error.strerror}): give a folder that you may write.") from error
    return folder / next(iter(files))
