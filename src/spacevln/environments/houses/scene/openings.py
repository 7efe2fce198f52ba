"""Casings, door leaves and windows: everything that carries the instance of an opening."""

from __future__ import annotations

import math

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit
from spacevln.environments.houses.furniture.leaf import CASING_M, LeafPlace, face_of, leaf_place
from spacevln.environments.houses.plan import House, Opening
from spacevln.environments.houses.scene.pieces import Piece, baked

_PROUD_M = 0.02
_LINING_M = 0.005
_LEAF_M = 0.04
_PAINT = {"white": "plain-white", "brown": "wood-oak", "gray": "plain-gray", "dark": "wood-walnut"}


def opening_pieces(house: House, opening: Opening) -> list[Piece]:
    """All pieces of a doorway, an open-plan opening or a window."""
    kit = Kit(np.random.default_rng(opening.id))
    if opening.kind == "window":
        _window(kit, house, opening)
    else:
        _casing(kit, house, opening)
        leaf = leaf_place(house, opening)
        if leaf is not None:
            _leaf(kit, house, opening, leaf)
    yaw = 0.0 if opening.along == "x" else math.pi / 2
    base = house.floors[opening.floor].z_m
    room = opening.rooms[0] if opening.rooms[1] is None else None
    return [
        Piece(triangles, stuff, opening.id, room, (opening.x, opening.y, base), yaw)
        for stuff, triangles in baked(tuple(kit.parts))
    ]


def _casing(k: Kit, house: House, opening: Opening) -> None:
    """Boards on both faces of the wall and a thin lining; local x runs along the wall."""
    stuff = next((_PAINT[word] for word in opening.attributes if word in _PAINT), "plain-white")
    w, h, t = opening.width_m, opening.head_m, house.wall_thickness_m
    ceiling = house.floors[opening.floor].ceiling_m
    top = min(CASING_M, ceiling - h - 0.005)
    for face in (-1, 1):
        y = face * (t / 2 + _PROUD_M / 2)
        for side in (-1, 1):
            k.box(stuff, CASING_M + _LINING_M, _PROUD_M, h, x=side * (w + CASING_M - _LINING_M) / 2, y=y)
        k.box(stuff, w + 2 * CASING_M, _PROUD_M, top + _LINING_M, y=y, z=h - _LINING_M)
    # flush with the boards: a step of millimetres would be drawn as a dashed line
    for side in (-1, 1):
        k.box(stuff, _LINING_M + 0.002, t + 0.006, h, x=side * (w / 2 - _LINING_M / 2 + 0.001))
    k.box(stuff, w, t + 0.006, _LINING_M + 0.001, z=h - _LINING_M)
    if "arched" in opening.attributes:
        for side in (-1, 1):
            turn = (0.0, 0.0, 0.0 if side > 0 else math.pi)
            k.mesh("spandrel", stuff, 0.5, t + 0.04, 0.4, x=side * (w / 2 - 0.25), z=h - 0.4, turn=turn)
    if "glass" in opening.attributes:
        # one sliding panel stands open in front of the wall's outer face
        for x in (-w / 2 + 0.03, w / 2 - 0.03):
            k.box("gloss-silver", 0.03, t + 0.03, h, x=x - math.copysign(0.02, x))


def _leaf(k: Kit, house: House, opening: Opening, place: LeafPlace) -> None:
    """A panelled door, opened by 180 degrees."""
    # in the frame of a wall along y, +y (across) points to smaller x
    flip = 1 if opening.along == "x" else -1
    w, h = opening.width_m - 0.02, opening.head_m - 0.02
    stuff = next((_PAINT[word] for word in opening.attributes if word in _PAINT), "plain-white")
    x = place.side * (opening.width_m / 2 + 0.01 + w / 2)
    y = flip * place.face * (house.wall_thickness_m / 2 + _PROUD_M + 0.004 + _LEAF_M / 2)
    out = flip * place.face * (_LEAF_M / 2)
    k.box(stuff, w, _LEAF_M, h, x=x, y=y, z=0.01)
    for z, height in ((0.16, 0.72), (1.02, 0.86)):
        for s in (-1, 1):
            k.box(stuff, w * 0.36, 0.016, height, x=x + s * w * 0.22, y=y + out, z=z)
    k.ball("gloss-brass", 0.06, 0.06, 0.06, x=x + place.side * (w / 2 - 0.08), y=y + out * 2, z=0.96)


def _window(k: Kit, house: House, opening: Opening) -> None:
    """A white frame with bars, a pane that shows the outside, a sill; local +y is turned to the room."""
    flip = 1 if opening.along == "x" else -1
    inside = flip * face_of(opening, house.rooms[opening.rooms[0]])
    w, t = opening.width_m, house.wall_thickness_m
    z, h = opening.sill_m, opening.head_m - opening.sill_m
    y = -inside * t * 0.25
    k.box(f"sky-{opening.id % 6}", w, 0.012, h, y=y, z=z)
    for s in (-1, 1):
        k.box("plain-white", 0.05, 0.04, h, x=s * (w / 2 - 0.025), y=y + inside * 0.02, z=z)
    for bottom in (z, z + h - 0.05):
        k.box("plain-white", w, 0.04, 0.05, y=y + inside * 0.02, z=bottom)
    bars = max(1, round(w / 0.6)) - 1
    for i in range(bars):
        k.box("plain-white", 0.035, 0.03, h, x=(i + 1) * w / (bars + 1) - w / 2, y=y + inside * 0.02, z=z)
    if h > 0.9:
        k.box("plain-white", w, 0.03, 0.03, y=y + inside * 0.02, z=z + h * 0.55)
    proud = inside * (t / 2 + _PROUD_M / 2)
    for s in (-1, 1):
        k.box("plain-white", CASING_M, _PROUD_M, h, x=s * (w + CASING_M) / 2, y=proud, z=z)
    k.box("plain-white", w + 2 * CASING_M, _PROUD_M, CASING_M, y=proud, z=z + h)
    if z > 0.05:
        k.box("plain-white", w + 2 * CASING_M + 0.04, 0.08, 0.03, y=inside * t / 2, z=z - 0.034)
