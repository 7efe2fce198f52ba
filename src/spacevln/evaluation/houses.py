"""Episodes of the embedded houses, with their truth from the exact geometry."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Action, EpisodeSpec, InstructionTask, ObjectGoalTask, Pose, UsageError
from spacevln.environments.houses.episodes import (
    Grounds,
    HouseEpisode,
    NoEpisodeError,
    ObjectGoal,
    Split,
    checked_goal,
    first_route_episode,
    object_goal_episode,
    reachable_categories,
)
from spacevln.environments.houses.house import build_house, parse_scene_name
from spacevln.environments.houses.walking.follower import ShortestPathFollower
from spacevln.environments.houses.walking.geodesics import Field
from spacevln.environments.houses.walking.motion import Body
from spacevln.evaluation.datasets.hm3d_ovon import load_hm3d_ovon
from spacevln.evaluation.datasets.r2r_ce import load_r2r_ce
from spacevln.evaluation.datasets.sequence import EpisodeSequence
from spacevln.evaluation.episode import Episode, Points
from spacevln.evaluation.metrics import VLN_RADIUS_M, success

TEST_SEEDS_FROM = 100_000
"""House seeds from here on speak with the phrases of the test split and are used for reporting only."""

REFERENCE_STEP_M = 0.25
"""Spacing of the dense reference of nDTW, as in VLN-CE's ground truth of 0.25 m forwards."""


class RouteTruth:
    """Truth of a route: STOP strictly within 3 m (geodesic) of the goal."""

    radius_m = VLN_RADIUS_M

    def __init__(self, grounds: Grounds, goals: Points, shortest_path: Points, reference_path: Points) -> None:
        self.goals = goals
        self.shortest_path = shortest_path
        self.reference_path: Points | None = reference_path
        self._field: Field = grounds.geodesics.distances_from(self.goals)
        self._follower = ShortestPathFollower(Body(grounds.walkable), self._field)

    def distances_m(self, positions: Points) -> NDArray[np.float64]:
        """Geodesic distances to the goal."""
        return self._field.at_many(positions)

    def reached(self, position: Points) -> bool:
        """Whether STOP here is a success."""
        return success(True, self._field.at(*map(float, position)), VLN_RADIUS_M)

    def viewpoint_m(self, position: Points) -> float | None:
        """A route has no view points."""
        del position
        return None

    def follow(self, pose: Pose) -> Action:
        """The shortest-path follower's primitive."""
        return self._follower.action(pose)


class ObjectGoalTruth:
    """Truth of an object goal: STOP within 1.0 m of an instance's nearest surface with nothing but air between."""

    radius_m = 0.0

    def __init__(self, goal: ObjectGoal, start: Pose) -> None:
        self._goal = goal
        self.goals = np.array([[item.x, item.y, item.z] for item in goal.instances])
        self.shortest_path: Points = goal.field.path(start.x_m, start.y_m, start.z_m)
        self.reference_path: Points | None = None
        self._follower = ShortestPathFollower(
            Body(goal.grounds.walkable), goal.field, arrived=lambda pose: self.reached(pose.position_m)
        )

    def distances_m(self, positions: Points) -> NDArray[np.float64]:
        """Geodesic distances to the nearest place from which STOP succeeds."""
        return np.array([self._goal.distance_m(*map(float, position)) for position in positions])

    def reached(self, position: Points) -> bool:
        """Whether STOP here is a success."""
        return self._goal.is_reached(*map(float, position))

    def viewpoint_m(self, position: Points) -> float | None:
        """Geodesic distance to the nearest sampled place from which STOP succeeds."""
        return self._goal.field.at(*map(float, position))

    def follow(self, pose: Pose) -> Action:
        """The shortest-path follower's primitive; STOP as soon as it would succeed."""
        return self._follower.action(pose)


def house_episode_id(suite: str, seed: int) -> str:
    """The id of the one fresh episode of a house seed in a suite; the episode is a pure function of it."""
    return f"{suite}-{seed:06d}"


def house_episode(episode_id: str) -> Episode:
    """The episode of an id.

    Raises:
        UsageError: the id is of no houses suite.
        NoEpisodeError: the house yields no episode.
    """
    suite, _, digits = episode_id.rpartition("-")
    if suite not in ("houses-vln", "houses-objectnav") or not digits.isdigit():
        raise UsageError(f"{episode_id!r} is no episode of a houses suite: ids look like 'houses-vln-000017'.")
    grounds = grounds_of(int(digits))
    split = split_of(grounds.house.seed)
    if suite == "houses-vln":
        found = first_route_episode(grounds.house, split)
        path = np.array(found.shortest_path)
        truth = RouteTruth(grounds, np.array(found.goals), path, densify(path, REFERENCE_STEP_M))
        return Episode(replace(found.spec, episode_id=episode_id), truth, tags_of(found))
    found = _first_object_goal(grounds, split)
    goal = ObjectGoal(grounds, found.category or "")
    return Episode(replace(found.spec, episode_id=episode_id), ObjectGoalTruth(goal, found.spec.start), tags_of(found))


def fresh_episodes(suite: str, seeds: Sequence[int]) -> EpisodeSequence:
    """One fresh episode of each house seed, made when it is asked for."""
    scenes = [f"house-{seed:06d}" for seed in seeds]
    return EpisodeSequence([house_episode_id(suite, seed) for seed in seeds], house_episode, scenes)


def stored_episodes(suite: str, path: Path, split: str) -> EpisodeSequence:
    """A suite from a file that :mod:`.suites` wrote; truth is measured in the house when an episode is asked for.

    Raises:
        DatasetError: the file is damaged.
        UsageError: its scenes are not houses.
    """
    read = load_r2r_ce(path, split) if suite == "houses-vln" else load_hm3d_ovon(path, split)
    return read.mapped(_measured)


def _measured(stored: Episode) -> Episode:
    scene = PurePosixPath(stored.scene).stem
    grounds = grounds_of(parse_scene_name(scene))
    spec = replace(stored.spec, scene=scene)
    if stored.goal is not None:
        return replace(stored, spec=spec, truth=ObjectGoalTruth(ObjectGoal(grounds, stored.goal), spec.start))
    if stored.annotations is None or stored.annotations.reference_path is None:
        raise UsageError(f"{stored.episode_id!r} has no goal or no path: keep the suite's _gt file beside it.")
    known, reference = stored.annotations, stored.annotations.reference_path
    path = grounds.geodesics.distances_from(known.targets).path(*map(float, spec.start.position_m))
    return replace(stored, spec=spec, truth=RouteTruth(grounds, known.targets, path, reference))


def pick_episode(task: str, seed: int, *, instruction: str | None = None, goal: str | None = None) -> Episode:
    """The episode of ``spacevln run``: the house's own, or the house's start with a task of the caller's.

    Raises:
        UsageError: the goal is no object category, or this house has none.
    """
    if instruction is not None:
        start = house_episode(house_episode_id("houses-vln", seed))
        return Episode(EpisodeSpec(f"run-{seed:06d}", start.scene, start.start, InstructionTask(instruction.strip())))
    if goal is None:
        return house_episode(house_episode_id("houses-vln" if task == "vln" else "houses-objectnav", seed))
    return _free_goal(seed, checked_goal(goal))


def _free_goal(seed: int, category: str) -> Episode:
    grounds = grounds_of(seed)
    here = reachable_categories(grounds.house)
    if category not in here:
        raise UsageError(f"{grounds.house.name} has no {category} within reach: it has {', '.join(here)}.")
    start = house_episode(house_episode_id("houses-vln", seed)).start
    spec = EpisodeSpec(f"run-{seed:06d}-{category.replace(' ', '-')}", grounds.house.name, start, ObjectGoalTask(category))
    return Episode(spec, ObjectGoalTruth(ObjectGoal(grounds, category), start))


def _first_object_goal(grounds: Grounds, split: Split) -> HouseEpisode:
    """The object-goal episode of a house: of the first seed that yields one."""
    for seed in range(11):
        try:
            return object_goal_episode(grounds, seed, split)
        except NoEpisodeError:
            continue
    return object_goal_episode(grounds, 11, split)


def split_of(seed: int) -> Split:
    """Whose phrases a house seed speaks."""
    return "test" if seed >= TEST_SEEDS_FROM else "dev"


def densify(path: Points, step_m: float) -> Points:
    """Points along a polyline at most ``step_m`` apart, both ends included."""
    pieces = [path[:1]]
    for a, b in itertools.pairwise(path):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / step_m)))
        pieces.append(a + (b - a) * np.linspace(0, 1, count + 1)[1:, None])
    return np.vstack(pieces)


@functools.lru_cache(maxsize=4)
def grounds_of(seed: int) -> Grounds:
    """The spaces of a house; kept for the last few, as episodes of one house come in a row."""
    return Grounds(build_house(seed))


def tags_of(episode: HouseEpisode) -> dict[str, str | float | int | bool]:
    """Difficulty tags as plain values."""
    tags = asdict(episode.tags)
    return {name: " ".join(map(str, value)) if isinstance(value, tuple) else value for name, value in tags.items()}
