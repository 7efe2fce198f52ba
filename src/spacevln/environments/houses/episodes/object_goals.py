"""Object-goal episodes: find an instance of a category (the manner of HM3D-OVON).

Success is a STOP within 1.0 m (horizontally) of the nearest surface of an instance with nothing but air between.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from spacevln.core.errors import UnknownNameError
from spacevln.core.geometry import Pose, wrap_angle
from spacevln.core.task import EpisodeSpec, ObjectGoalTask
from spacevln.environments.houses.episodes.catalogue import goal_categories
from spacevln.environments.houses.episodes.episode import (
    EpisodeTags,
    HouseEpisode,
    NoEpisodeError,
    Point,
    Split,
    length_bin,
    resample,
    rounded,
)
from spacevln.environments.houses.episodes.grounds import Grounds
from spacevln.environments.houses.episodes.routes import portals_along
from spacevln.environments.houses.episodes.sight import Sight
from spacevln.environments.houses.episodes.space import Bool, Float
from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M, RESOLUTION_M
from spacevln.environments.houses.plan import House, Item
from spacevln.environments.houses.walking.geodesics import Field

SUCCESS_M = 1.0
_STREAM: dict[Split, int] = {"dev": 73, "test": 74}
_ATTEMPTS = 60
_SHORTEST_M, _LONGEST_M = 1.5, 24.0
_FAR_SHARE = 0.8
_SPARSE = 2  # success is sampled on every second cell of the walkable grid, 0.1 m apart


class ObjectGoal:
    """The goal region of a category in a house.

    Args:
        grounds: the house's spaces.
        category: in words, as in :func:`goal_categories`.

    Raises:
        UnknownNameError: the house has no such thing, or none that can be reached.
    """

    def __init__(self, grounds: Grounds, category: str) -> None:
        self.category = category
        self.grounds = grounds
        self.sight = Sight(grounds.house)
        regions = [(item, self._region(item)) for item in grounds.house.items if item.category.replace("_", " ") == category]
        kept = [(item, region) for item, region in regions if len(region)]
        if not kept:
            raise UnknownNameError("reachable goal of " + grounds.house.name, category, reachable_categories(grounds.house))
        self.instances: tuple[Item, ...] = tuple(item for item, _ in kept)
        self.regions: tuple[Float, ...] = tuple(region for _, region in kept)
        self.field: Field = grounds.geodesics.distances_from(np.concatenate(self.regions))

    def is_reached(self, x: float, y: float, z: float) -> bool:
        """Whether a STOP with the feet here succeeds."""
        floor = self.grounds.walkable.floor_index(x, y, z)
        point = np.array([[x, y, z]])
        return any(item.floor == floor and bool(self.sight.reached(point, item, SUCCESS_M)[0]) for item in self.instances)

    def distance_m(self, x: float, y: float, z: float) -> float:
        """Walking distance to the nearest place from which it succeeds; 0 there."""
        return 0.0 if self.is_reached(x, y, z) else self.field.at(x, y, z)

    def _region(self, item: Item) -> Float:
        """Standing places (N, 3), 0.1 m apart, from which an instance is reached."""
        space = self.grounds.walkable.floors[item.floor]
        reach = math.hypot(item.size[0], item.size[1]) / 2 + SUCCESS_M
        (i0, j0), (i1, j1) = space.cell(item.x - reach, item.y - reach), space.cell(item.x + reach, item.y + reach)
        ii, jj = np.meshgrid(np.arange(max(i0, 0), i1, _SPARSE), np.arange(max(j0, 0), j1, _SPARSE), indexing="ij")
        inside = (ii < space.clearance_m.shape[0]) & (jj < space.clearance_m.shape[1])
        ii, jj = ii[inside], jj[inside]
        ok = space.clearance_m[ii, jj] >= AGENT_RADIUS_M + RESOLUTION_M / 2
        xy = np.array(space.origin_m) + (np.stack([ii[ok], jj[ok]], axis=1) + 0.5) * RESOLUTION_M
        points = np.column_stack([xy, np.full(len(xy), self.grounds.house.floors[item.floor].z_m)])
        return points[self.sight.reached(points, item, SUCCESS_M)] if len(points) else points.reshape(0, 3)

    def visible_from(self, x: float, y: float, floor: int) -> bool:
        """Whether a person at a point could see an instance by turning on the spot."""
        topology = self.grounds.topology
        eye = np.array([[x, y]])
        return any(item.floor == floor and topology.seen(item, eye) for item in self.instances)


def reachable_categories(house: House) -> tuple[str, ...]:
    """Categories of a house that may be goals."""
    known = frozenset(goal_categories())
    return tuple(sorted({name for item in house.items if (name := item.category.replace("_", " ")) in known}))


def object_goal_episode(house: House | Grounds, seed: int, split: Split = "dev", category: str | None = None) -> HouseEpisode:
    """One object-goal episode of a house.

    Four of five are drawn so that no instance is visible at the start and the nearest lies two or more doors away.

    Args:
        house: where.
        seed: any number; the same seed gives the same episode.
        split: names the episode and selects its stream of random numbers.
        category: what to find; drawn when not given.

    Raises:
        UnknownNameError: the house has no such thing.
        NoEpisodeError: no start fits; take another seed.
    """
    grounds = house if isinstance(house, Grounds) else Grounds(house)
    rng = np.random.default_rng([grounds.house.seed, seed, _STREAM[split]])
    names = (category,) if category is not None else _drawn(grounds.house, rng)
    far = bool(rng.random() < _FAR_SHARE)
    fallback: HouseEpisode | None = None
    for name in names:
        try:
            goal = ObjectGoal(grounds, name)
        except UnknownNameError:
            if category is not None:
                raise
            continue
        for _ in range(_ATTEMPTS // 4):
            episode = _from_random_start(goal, seed, split, rng)
            if episode is None:
                continue
            if (episode.tags.doors >= 2 and not episode.tags.goal_visible) == far:
                return episode
            fallback = fallback or episode
    if fallback is None:
        raise NoEpisodeError(
            f"House seed {grounds.house.seed} gave no object goal with episode seed {seed}; take another episode seed."
        )
    return fallback


def _drawn(house: House, rng: np.random.Generator) -> Sequence[str]:
    names = reachable_categories(house)
    return [names[int(k)] for k in rng.permutation(len(names))[:4]]


def _from_random_start(goal: ObjectGoal, seed: int, split: Split, rng: np.random.Generator) -> HouseEpisode | None:
    grounds = goal.grounds
    house, space = grounds.house, grounds.topology.space
    cells = grounds.start_cells
    f, i, j = cells[int(rng.integers(len(cells)))]
    xy = space.xy(np.array([[i, j]]))[0]
    x, y, z = rounded(float(xy[0]), float(xy[1]), house.floors[int(f)].z_m)
    yaw = wrap_angle(math.radians(30) * int(rng.integers(12)))
    length = goal.field.at(x, y, z)
    if not _SHORTEST_M <= length <= _LONGEST_M or goal.is_reached(x, y, z):
        return None
    path = goal.field.path(x, y, z)
    doors = portals_along(grounds.topology, path)
    dense: tuple[Point, ...] = tuple(rounded(*map(float, p)) for p in path)
    tags = EpisodeTags(
        split=split,
        length_bin=length_bin(length),
        floors=1 + (abs(dense[-1][2] - dense[0][2]) > 1.0),
        height_m=round(dense[-1][2] - dense[0][2], 3),
        doors=len(doors or ()),
        goal_visible=goal.visible_from(x, y, int(f)),
    )
    name = goal.category.replace(" ", "_")
    return HouseEpisode(
        spec=EpisodeSpec(
            f"{house.name}-{split}-object-{seed}-{name}", house.name, Pose(x, y, z, round(yaw, 6)), ObjectGoalTask(goal.category)
        ),
        goals=tuple(_nearest(region, path[-1]) for region in goal.regions),
        reference_path=resample(dense, int(np.clip(round(length / 2.0) + 1, 4, 7))),
        shortest_path=dense,
        geodesic_m=round(length, 3),
        tags=tags,
        category=goal.category,
        instance_ids=tuple(item.id for item in goal.instances),
    )


def _nearest(region: Float, point: Float) -> Point:
    d: Float = np.linalg.norm(region - point, axis=1)
    best: Bool = d == d.min()
    return rounded(*map(float, region[int(np.argmax(best))]))
