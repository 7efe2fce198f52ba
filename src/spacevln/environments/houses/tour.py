"""A house as a visitor sees it: one view per room."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Pose
from spacevln.core.sensing import Camera, Observation
from spacevln.core.task import EpisodeSpec, InstructionTask
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.houses.plan import House, Room
from spacevln.environments.houses.walkable import RESOLUTION_M, Walkable

CLEARANCE_M = 0.15
EYE = Camera(640, 480, 79.0, 0.88)


@dataclass(frozen=True, slots=True, eq=False)
class RoomView:
    """A room and the view into it."""

    room: Room
    observation: Observation


def room_views(house: House, camera: Camera = EYE) -> Iterator[RoomView]:
    """One view of every room, from the standing place whose view reaches deepest into it.

    Args:
        house: furnished.
        camera: at the agent's height.
    """
    walkable = Walkable(house)
    environment = HousesEnvironment(camera)
    try:
        for room in house.rooms:
            pose = _standing_place(house, walkable, room)
            if pose is not None:
                spec = EpisodeSpec(f"room-{room.id}", house.name, pose, InstructionTask("Look."))
                yield RoomView(room, environment.reset(spec))
    finally:
        environment.close()


def _standing_place(house: House, walkable: Walkable, room: Room) -> Pose | None:
    """The walkable place far from the room's middle, looking at it; None when nobody can stand in the room."""
    floor = walkable.floors[room.floor]
    cells = np.argwhere(floor.clearance_m >= CLEARANCE_M)
    points: NDArray[np.float64] = np.array(floor.origin_m) + (cells + 0.5) * RESOLUTION_M
    inside = np.array([room.contains(float(x), float(y), 0.15) for x, y in points], dtype=bool)
    if not inside.any():
        return None
    x, y = room.centre
    places = points[inside]
    best = places[int(np.argmax(np.hypot(places[:, 0] - x, places[:, 1] - y)))]
    yaw = math.atan2(y - best[1], x - best[0])
    return Pose(float(best[0]), float(best[1]), house.floors[room.floor].z_m, yaw)
