"""The house of the records of the real Habitat-Sim, rebuilt as one of ours from its measures."""

from __future__ import annotations

import math

import numpy as np
from bridge_world import DATA

from spacevln.environments.houses.plan import Axis, Floor, House, Item, Opening, Part, Rect, Room

WALL_M = 0.12
CORNERS = {0: (0, 0, 5, 4), 1: (5, 0, 10, 4), 2: (0, 4, 5, 8), 3: (5, 4, 10, 8)}
"""Rooms in Habitat's x and z, between the middles of their walls."""
DOORS: tuple[tuple[tuple[int, int], float, float, Axis], ...] = (
    ((0, 1), 5, 2, "x"),
    ((2, 3), 5, 5.2, "x"),
    ((0, 2), 1.5, 4, "y"),
)
FIRST_THING = 23
"""Numbers below are of floors, ceilings and walls."""


def golden_house() -> House:
    return House(
        seed=0,
        floors=(Floor(0, 0.0, 2.5),),
        rooms=tuple(Room(k, "bedroom", 0, (_rect(*corners),)) for k, corners in CORNERS.items()),
        openings=tuple(Opening(100 + k, "doorway", 0, rooms, -z, -x, along, 0.9) for k, (rooms, x, z, along) in enumerate(DOORS)),
        stairs=(),
        items=tuple(_things()),
        wall_thickness_m=WALL_M,
    )


def _rect(x0: float, z0: float, x1: float, z1: float) -> Rect:
    half = WALL_M / 2
    return Rect(-z1 + half, -x1 + half, -z0 - half, -x0 - half)


def _things() -> list[Item]:
    data = np.load(DATA / "house.npz")
    found = []
    for number in range(FIRST_THING, int(data["ids"].max()) + 1):
        corners = data["triangles"][data["ids"] == number].reshape(-1, 3).astype(float)
        low, high = corners.min(0), corners.max(0)
        (mx, _, mz), (wx, wy, wz) = (low + high) / 2, high - low
        part = Part("box", (wz / 2, wx / 2, wy / 2), (0.0, 0.0, wy / 2), "white")
        found.append(Item(number, "thing", (), 0, 0, -mz, -mx, low[1], 0.0, (wz, wx, wy), (part,)))
    assert all(math.isfinite(item.x) for item in found)
    return found
