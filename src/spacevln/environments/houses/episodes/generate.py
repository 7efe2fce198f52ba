"""Route episodes: a route, its instruction, and the proof that the instruction leads nowhere else."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from spacevln.core.geometry import Pose, wrap_angle
from spacevln.core.task import EpisodeSpec, InstructionTask
from spacevln.environments.houses.episodes.clauses import Clause, anchors, mentions
from spacevln.environments.houses.episodes.compose import describe
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
from spacevln.environments.houses.episodes.realise import Text, realise
from spacevln.environments.houses.episodes.routes import Route, make_route, sample_end, sample_start
from spacevln.environments.houses.episodes.semantics import consistent_places
from spacevln.environments.houses.episodes.space import RoughField
from spacevln.environments.houses.episodes.topology import Topology
from spacevln.environments.houses.episodes.weights import instruction_features, log_weight
from spacevln.environments.houses.plan import House

MAX_AMBIGUITY_M = 3.0
SHORTEST_M, LONGEST_M = 4.0, 21.0
_STREAM: dict[Split, int] = {"dev": 71, "test": 72}
_ROUTES = 6
_ROUTE_ATTEMPTS = 50
_DETAILS = (0.55, 0.7, 0.7, 0.85, 0.85, 1.0, 1.0, 1.0, 1.3, 1.8)


@dataclass(frozen=True)
class Candidate:
    """An instruction for a route that holds: every place it may mean lies near the goal."""

    route: Route
    clauses: tuple[Clause, ...]
    text: Text
    places: int
    ambiguity_m: float


def route_episode(house: House | Grounds, seed: int, split: Split = "dev") -> HouseEpisode:
    """One route episode of a house.

    Args:
        house: where.
        seed: any number; the same seed gives the same episode.
        split: whose phrases word it.

    Raises:
        NoEpisodeError: no route of this house can be said without ambiguity; take another seed.
    """
    grounds = house if isinstance(house, Grounds) else Grounds(house)
    topology = grounds.topology
    rng = episode_rng(grounds.house, seed, split)
    pool = pool_of(grounds, split, rng)
    if not pool:
        raise NoEpisodeError(
            f"House seed {grounds.house.seed} gave no unambiguous route with episode seed {seed} in {_ROUTE_ATTEMPTS} attempts; "
            "take another episode seed."
        )
    scores = np.array([log_weight(features(topology, candidate), split) for candidate in pool])
    for index in np.argsort(-(scores + rng.gumbel(size=len(pool)))):
        exact = with_exact_path(grounds, pool[int(index)])
        if exact is not None:
            return episode_of(topology, exact, seed, split)
    raise NoEpisodeError(
        f"House seed {grounds.house.seed} gave no exact path with episode seed {seed}; take another episode seed."
    )


def with_exact_path(grounds: Grounds, candidate: Candidate) -> Candidate | None:
    """A candidate with the exact shortest path, or None when that takes other doors than the one that was described."""
    route, house = candidate.route, grounds.house
    z0, z1 = (house.floors[house.rooms[room].floor].z_m for room in (route.start.room, route.end.room))
    path = grounds.geodesics.path((*route.start.xy, z0), (*route.end.xy, z1))
    if len(path) < 2:
        return None
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    if not SHORTEST_M <= length <= LONGEST_M:
        return None
    again = make_route(grounds.topology, route.start.xy, route.start.room, route.start.yaw_rad, route.end, path, length)
    if again is None or [n.portal for n in again.nodes] != [n.portal for n in route.nodes]:
        return None
    return replace(candidate, route=again)


def episode_rng(house: House, seed: int, split: Split) -> np.random.Generator:
    """The random numbers of an episode."""
    return np.random.default_rng([house.seed, seed, _STREAM[split]])


def pool_of(grounds: Grounds, split: Split, rng: np.random.Generator) -> list[Candidate]:
    """Unambiguous instructions for some routes of a house."""
    return list(candidates(grounds.topology, split, rng))


def first_route_episode(house: House | Grounds, split: Split = "dev") -> HouseEpisode:
    """The route episode of a house: of the first seed that yields one.

    Raises:
        NoEpisodeError: twelve seeds in a row yield none.
    """
    grounds = house if isinstance(house, Grounds) else Grounds(house)
    for seed in range(11):
        try:
            return route_episode(grounds, seed, split)
        except NoEpisodeError:
            continue
    return route_episode(grounds, 11, split)


def features(topology: Topology, candidate: Candidate) -> dict[str, float]:
    """What the log-linear weight looks at."""
    return instruction_features(candidate.clauses, candidate.text, candidate.route.length_m, height(topology, candidate.route))


def height(topology: Topology, route: Route) -> float:
    """Height of the goal over the start [m]."""
    rooms, floors = topology.house.rooms, topology.house.floors
    return floors[rooms[route.end.room].floor].z_m - floors[rooms[route.start.room].floor].z_m


def candidates(topology: Topology, split: Split, rng: np.random.Generator) -> Iterator[Candidate]:
    """Instructions for some routes of a house, all of them unambiguous."""
    routes = 0
    for _ in range(_ROUTE_ATTEMPTS):
        if routes == _ROUTES:
            return
        found = sample_route(topology, rng)
        if found is None:
            continue
        kept = list(instructions(topology, *found, split, rng))
        routes += bool(kept)
        yield from kept


def sample_route(topology: Topology, rng: np.random.Generator) -> tuple[Route, RoughField] | None:
    """A route and the distances to its goal, or None when the draw is unusable."""
    house = topology.house
    end = sample_end(topology, rng)
    standing = None if end is None else topology.space.standing(end.xy, end.room)
    if end is None or standing is None:
        return None
    end = replace(end, xy=standing)
    floor = house.rooms[end.room].floor
    near = topology.space.rough_field(*end.xy, floor)
    target = float(np.clip(rng.normal(10.8, 4.0), SHORTEST_M + 0.3, LONGEST_M - 1.0))
    picked = sample_start(topology, near.distance_m, floor, target, rng)
    if picked is None:
        return None
    (x, y), start_floor = picked
    path = near.path(x, y, start_floor, end.xy)
    if path is None:
        return None
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    room = int(topology.space.room[(start_floor, *topology.space.ij(np.array([[x, y]]))[0])])
    yaw = wrap_angle(math.radians(30) * int(rng.integers(12)))
    route = make_route(topology, (x, y), room, yaw, end, path, length)
    return None if route is None else (route, near)


def instructions(
    topology: Topology, route: Route, near: RoughField, split: Split, rng: np.random.Generator
) -> Iterator[Candidate]:
    """Instructions that say a route and lead nowhere else, from terse to detailed."""
    start = start_pose(topology, route)
    for detail in _DETAILS:
        clauses = describe(topology, route, rng, detail)
        if clauses is None:
            return
        if not clauses:
            continue
        places = consistent_places(topology, start, clauses)
        if not places:
            continue
        worst = max(near.value(x, y, floor) for x, y, floor in places)
        if worst <= MAX_AMBIGUITY_M:
            yield Candidate(route, clauses, realise(clauses, split, rng), len(places), worst)


def start_pose(topology: Topology, route: Route) -> Pose:
    """The start in the scene frame, in millimetres."""
    floor = topology.house.rooms[route.start.room].floor
    x, y, z = rounded(*route.start.xy, topology.house.floors[floor].z_m)
    return Pose(x, y, z, round(route.start.yaw_rad, 6))


def episode_of(topology: Topology, chosen: Candidate, seed: int, split: Split) -> HouseEpisode:
    """The episode of a candidate."""
    route, house = chosen.route, topology.house
    path: tuple[Point, ...] = tuple(rounded(*map(float, p)) for p in route.path)
    floors = {house.rooms[leg.room].floor for leg in route.legs}
    tags = EpisodeTags(
        split=split,
        length_bin=length_bin(route.length_m),
        floors=len(floors),
        height_m=round(path[-1][2] - path[0][2], 3),
        doors=len(route.legs) - 1,
        words=chosen.text.words,
        sentences=chosen.text.sentences,
        anchors=anchors(chosen.clauses),
        clause_count=len(chosen.clauses),
        mentions=mentions(chosen.clauses),
        clauses=tuple(code for clause in chosen.clauses for code in clause.codes),
        places=chosen.places,
        ambiguity_m=round(chosen.ambiguity_m, 3),
    )
    spec = EpisodeSpec(
        episode_id=f"{house.name}-{split}-route-{seed}",
        scene=house.name,
        start=start_pose(topology, route),
        task=InstructionTask(chosen.text.text),
    )
    nodes = int(np.clip(round(route.length_m / 2.0) + 1, 4, 7))
    return HouseEpisode(spec, (path[-1],), resample(path, nodes), path, round(route.length_m, 3), tags)
