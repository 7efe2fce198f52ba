# ruff: noqa: ARG001, ARG002 - stands in for real things
"""A hand-made house: a 4 x 4 m living room and a 4 x 4 m bedroom east of it, joined by a doorway; a box, a drum, a lamp.

Scene frame: the living room spans x 0..4, y 0..4; the wall between x 4..4.12; the bedroom x 4.12..8.12. Doorway at y 2, 0.9 m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from spacevln.environments.houses.environment import Place
from spacevln.environments.houses.plan import Floor, House, Item, Opening, Part, Rect, Room
from spacevln.environments.houses.rendering.protocol import Drawable

DOOR, BOX, DRUM, LAMP = 1, 2, 3, 4
WALL = 0.12


def _item(instance: int, category: str, attributes: tuple[str, ...], xy: tuple[float, float], yaw: float, part: Part) -> Item:
    size = tuple(2 * v for v in part.size)
    room = 0 if xy[0] < 4 else 1
    return Item(instance, category, attributes, room, 0, *xy, 0.0, yaw, size, (part,))  # type: ignore[arg-type]


def house() -> House:
    return House(
        seed=0,
        floors=(Floor(0, 0.0, 2.6),),
        rooms=(Room(0, "living room", 0, (Rect(0, 0, 4, 4),)), Room(1, "bedroom", 0, (Rect(4.12, 0, 8.12, 4),))),
        openings=(Opening(DOOR, "doorway", 0, (0, 1), 4.06, 2.0, "y", 0.9, attributes=("white",)),),
        stairs=(),
        items=(
            _item(BOX, "cabinet", ("red",), (1.0, 3.5), math.pi / 6, Part("box", (0.4, 0.2, 0.5), (0, 0, 0.5), "red")),
            _item(DRUM, "drum", ("blue",), (7.0, 1.0), 0.0, Part("cylinder", (0.3, 0.4, 0.0), (0, 0, 0.4), "blue")),
            _item(LAMP, "lamp", ("yellow",), (3.6, 0.5), 0.0, Part("ellipsoid", (0.1, 0.1, 0.7), (0, 0, 0.7), "yellow")),
        ),
        wall_thickness_m=WALL,
    )


def wall_boxes() -> list[tuple[float, float, float, float]]:
    """Centre and half extents of the walls' footprints."""
    half = WALL / 2
    outer = [
        (4.06, -half, 4.06 + WALL, half),
        (4.06, 4 + half, 4.06 + WALL, half),
        (-half, 2, half, 2 + WALL),
        (8.12 + half, 2, half, 2 + WALL),
    ]
    return [*outer, (4.06, 0.775, half, 0.775), (4.06, 3.225, half, 0.775)]


def obstacles() -> tuple[np.ndarray, np.ndarray]:
    """Boxes (N, 6) and discs (M, 3) as motion takes them."""
    walls = [(x, y, 1.0, 0.0, hx, hy) for x, y, hx, hy in wall_boxes()]
    boxes = [*walls, (1.0, 3.5, math.cos(math.pi / 6), math.sin(math.pi / 6), 0.4, 0.2)]
    return np.array(boxes), np.array([(7.0, 1.0, 0.3), (3.6, 0.5, 0.1)])


def drawable() -> Drawable:
    spec = mujoco.MjSpec()
    spec.visual.headlight.ambient = [0.4] * 3
    ids = []

    def add(kind: str, size: tuple[float, ...], pos: tuple[float, ...], rgb: tuple[float, ...], instance: int, yaw: float = 0.0):
        geom = getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}")
        quat = [math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)]
        spec.worldbody.add_geom(type=geom, size=[*size, 0, 0][:3], pos=pos, quat=quat, rgba=[*rgb, 1])
        ids.append(instance)

    add("box", (4.2, 2.2, 0.05), (4.06, 2, -0.05), (0.6, 0.5, 0.4), 0)
    add("box", (4.2, 2.2, 0.05), (4.06, 2, 2.65), (0.9, 0.9, 0.9), 0)
    for x, y, hx, hy in wall_boxes():
        add("box", (hx, hy, 1.3), (x, y, 1.3), (0.8, 0.8, 0.7), 0)
    add("box", (WALL / 2, 0.45, 0.275), (4.06, 2, 2.325), (0.8, 0.8, 0.7), 0)  # over the doorway
    add("box", (0.08, 0.03, 1.02), (4.06, 1.57, 1.02), (1, 1, 1), DOOR)  # its frame
    add("box", (0.08, 0.03, 1.02), (4.06, 2.43, 1.02), (1, 1, 1), DOOR)
    colours = {"red": (0.8, 0.1, 0.1), "blue": (0.1, 0.1, 0.8), "yellow": (0.9, 0.8, 0.1)}
    for item in house().items:
        for part in item.parts:
            position = (item.x, item.y, item.z + part.position[2])
            add(part.shape, part.size, position, colours[part.material], item.id, item.yaw_rad)
    return Drawable(house(), spec.compile(), np.array(ids, np.int32))


@dataclass(frozen=True)
class Space:
    boxes: np.ndarray
    discs: np.ndarray


class FlatGround:
    """The ground of the house: one storey at height 0."""

    floors = (Space(*obstacles()),)

    def floor_index(self, x: float, y: float, floor_hint_z: float) -> int:
        return 0

    def floor_height_m(self, x: float, y: float, floor_hint_z: float) -> float:
        return 0.0


def place(scene: str) -> Place:
    """For ``HousesEnvironment(load=two_rooms.place)``; every scene is this house."""
    return Place(drawable(), FlatGround())
