"""Shortest distances against a second method, and what every distance keeps to."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from numba import njit
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from spacevln.core.errors import UsageError
from spacevln.environments.houses.ground.footprints import Float, clearance
from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M, FloorSpace, Walkable
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.layout import generate_layout, hole
from spacevln.environments.houses.walking.geodesics import Geodesics

RADIUS = AGENT_RADIUS_M


@lru_cache
def bare(seed: int) -> Geodesics:
    return Geodesics(Walkable(generate_layout(seed)))


@lru_cache
def two_floors() -> Geodesics:
    return bare(next(seed for seed in range(50) if generate_layout(seed).stairs))


def standing_points(geodesics: Geodesics, count: int, seed: int) -> Float:
    """Random points (N, 3) where the agent can stand."""
    rng, walkable = np.random.default_rng(seed), geodesics.walkable
    points: list[tuple[float, float, float]] = []
    while len(points) < count:
        room = walkable.house.rooms[int(rng.integers(len(walkable.house.rooms)))]
        rect = room.rects[0]
        x, y = (float(value) for value in rng.uniform((rect.x0, rect.y0), (rect.x1, rect.y1)))
        z = walkable.house.floors[room.floor].z_m
        if walkable.stairs_at(x, y, z) is None and walkable.is_walkable(x, y, z, 0.12):
            points.append((x, y, z))
    return np.array(points)


@njit
def visible(ax: float, ay: float, bx: float, by: float, boxes: Float, discs: Float, radius: float) -> bool:
    """Whether the disc can move straight from a to b: sphere tracing with exact clearances."""
    length = math.hypot(bx - ax, by - ay)
    at = 0.0
    while at < length:
        x, y = ax + (bx - ax) * at / length, ay + (by - ay) * at / length
        spare = clearance(x, y, boxes, discs, 5.0) - radius
        if spare < -1e-6:
            return False
        at += max(spare, 0.004)
    return True


@njit
def visibility(points: Float, boxes: Float, discs: Float, radius: float) -> Float:
    """Lengths of the straight moves between all pairs (0 where there is none)."""
    n = len(points)
    lengths = np.zeros((n, n))
    for a in range(n):
        for b in range(a):
            if visible(points[a, 0], points[a, 1], points[b, 0], points[b, 1], boxes, discs, radius):
                lengths[a, b] = lengths[b, a] = math.hypot(points[a, 0] - points[b, 0], points[a, 1] - points[b, 1])
    return lengths


def corners(space: FloorSpace) -> Float:
    """Points around the obstacles' corners, a hair outside the agent's radius: where shortest paths bend."""
    found = []
    for x, y, c, s, hx, hy in space.boxes:
        for sx in (-1, 1):
            for sy in (-1, 1):
                u, v = sx * hx, sy * hy
                angle = math.atan2(s, c)
                for k in range(5):
                    turn = angle + math.atan2(sy, sx) + math.radians(22.5) * (k - 2)
                    reach = RADIUS * 1.03
                    found.append((x + c * u - s * v + reach * math.cos(turn), y + s * u + c * v + reach * math.sin(turn)))
    for x, y, r in space.discs:
        found += [(x + (r * 1.03 + RADIUS) * math.cos(a), y + (r * 1.03 + RADIUS) * math.sin(a)) for a in np.arange(0, 6.28, 0.3)]
    free = [p for p in found if clearance(p[0], p[1], space.boxes, space.discs, 1.0) >= RADIUS]
    return np.array(sorted({(round(x, 3), round(y, 3)) for x, y in free}))


def compare(geodesics: Geodesics, count: int) -> Float:
    """Ratios of our distances to those over the visibility graph of the first floor."""
    space = geodesics.walkable.floors[0]
    points = [p for p in standing_points(geodesics, 3 * count, 1) if p[2] == 0.0][:count]
    bends = corners(space)
    bends = np.array([p for p in bends if geodesics.walkable.is_walkable(p[0], p[1], 0.0)])
    graph = visibility(np.concatenate([np.array(points)[:, :2], bends]), space.boxes, space.discs, RADIUS)
    exact = dijkstra(csr_matrix(graph), indices=range(len(points)))
    ratios = []
    for a in range(len(points)):
        field = geodesics.distances_from([points[a]])
        ratios += [field.at(*points[b]) / exact[a, b] for b in range(a) if exact[a, b] > 1.0]
    return np.array(ratios)


@pytest.mark.parametrize("seed", [seed for seed in range(12) if not generate_layout(seed).stairs][:3])
def test_distances_agree_with_a_visibility_graph(seed: int) -> None:
    ratios = compare(bare(seed), 8)
    assert np.isfinite(ratios).all()
    assert ratios.min() >= 0.98
    assert ratios.max() <= 1.02
    assert abs(ratios.mean() - 1.0) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("seed", [seed for seed in range(12) if not generate_layout(seed).stairs][:2])
def test_distances_agree_with_a_visibility_graph_among_furniture(seed: int) -> None:
    ratios = compare(Geodesics(Walkable(build_house(seed))), 8)
    assert np.isfinite(ratios).all()
    assert ratios.min() >= 0.98
    assert ratios.max() <= 1.02


@pytest.mark.parametrize("seed", [1, 8, 25])
def test_distances_are_a_metric_and_paths_have_their_length(seed: int) -> None:
    geodesics = bare(seed)
    points = standing_points(geodesics, 6, seed)
    fields = [geodesics.distances_from([point]) for point in points]
    table = np.array([field.at_many(points) for field in fields])
    assert np.isfinite(table).all()
    assert table.diagonal() == pytest.approx(0.0, abs=1e-9)
    assert table == pytest.approx(table.T, rel=0.005, abs=0.01)
    straight = np.linalg.norm(points[:, None] - points[None], axis=2)
    assert (table >= straight * 0.9999 - 1e-9).all()
    assert (table[:, :, None] <= table[:, None, :] + table.T[None, :, :] + 0.05).all()
    for a in range(6):
        for b in range(a):
            assert geodesics.distance_m(points[a], points[b]) == pytest.approx(table[b, a], rel=0.005, abs=0.01)
            path = geodesics.path(points[a], points[b])
            assert path[0] == pytest.approx(points[a])
            assert path[-1] == pytest.approx(points[b])
            assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() == pytest.approx(table[a, b], rel=0.005, abs=0.01)


@pytest.mark.parametrize("seed", [1, 8])
def test_paths_keep_clear_of_obstacles(seed: int) -> None:
    geodesics = bare(seed)
    points = standing_points(geodesics, 6, seed)
    for a, b in itertools.pairwise(points):
        path = geodesics.path(a, b)
        for p, q in itertools.pairwise(path):
            for t in np.linspace(0, 1, max(2, int(np.linalg.norm(q - p) / 0.05))):
                x, y, z = p + t * (q - p)
                assert geodesics.walkable.clearance_m(float(x), float(y), float(z)) >= RADIUS - 0.04


def test_the_way_upstairs_leads_over_the_flight_and_counts_its_slope() -> None:
    geodesics = two_floors()
    house = geodesics.walkable.house
    (stairs,) = house.stairs
    run, rise = max(stairs.rect.width, stairs.rect.depth), house.floors[1].z_m
    points = standing_points(geodesics, 20, 0)
    below, above = next(p for p in points if p[2] == 0.0), next(p for p in points if p[2] > 1.0)
    assert geodesics.distance_m(below, above) >= math.hypot(run, rise)
    path = geodesics.path(below, above)
    assert any(stairs.rect.contains(float(x), float(y)) for x, y, _ in path)
    assert path[:, 2].min() == 0.0
    assert path[:, 2].max() == pytest.approx(rise)


def test_cut_off_and_unstandable_points_are_infinitely_far() -> None:
    house = generate_layout(4)
    doors = [o for o in house.openings if o.kind != "window"]
    room = next(room for room in house.rooms if sum(room.id in o.rooms for o in doors) == 1)
    door = next(o for o in doors if room.id in o.rooms)
    closed = replace(house, openings=tuple(o for o in house.openings if o is not door))
    geodesics = Geodesics(Walkable(closed))
    hall = next(r for r in house.rooms if r.type == "hallway")
    inside, outside = (*room.centre, 0.0), (*hall.centre, 0.0)
    assert math.isinf(geodesics.distance_m(inside, outside))
    assert geodesics.path(inside, outside).shape == (0, 3)
    assert math.isinf(geodesics.distances_from([outside]).at(-50.0, 3.0, 0.0))
    assert math.isinf(geodesics.distances_from([(-50.0, 3.0, 0.0)]).at(*outside))
    assert hole(house, door).width > 0
    with pytest.raises(UsageError, match="no point"):
        geodesics.distances_from([])


def test_the_nearest_of_several_goals_counts() -> None:
    geodesics = bare(0)
    points = standing_points(geodesics, 6, 3)
    together = geodesics.distances_from(points[:3]).at_many(points)
    apart = np.array([geodesics.distances_from([point]).at_many(points) for point in points[:3]])
    assert together == pytest.approx(apart.min(axis=0), abs=0.02)
