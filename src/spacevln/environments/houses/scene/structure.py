"""Walls, floors, ceilings, stairs and railings as pieces."""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np

from spacevln.environments.houses.furniture.mesh import Array, Triangles, join, part_triangles
from spacevln.environments.houses.layout.structure import SlabBox, WallBox, direction, railings, slabs, steps, walls
from spacevln.environments.houses.materials import material
from spacevln.environments.houses.plan import House, Part, Rect, Stairs
from spacevln.environments.houses.scene.pieces import Piece, box_faces, boxes, flat_uv, quads

_OUTSIDE = "wall-siding-cream"
_CEILING = "lit-white"
_BALUSTER = "plain-white"
_TREAD_M, _NOSE_M = 0.035, 0.02


def wall_pieces(house: House) -> list[Piece]:
    """One piece per room with the faces of its wall halves, and one per storey for the outer skin."""
    found = []
    for floor, solid in zip(house.floors, walls(house), strict=True):
        by_room: dict[int | None, list[WallBox]] = defaultdict(list)
        for box in solid:
            by_room[box.room].append(box)
        found += _balustrades(by_room)
        for room, members in by_room.items():
            key = _OUTSIDE if room is None else house.styles[room][1]
            made = [box_faces(box.rect, box.z0_m, box.z1_m, _sides(box)) for box in members if box.part != "parapet"]
            if not made:
                continue
            points, normals = np.concatenate([p for p, _ in made]), np.concatenate([n for _, n in made])
            found.append(Piece(_wall_uv(points, normals, key, floor.z_m, floor.ceiling_m), material(key), 0, room))
    return found


def _balustrades(by_room: dict[int | None, list[WallBox]]) -> list[Piece]:
    """The low walls of balconies, drawn as rails on balusters (they block like a wall)."""
    found = []
    for room, members in by_room.items():
        bars = [bar for box in members if box.part == "parapet" and room is not None for bar in _balustrade(box)]
        if bars:
            stuff, triangles = boxes(bars, _BALUSTER)
            found.append(Piece(triangles, stuff, 0, room))
    return found


def _balustrade(box: WallBox) -> list[tuple[Rect, float, float]]:
    r, z0, z1 = box.rect, box.z0_m, box.z1_m
    along_x = r.width >= r.depth
    length = max(r.width, r.depth)
    if length < 0.2:
        return [(r, z0, z1)]
    bars = [(r, z1 - 0.06, z1), (r, z0 + 0.06, z0 + 0.12)]
    count = max(1, round(length / 0.14))
    for k in range(count):
        t = (k + 0.5) * length / count
        x, y = (r.x0 + t, r.centre[1]) if along_x else (r.centre[0], r.y0 + t)
        bars.append((Rect(x - 0.016, y - 0.016, x + 0.016, y + 0.016), z0, z1 - 0.06))
    return bars


def _sides(box: WallBox) -> tuple[str, ...]:
    around = ("-x", "+x", "-y", "+y")
    if box.part == "sill":
        return (*around, "+z")
    return (*around, "-z") if box.part == "header" else around


def _wall_uv(points: Array, normals: Array, key: str, z_m: float, height_m: float) -> Triangles:
    stuff = material(key)
    across = np.where(np.abs(normals[:, 0]) > 0.5, points[:, 1], points[:, 0])
    uv = np.column_stack([across / (stuff.scale_m or 1.0), np.clip((points[:, 2] - z_m) / height_m, 0.002, 0.998)])
    return quads(points, normals, uv)


def slab_pieces(house: House) -> list[Piece]:
    """Floors and ceilings, one piece each per room; the sides of slabs show only in stairwells."""
    by_room: dict[tuple[int, str], list[SlabBox]] = defaultdict(list)
    for slab in slabs(house):
        by_room[slab.room, slab.part].append(slab)
    found = []
    well = {stairs.lower_floor for stairs in house.stairs} | {stairs.lower_floor + 1 for stairs in house.stairs}
    for (room, part), members in by_room.items():
        side = "+z" if part == "floor" else "-z"
        stuff = material(house.styles[room][0] if part == "floor" else _CEILING)
        made = [box_faces(slab.rect, slab.z0_m, slab.z1_m, (side,)) for slab in members]
        points, normals = np.concatenate([p for p, _ in made]), np.concatenate([n for _, n in made])
        found.append(Piece(quads(points, normals, flat_uv(points, normals, stuff)), stuff, 0, room))
        if house.rooms[room].floor in well:
            found += _slab_edges(house, members, room)
    return found


def _slab_edges(house: House, members: list[SlabBox], room: int) -> list[Piece]:
    made = []
    for slab in members:
        for stairs in house.stairs:
            r, s = slab.rect, stairs.rect
            touching = r.x0 <= s.x1 + 1e-3 and r.x1 >= s.x0 - 1e-3 and r.y0 <= s.y1 + 1e-3 and r.y1 >= s.y0 - 1e-3
            if touching and stairs.lower_floor <= house.rooms[room].floor <= stairs.lower_floor + 1:
                made.append(box_faces(r, slab.z0_m, slab.z1_m - 0.001, ("-x", "+x", "-y", "+y")))
    if not made:
        return []
    points, normals = np.concatenate([p for p, _ in made]), np.concatenate([n for _, n in made])
    stuff = material("plain-ivory")
    return [Piece(quads(points, normals, flat_uv(points, normals, stuff)), stuff, 0, room)]


def lawn_pieces(house: House) -> list[Piece]:
    """A lawn around houses that have a balcony on the ground floor, from which it is seen."""
    rects = [rect for room in house.rooms for rect in room.rects]
    if not any(room.type == "balcony" and room.floor == 0 for room in house.rooms):
        return []
    x0, y0, x1, y1 = min(r.x0 for r in rects), min(r.y0 for r in rects), max(r.x1 for r in rects), max(r.y1 for r in rects)
    stuff = material("lawn-grass")
    points, normals = box_faces(Rect(x0 - 25, y0 - 25, x1 + 25, y1 + 25), -0.6, -0.55, ("+z",))
    return [Piece(quads(points, normals, flat_uv(points, normals, stuff)), stuff, 0, None)]


def stair_pieces(house: House) -> list[Piece]:
    """Steps with wooden treads and white risers, and their railings; all carry the instance of the flight."""
    found = []
    for stairs in house.stairs:
        low = house.floors[stairs.lower_floor].z_m
        treads, sides = [], []
        for step in steps(house, stairs):
            treads.append(box_faces(_nosed(stairs, step.rect), step.z1_m - _TREAD_M, step.z1_m))
            sides.append(box_faces(step.rect, max(low, step.z0_m), step.z1_m - _TREAD_M, ("-x", "+x", "-y", "+y")))
        for key, made in (("wood-oak", treads), ("plain-ivory", sides)):
            points, normals = np.concatenate([p for p, _ in made]), np.concatenate([n for _, n in made])
            stuff = material(key)
            found.append(Piece(quads(points, normals, flat_uv(points, normals, stuff)), stuff, stairs.id, None))
    found += _railing_pieces(house)
    return found


def _nosed(stairs: Stairs, rect: Rect) -> Rect:
    """A tread that reaches a little over the riser below it, so that the edge of every step shows."""
    ux, uy = direction(stairs)
    return Rect(
        rect.x0 - _NOSE_M * (ux > 0), rect.y0 - _NOSE_M * (uy > 0), rect.x1 + _NOSE_M * (ux < 0), rect.y1 + _NOSE_M * (uy < 0)
    )


def _railing_pieces(house: House) -> list[Piece]:
    by_stairs: dict[int, list[tuple[str, Triangles]]] = defaultdict(list)
    for railing in railings(house):
        a, b = np.array(railing.a), np.array(railing.b)
        length = float(np.linalg.norm(b - a))
        yaw = math.atan2(b[1] - a[1], b[0] - a[0])
        pitch = -math.atan2(b[2] - a[2], float(np.hypot(*(b - a)[:2])))
        middle = (a + b) / 2 + np.array([0, 0, railing.height_m])
        key = _nearest(house, railing.rect)
        # an intrinsic xyz turn cannot yaw first, so the rail is turned about its own y after a yaw of the points
        rail = _yawed(Part("box", (length / 2, 0.03, 0.025), (0.0, 0.0, 0.0), "wood-walnut", (0.0, pitch, 0.0)), yaw, middle)
        by_stairs[key].append(("wood-walnut", rail))
        count = max(2, round(float(np.hypot(*(b - a)[:2])) / 0.16) + 1)
        for k in range(count):
            foot = a + (b - a) * (k + 0.02) / (count - 1 + 0.04)
            thick = 0.035 if k in (0, count - 1) else 0.014
            post = Part("box", (thick, thick, railing.height_m / 2), (0.0, 0.0, 0.0), "plain-white")
            by_stairs[key].append(("plain-white", _yawed(post, yaw, foot + np.array([0, 0, railing.height_m / 2]))))
    return [
        Piece(join([triangles for used, triangles in made if used == name]), material(name), key, None)
        for key, made in by_stairs.items()
        for name in ("wood-walnut", "plain-white")
    ]


def _yawed(part: Part, yaw: float, at: Array) -> Triangles:
    made = part_triangles(part)
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return Triangles(made.points @ turn + at, made.normals @ turn, made.uv, made.faces)


def _nearest(house: House, rect: Rect) -> int:
    def away(stairs: Stairs) -> float:
        return math.dist(stairs.rect.centre, rect.centre)

    return min(house.stairs, key=away).id
