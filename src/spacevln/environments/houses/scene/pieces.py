"""What a scene is drawn from: pieces of triangles with a material, an instance id and a room."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from spacevln.environments.houses.furniture.mesh import Array, Triangles, join, part_triangles
from spacevln.environments.houses.materials import Material, material
from spacevln.environments.houses.plan import Item, Part, Rect


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Triangles that are drawn at once.

    Args:
        triangles: in the piece's frame.
        stuff: how they look; pieces of flat colours carry the first of them.
        instance: id in the house, 0 = structure.
        room: id of the room it is in or seen from; None = between or outside rooms.
        position_m: origin of the piece's frame in the scene.
        yaw_rad: its turn about z.
        shape: equal for pieces whose triangles are equal, or None.
    """

    triangles: Triangles
    stuff: Material
    instance: int
    room: int | None
    position_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw_rad: float = 0.0
    shape: object = None


@lru_cache(maxsize=4096)
def baked(parts: tuple[Part, ...]) -> tuple[tuple[Material, Triangles], ...]:
    """The parts of an item, joined by what is drawn together."""
    groups: dict[str, tuple[Material, list[Triangles]]] = {}
    for part in parts:
        stuff = material(part.material)
        groups.setdefault(stuff.draw, (stuff, []))[1].append(part_triangles(part))
    return tuple((stuff, join(pieces)) for stuff, pieces in groups.values())


def item_pieces(item: Item) -> list[Piece]:
    """Pieces of a piece of furniture."""
    at = (item.x, item.y, item.z)
    return [
        Piece(triangles, stuff, item.id, item.room, at, item.yaw_rad, (item.parts, k))
        for k, (stuff, triangles) in enumerate(baked(item.parts))
    ]


_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
_SIDES = {
    "-x": ((0, 1, 3, 2), (-1, 0, 0)),
    "+x": ((6, 7, 5, 4), (1, 0, 0)),
    "-y": ((4, 5, 1, 0), (0, -1, 0)),
    "+y": ((2, 3, 7, 6), (0, 1, 0)),
    "-z": ((2, 6, 4, 0), (0, 0, -1)),
    "+z": ((1, 5, 7, 3), (0, 0, 1)),
}


def box_faces(rect: Rect, z0: float, z1: float, sides: tuple[str, ...] = tuple(_SIDES)) -> tuple[Array, Array]:
    """Corners (4 n, 3) and normals (4 n, 3) of the quads of a box."""
    corners = np.array([rect.x0, rect.y0, z0]) + _CORNERS * np.array([rect.width, rect.depth, z1 - z0])
    index = [k for side in sides for k in _SIDES[side][0]]
    normals = np.array([_SIDES[side][1] for side in sides], float).repeat(4, axis=0)
    return corners[index], normals


def quads(points: Array, normals: Array, uv: Array) -> Triangles:
    """Triangles of consecutive quads, turned so that they face along their normals."""
    first = np.arange(0, len(points), 4)
    corners = points.reshape(-1, 4, 3)
    facing = np.einsum("ij,ij->i", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), normals[::4]) > 0
    ahead = np.stack([first, first + 1, first + 2, first, first + 2, first + 3], 1)
    back = np.stack([first, first + 2, first + 1, first, first + 3, first + 2], 1)
    faces = np.where(facing[:, None], ahead, back).reshape(-1, 3).astype(np.int32)
    return Triangles(points, normals, uv, faces)


def flat_uv(points: Array, normals: Array, stuff: Material) -> Array:
    """Texture coordinates of axis-aligned faces, in metres of the scene."""
    if stuff.palette_uv is not None:
        return np.tile(np.array(stuff.palette_uv), (len(points), 1))
    axis = np.abs(normals).argmax(axis=1)
    across = np.where(axis == 0, points[:, 1], points[:, 0])
    up = np.where(axis == 2, points[:, 1], points[:, 2])
    return np.column_stack([across, up]) / (stuff.scale_m or 1.0)


def boxes(rects: list[tuple[Rect, float, float]], key: str) -> tuple[Material, Triangles]:
    """Several axis-aligned boxes of one material."""
    stuff = material(key)
    made = [box_faces(*box) for box in rects]
    points, normals = np.concatenate([p for p, _ in made]), np.concatenate([n for _, n in made])
    return stuff, quads(points, normals, flat_uv(points, normals, stuff))
