"""A scripted walk through an embedded house: the exploration behind every measurement of map and memory against the truth."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Pose
from spacevln.environments.houses.ground.walkable import RESOLUTION_M, Walkable
from spacevln.environments.houses.plan import Room
from spacevln.environments.houses.walking.geodesics import Geodesics

STEP_M = 0.25
CLEARANCE_M = 0.25
"""Least distance of a visited place from every obstacle."""


@dataclass(frozen=True, slots=True)
class Stand:
    """A place on the walk.

    Args:
        pose: scene frame.
        looks_around: here the walker turns once around, as at a planning boundary; this pose is where it begins and ends.
        room: that holds the place; None on a threshold or on stairs.
    """

    pose: Pose
    looks_around: bool
    room: Room | None


def scripted_walk(
    geodesics: Geodesics, seed: int, *, floors: Sequence[int] | None = None, every_m: float = 3.0, rooms: int | None = None
) -> Iterator[Stand]:
    """Walk from room to room, the nearest unseen one next, and look around in each and every ``every_m`` between.

    Args:
        geodesics: of the house.
        seed: of the place chosen in each room and of the first heading.
        floors: storeys to visit; all of them by default, over the stairs.
        every_m: way between look-arounds.
        rooms: visit only so many.
    """
    walkable, rng = geodesics.walkable, np.random.default_rng([seed, 77])
    house = walkable.house
    visited = range(len(house.floors)) if floors is None else floors
    places = [place for room in house.rooms if room.floor in visited and (place := _place_in(room, walkable, rng)) is not None]
    at, yaw, since = places.pop(0), float(rng.uniform(-math.pi, math.pi)), math.inf
    line, left = at[None], (rooms or len(places) + 1) - 1
    while True:
        for k, (x, y, height) in enumerate(line.tolist()):
            if k:
                yaw = math.atan2(y - line[k - 1][1], x - line[k - 1][0])
                since += STEP_M
            z = walkable.floor_height_m(x, y, height)
            room = house.room_at(x, y, walkable.floor_index(x, y, z)) if walkable.stairs_at(x, y, z) is None else None
            looks = since >= every_m or k == len(line) - 1
            yield Stand(Pose(x, y, z, yaw), looks, room)
            since = 0.0 if looks else since
        ways = geodesics.distances_from(at[None]).at_many(np.array(places).reshape(-1, 3))
        reachable = [(way, index) for index, way in enumerate(ways.tolist()) if math.isfinite(way)]
        if not reachable or not left:
            return
        goal = places.pop(min(reachable)[1])
        line, at, left = _stepped(geodesics.path(at, goal)), goal, left - 1


def turned_around(pose: Pose, count: int = 12) -> tuple[Pose, ...]:
    """The poses of a look-around, counter-clockwise from the heading."""
    return tuple(pose.turned(k * math.tau / count) for k in range(count))


def _place_in(room: Room, walkable: Walkable, rng: np.random.Generator) -> NDArray[np.float64] | None:
    """A random place of a room that is clear of everything; None where there is none."""
    space = walkable.floors[room.floor]
    rect = max(room.rects, key=lambda rect: rect.area)
    rows, columns = space.cells_of(rect)
    clear = np.argwhere(space.clearance_m[rows, columns] >= CLEARANCE_M)
    points = np.array(space.centre(rows.start, columns.start)) + clear * RESOLUTION_M
    z = walkable.house.floors[room.floor].z_m
    inside = [(x, y) for x, y in points.tolist() if room.contains(x, y, CLEARANCE_M) and walkable.stairs_at(x, y, z) is None]
    return np.array([*inside[int(rng.integers(len(inside)))], z]) if inside else None


def _stepped(path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places at most one step apart on a polyline, without its first point."""
    legs = []
    for a, b in pairwise(path):
        count = max(1, math.ceil(math.dist(a[:2], b[:2]) / STEP_M))
        legs.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(legs)
