"""Episodes of generated houses: geometry, truth and statistics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacevln.core.errors import UnknownNameError
from spacevln.core.task import InstructionTask
from spacevln.environments.houses.episodes import (
    Grounds,
    HouseEpisode,
    NoEpisodeError,
    ObjectGoal,
    Split,
    checked_goal,
    first_route_episode,
    goal_categories,
    object_goal_episode,
    route_episode,
)
from spacevln.environments.houses.episodes.clauses import Pass, Turn
from spacevln.environments.houses.episodes.generate import episode_rng, pool_of
from spacevln.environments.houses.episodes.item_geometry import nearest_surface_point
from spacevln.environments.houses.episodes.reading import side_fits
from spacevln.environments.houses.episodes.sight import Sight
from spacevln.environments.houses.episodes.statistics import as_text, object_table, route_table
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.plan import Item

SEEDS = range(7)


@pytest.fixture(scope="module")
def grounds() -> list[Grounds]:
    return [Grounds(build_house(seed)) for seed in SEEDS]


@pytest.fixture(scope="module")
def routes(grounds: list[Grounds]) -> list[HouseEpisode]:
    return [first_route_episode(g) for g in grounds]


@pytest.fixture(scope="module")
def objects(grounds: list[Grounds]) -> list[HouseEpisode]:
    return [object_goal_episode(g, 0) for g in grounds]


def test_distances_are_those_of_the_geodesics(grounds: list[Grounds], routes: list[HouseEpisode]) -> None:
    for g, e in zip(grounds, routes, strict=True):
        start = e.spec.start
        exact = g.geodesics.distance_m((start.x_m, start.y_m, start.z_m), e.goals[0])
        assert e.geodesic_m == pytest.approx(exact, abs=0.02)
        assert 4.0 <= e.geodesic_m <= 21.0
        steps = np.linalg.norm(np.diff(np.array(e.shortest_path), axis=0), axis=1)
        assert steps.sum() == pytest.approx(e.geodesic_m, abs=0.02)


def test_paths_run_from_start_to_goal_on_walkable_ground(grounds: list[Grounds], routes: list[HouseEpisode]) -> None:
    for g, e in zip(grounds, routes, strict=True):
        start = (e.spec.start.x_m, e.spec.start.y_m, e.spec.start.z_m)
        assert 4 <= len(e.reference_path) <= 7
        assert e.reference_path[0] == pytest.approx(start, abs=0.01)
        assert e.reference_path[-1] == pytest.approx(e.goals[0], abs=0.002)
        assert g.walkable.is_walkable(*start)
        assert g.walkable.is_walkable(*e.goals[0])


def test_headings_are_multiples_of_thirty_degrees_and_numbers_are_millimetres(routes: list[HouseEpisode]) -> None:
    for e in routes:
        assert math.degrees(e.spec.start.yaw_rad) / 30 == pytest.approx(round(math.degrees(e.spec.start.yaw_rad) / 30), abs=1e-3)
        for point in (*e.goals, *e.reference_path, *e.shortest_path):
            assert all(value == round(value, 3) for value in point)


def test_an_instruction_leads_nowhere_else(routes: list[HouseEpisode]) -> None:
    for e in routes:
        assert isinstance(e.spec.task, InstructionTask)
        assert len(e.spec.task.instruction.split()) == e.tags.words
        assert e.tags.places >= 1
        assert e.tags.ambiguity_m <= 3.0


def test_the_same_seed_gives_the_same_episode() -> None:
    house = build_house(3)
    assert route_episode(house, 5) == route_episode(house, 5)
    assert route_episode(house, 5) != route_episode(house, 6)
    assert object_goal_episode(house, 5) == object_goal_episode(house, 5)


def test_said_turns_are_the_turns_of_the_walk(grounds: list[Grounds]) -> None:
    """The side of every plain turn right after a doorway, against the exact path's heading there."""
    checked = 0
    for g in grounds[:5]:
        for candidate in pool_of(g, "dev", episode_rng(g.house, 0, "dev")):
            checked += check_turns(candidate)
    assert checked > 30


def check_turns(candidate: object) -> int:
    route, clauses = candidate.route, candidate.clauses  # type: ignore[attr-defined]
    crossings = 0
    previous_crossed = False
    checked = 0
    for clause in clauses:
        for atom in clause.atoms:
            name = type(atom).__name__
            if isinstance(atom, Turn) and atom.side and previous_crossed and atom.degree == "" and not clause.wrap:
                node, leg = route.nodes[crossings], route.legs[crossings]
                k = min(6, len(leg.points) - 1)
                d = leg.points[k] - np.array(node.xy)
                angle = math.remainder(math.atan2(d[1], d[0]) - node.yaw_rad, math.tau)
                if np.hypot(*d) > 0.6 and abs(angle) > 0.5 and crossings_all_said(route, clauses):
                    assert side_fits(atom.side, angle), clause
                    checked += 1
            previous_crossed = name == "Cross"
            crossings += name == "Cross"
    return checked


def crossings_all_said(route: object, clauses: tuple[object, ...]) -> bool:
    said = sum(type(atom).__name__ == "Cross" for clause in clauses for atom in clause.atoms)  # type: ignore[attr-defined]
    return said == len(route.legs) - 1  # type: ignore[attr-defined]


def test_landmarks_that_are_passed_can_be_seen_on_the_way(grounds: list[Grounds]) -> None:
    """Against sight lines over the solid parts of the house, a second method."""
    checked = 0
    for g in grounds[:2]:
        sight = Sight(g.house)
        for candidate in pool_of(g, "dev", episode_rng(g.house, 0, "dev"))[:12]:
            path = np.concatenate([leg.points for leg in candidate.route.legs])
            for clause in candidate.clauses:
                for atom in clause.atoms:
                    if isinstance(atom, Pass):
                        assert any(seen_from(sight, item, path) for item in g.house.items if atom.thing.matches(item)), clause
                        checked += 1
    assert checked > 5


def seen_from(sight: Sight, item: Item, path: np.ndarray) -> bool:
    eyes = path[np.hypot(*(path - (item.x, item.y)).T) < 6.0]
    if not len(eyes):
        return False
    z_m = sight.house.floors[item.floor].z_m
    targets = nearest_surface_point(item, eyes)
    high = [np.column_stack([targets, np.full(len(eyes), item.z + share * item.size[2])]) for share in (0.2, 0.6, 0.95)]
    points = np.column_stack([eyes, np.full(len(eyes), z_m + 0.88)])
    return any(sight.clear(points, target + 0.03 * (points - target), item).any() for target in high)


def test_object_goals_are_reached_where_the_path_ends(grounds: list[Grounds], objects: list[HouseEpisode]) -> None:
    for g, e in zip(grounds, objects, strict=True):
        assert e.category is not None
        goal = ObjectGoal(g, e.category)
        assert goal.is_reached(*e.shortest_path[-1])
        start = e.spec.start
        assert not goal.is_reached(start.x_m, start.y_m, start.z_m)
        assert goal.distance_m(start.x_m, start.y_m, start.z_m) == pytest.approx(e.geodesic_m, abs=0.02)
        assert set(e.instance_ids) <= {item.id for item in g.house.items if item.category == e.category}
        assert len(e.goals) == len(e.instance_ids)


def test_small_homes_give_episodes_too() -> None:
    g = Grounds(build_house(307))
    assert len(g.house.rooms) == 4
    assert 4.0 <= first_route_episode(g).geodesic_m <= 21.0
    assert object_goal_episode(g, 0).geodesic_m > 1.0


def test_goal_categories_are_checked_by_name() -> None:
    assert len(goal_categories()) >= 60
    assert checked_goal("Washing_Machine") == "washing machine"
    with pytest.raises(UnknownNameError, match=r"unicorn.*allowed are"):
        checked_goal("unicorn")


def sample(seeds: range, split: Split) -> tuple[list[HouseEpisode], list[HouseEpisode], int]:
    routes, objects, failed = [], [], 0
    for seed in seeds:
        g = Grounds(build_house(seed))
        try:
            routes.append(route_episode(g, 0, split))
        except NoEpisodeError:
            failed += 1
        objects.append(object_goal_episode(g, 0, split))
    return routes, objects, failed


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(("split", "first"), [("dev", 400), ("test", 100_000)])
def test_statistics_are_those_of_r2r(split: Split, first: int) -> None:
    routes, objects, failed = sample(range(first, first + 300), split)
    rows = [*route_table(routes), *object_table(objects)]
    assert all(row.holds for row in rows), as_text([row for row in rows if not row.holds])
    assert failed <= 3


def test_statistics_of_a_small_sample_are_not_far_off(routes: list[HouseEpisode]) -> None:
    words = np.mean([e.tags.words for e in routes])
    assert 18 <= words <= 36
    assert 2.4 <= np.mean([e.tags.anchors for e in routes]) <= 4.4
    assert 7.0 <= np.mean([e.geodesic_m for e in routes]) <= 11.5
    assert len({e.tags.clauses for e in routes}) >= len(routes) - 1
    assert as_text(route_table(routes)).count("\n") > 40
