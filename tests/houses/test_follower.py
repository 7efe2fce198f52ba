"""The shortest-path follower reaches what is reachable, over stairs too."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacevln.core.actions import MoveForward, Stop, TurnLeft
from spacevln.core.geometry import Pose
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.walking.follower import ShortestPathFollower
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.environments.houses.walking.motion import Body


def walk(seed: int, pairs: int) -> list[tuple[float, float]]:
    """Distance left and ratio of the way to the shortest one, for random routes of a furnished house."""
    house = build_house(seed)
    walkable = Walkable(house)
    geodesics, body, rng = Geodesics(walkable), Body(walkable), np.random.default_rng(seed)
    points: list[tuple[float, float, float]] = []
    while len(points) < 2 * pairs:
        floor = len(points) % len(house.floors)
        rooms = [room for room in house.rooms if room.floor == floor]
        rect = rooms[int(rng.integers(len(rooms)))].rects[0]
        x, y = (float(v) for v in rng.uniform((rect.x0, rect.y0), (rect.x1, rect.y1)))
        z = house.floors[floor].z_m
        if walkable.stairs_at(x, y, z) is None and walkable.is_walkable(x, y, z, 0.15):
            points.append((x, y, z))
    results = []
    for start, goal in zip(points[::2], points[1::2], strict=True):
        field = geodesics.distances_from([goal])
        if math.isinf(field.at(*start)):
            continue  # one of them lies in a gap between furniture
        follower, pose, way = ShortestPathFollower(body, field), Pose(*start, 0.3), 0.0
        for _ in range(500):
            match follower.action(pose):
                case Stop():
                    break
                case MoveForward(distance_m=distance_m):
                    pose, motion = body.forward(pose, distance_m)
                    way += motion.moved_m
                case turn:
                    sign = 1 if isinstance(turn, TurnLeft) else -1
                    pose, _ = body.turn(pose, sign * math.radians(30))
        results.append((field.at(*pose.position_m), way / max(field.at(*start), 1.0)))
    return results


@pytest.mark.parametrize("seeds", [(8, 5, 25), pytest.param(range(300, 340), marks=pytest.mark.slow)])
def test_the_follower_arrives_on_a_short_way(seeds: range) -> None:
    results = [result for seed in seeds for result in walk(seed, 3)]
    assert len(results) > 2 * len(seeds)
    assert max(left for left, _ in results) <= 0.25
    assert np.mean([ratio for _, ratio in results]) < 1.15
