"""A bedroom, a hallway, a kitchen and a living room, drawn; and how a walk through them is remembered."""

from __future__ import annotations

import math

import numpy as np
from drawn_map import DrawnMap

from spacevln.core import Pose, Sighting
from spacevln.memory import SpatialCognitiveMemory

ROOMS = [
    (0, 0, 4, 4),  # bedroom
    (4.1, 1.5, 10, 2.7),  # hallway
    (5, 2.8, 9, 7),  # kitchen
    (10.1, -1, 15, 5),  # living room
    (3.9, 1.6, 4.3, 2.5),  # doorways
    (6.5, 2.6, 7.4, 2.9),
    (9.9, 1.5, 10.2, 2.7),
]
FURNITURE = [(0, 0, 2, 1.6), (6, 4.5, 7.5, 5.3), (13, 0, 14.5, 2), (11, 4.2, 13, 5)]

WALK = (
    (Pose(3, 3, 0, -0.3), "bedroom - bed"),
    (Pose(5, 2.1, 0, 0), "hallway"),
    (Pose(8, 2.1, 0, 0.2), "corridor - doorway"),
    (Pose(7, 3.8, 0, 1.6), "kitchen - dining table"),
    (Pose(9.2, 2.0, 0, 0), "hallway"),
    (Pose(11, 2.2, 0, 0), "living room - white sofa"),
    (Pose(12.5, 3.2, 0, 0.6), "living room - bookshelf / sofa"),
)


def thing(category: str, x: float, y: float, attributes: tuple[str, ...] = (), **changes: object) -> Sighting:
    facts = {
        "confidence": 0.8,
        "box_px": (0, 0, 50, 90),
        "position_m": (x, y, 0.5),
        "distance_m": 1.5,
        "bearing_rad": 0.0,
        "extent_m": 0.5,
        "attributes": attributes,
        "pixels": 900,
        "surface_m": ((x, y),),
    }
    return Sighting(category=category, **(facts | changes))  # type: ignore[arg-type]


def door(a: tuple[float, float], b: tuple[float, float], distance_m: float = 1.5) -> Sighting:
    line = tuple((float(x), float(y)) for x, y in np.linspace(a, b, 8))
    middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    return thing("doorway", *middle, surface_m=line, is_passage=True, extent_m=math.dist(a, b), distance_m=distance_m)


DOORS = (door((4.05, 1.6), (4.05, 2.5)), door((6.5, 2.75), (7.4, 2.75)), door((10.05, 1.5), (10.05, 2.7)))
THINGS = (
    thing("bed", 1, 0.8, ("blue",)),
    thing("nightstand", 0.5, 2),
    thing("dining table", 6.7, 4.9, ("wooden",)),
    thing("stove", 8.7, 6),
    thing("refrigerator", 5.2, 6.5),
    thing("sofa", 13.5, 1, ("white", "leather")),
    thing("bookshelf", 12, 4.6),
)


def house(floor: int = 0) -> DrawnMap:
    return DrawnMap(ROOMS, FURNITURE, floor)


def seen_from(pose: Pose, metric_map: DrawnMap) -> list[Sighting]:
    def in_sight(item: Sighting) -> bool:
        distance = pose.distance_m(*item.position_m[:2])
        way = np.arange(0, max(distance - 1.2, 0.1), 0.04)[:, None] / distance
        return distance < 5 and not metric_map.is_obstacle(pose.xy_m + way * (np.array(item.position_m[:2]) - pose.xy_m)).any()

    return [*DOORS, *DOORS, *filter(in_sight, THINGS)]  # neighbouring views overlap


def remembered(metric_map: DrawnMap, walk: tuple[tuple[Pose, str], ...] = WALK) -> SpatialCognitiveMemory:
    """The memory after a walk."""
    memory = SpatialCognitiveMemory()
    previous = None
    for pose, anchor in walk:
        if previous is not None:
            metric_map.walk(previous, pose)
        memory.add_waypoint(pose, anchor, seen_from(pose, metric_map), metric_map)
        previous = pose
    return memory
