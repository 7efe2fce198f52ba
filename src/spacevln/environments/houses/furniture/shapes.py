"""Self-made meshes: turned, extruded and grown in code, each within -1..1 on every axis."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np

from spacevln.environments.houses.furniture.mesh import (
    CUSTOM,
    Array,
    Faces,
    UnitMesh,
    double_sided,
    extrude,
    lathe,
    superellipsoid,
    torus,
    unit_mesh,
)


def _foliage(leaves: int, droop: float, width: float, seed: int) -> UnitMesh:
    """Leaves that grow out of (0, 0, -1) and bend over."""
    rng = np.random.default_rng([seed, 11])
    points: list[tuple[float, float, float]] = []
    faces: list[tuple[int, int, int]] = []
    for k in range(leaves):
        yaw = 2.4 * k + rng.uniform(-0.3, 0.3)
        lift = rng.uniform(0.35, 1.0)
        reach = rng.uniform(0.75, 1.0) * (1.25 - 0.6 * lift)
        heading, side = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
        base = len(points)
        for t, w in ((0.0, 0.02), (0.35, 0.6), (0.7, 1.0), (1.0, 0.03)):
            height = -1 + 2 * lift * (t - droop * t**2)
            centre = heading * reach * t
            for sign in (-1, 1):
                xy = centre + side * sign * w * width
                points.append((xy[0], xy[1], height))
        for s in range(3):
            a = base + 2 * s
            faces += [(a, a + 1, a + 3), (a, a + 3, a + 2)]
    array = np.clip(np.array(points), -1, 1)
    return double_sided(unit_mesh(array, np.array(faces, np.int32)))


def _bush() -> UnitMesh:
    rng = np.random.default_rng([5, 11])
    ball = superellipsoid(1.0, 9, 6)
    points: list[Array] = []
    normals: list[Array] = []
    faces: list[Faces] = []
    for k in range(9):
        centre = np.array([0.0, 0.0, 0.0]) if k == 0 else rng.uniform(-0.5, 0.5, 3)
        faces.append(ball.faces + sum(len(p) for p in points))
        points.append(np.clip(ball.points * rng.uniform(0.4, 0.55) + centre, -1, 1))
        normals.append(ball.normals)
    return unit_mesh(np.vstack(points), np.vstack(faces), np.vstack(normals))


def _curtain() -> UnitMesh:
    x = np.linspace(-1, 1, 21)
    y = 0.9 * np.sin(x * np.pi * 5)
    slope = 0.9 * 5 * np.pi * np.cos(x * np.pi * 5) * 0.12
    points: list[tuple[float, float, int]] = []
    normals: list[Array] = []
    faces: list[tuple[int, int, int]] = []
    for k, (px, py, s) in enumerate(zip(x, y, slope, strict=True)):
        for z in (-1, 1):
            points.append((px, py, z))
            normals.append(np.array([-s, 1, 0]) / np.hypot(s, 1))
        if k:
            a = 2 * (k - 1)
            faces += [(a, a + 1, a + 3), (a, a + 3, a + 2)]
    return double_sided(unit_mesh(np.array(points), np.array(faces, np.int32), np.array(normals)))


def _basin(power: float, wall: float = 0.16) -> UnitMesh:
    """An open vessel with a rim: outside, rim and inside."""
    angles = np.linspace(-np.pi, np.pi, 20, endpoint=False)
    c, s = np.cos(angles), np.sin(angles)
    ring = np.stack([np.sign(c) * np.abs(c) ** power, np.sign(s) * np.abs(s) ** power], 1)
    inner = 1 - wall
    bands = ((0.72, -1), (0.97, 0.6), (1.0, 1.0), (inner, 1.0), (inner - 0.12, -0.4), (0.02, -0.55))
    corners = []
    for (r0, z0), (r1, z1) in itertools.pairwise(bands):
        for k in range(20):
            n = (k + 1) % 20
            a, b = (*ring[k] * r0, z0), (*ring[n] * r0, z0)
            d, e = (*ring[k] * r1, z1), (*ring[n] * r1, z1)
            corners += [a, b, e, a, e, d]
    points = np.array(corners)
    return unit_mesh(points, np.arange(len(points), dtype=np.int32).reshape(-1, 3))


CAR = [
    (-0.96, -0.75), (-0.83, -0.75), (-0.79, -0.1), (-0.7, 0.32), (-0.606, 0.42), (-0.51, 0.32), (-0.42, -0.1), (-0.38, -0.8),
    (0.38, -0.8), (0.42, -0.1), (0.51, 0.32), (0.606, 0.42), (0.7, 0.32), (0.79, -0.1), (0.83, -0.75), (0.96, -0.75),
    (1.0, -0.15), (0.98, 0.3), (0.9, 0.55), (0.5, 0.86), (-0.68, 0.86), (-0.93, 0.76), (-0.978, 0.5), (-0.982, -0.2)
]  # fmt: skip
_CIRCLE = [(math.cos(k * math.tau / 28), math.sin(k * math.tau / 28)) for k in range(28)]
GARMENT = [
    (-0.66, -0.96), (-0.2, -0.99), (0.25, -0.95), (0.62, -1.0), (0.52, 0.4), (0.72, -0.12), (1.0, -0.06), (0.76, 0.74),
    (0.18, 1.0), (0.0, 0.9), (-0.18, 1.0), (-0.76, 0.74), (-1.0, -0.06), (-0.72, -0.12), (-0.52, 0.4)
]  # fmt: skip
CABIN = [(-1.0, -1.0), (1.0, -1.0), (0.45, 1.0), (-0.62, 1.0)]
GRAND = [
    (-1.0, 1.0), (-1.0, -0.55), (-0.8, -0.95), (-0.4, -1.0), (-0.1, -0.8), (0.1, -0.35),
    (0.4, 0.05), (0.85, 0.25), (1.0, 0.55), (1.0, 1.0)
]  # fmt: skip
GUITAR = [
    (0.0, -1.0), (0.6, -0.92), (0.98, -0.55), (0.85, -0.12), (0.55, 0.15), (0.7, 0.5), (0.6, 0.85), (0.2, 1.0),
    (-0.2, 1.0), (-0.6, 0.85), (-0.7, 0.5), (-0.55, 0.15), (-0.85, -0.12), (-0.98, -0.55), (-0.6, -0.92)
]  # fmt: skip
ROCKER = [
    (-1.0, 0.2), (-0.6, -0.5), (0.0, -1.0), (0.6, -0.5), (1.0, 0.2), (1.0, 1.0), (0.6, 0.1), (0.0, -0.4), (-0.6, 0.1), (-1.0, 1.0)
]  # fmt: skip
SPANDREL = [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-0.25, 0.87), (0.35, 0.5), (0.78, -0.1)]
BUST = [
    (0.0, -1.0), (0.85, -1.0), (0.85, -0.86), (0.45, -0.8), (0.55, -0.55), (1.0, -0.3), (0.95, -0.08), (0.4, 0.1),
    (0.28, 0.22), (0.3, 0.32), (0.48, 0.42), (0.56, 0.64), (0.48, 0.86), (0.25, 0.98), (0.0, 1.0)
]  # fmt: skip
VASE = [
    (0.0, -1.0),
    (0.5, -1.0),
    (0.9, -0.5),
    (1.0, -0.1),
    (0.8, 0.35),
    (0.42, 0.65),
    (0.4, 0.8),
    (0.6, 1.0),
    (0.42, 0.95),
    (0.0, 0.7),
]
POT = [(0.0, -1.0), (0.66, -1.0), (0.92, 0.75), (1.0, 0.75), (1.0, 1.0), (0.84, 1.0), (0.8, 0.7), (0.0, 0.7)]
TEAPOT = [
    (0.0, -1.0),
    (0.6, -1.0),
    (0.92, -0.55),
    (1.0, -0.1),
    (0.85, 0.35),
    (0.5, 0.62),
    (0.45, 0.7),
    (0.15, 0.8),
    (0.14, 1.0),
    (0.0, 1.0),
]
BOTTLE = [(0.0, -1.0), (1.0, -1.0), (1.0, 0.1), (0.4, 0.45), (0.34, 1.0), (0.0, 1.0)]
SHADE = [(0.0, -0.96), (0.96, -0.98), (1.0, -1.0), (0.62, 1.0), (0.0, 1.0)]
BUCKET = [(0.0, -1.0), (0.78, -1.0), (1.0, 1.0), (0.9, 1.0), (0.72, -0.7), (0.0, -0.7)]
BOWL = [(0.0, -1.0), (0.4, -1.0), (0.8, -0.3), (1.0, 1.0), (0.92, 1.0), (0.7, -0.1), (0.0, -0.6)]
TURNED = [(0.0, -1.0), (0.9, -1.0), (0.6, -0.7), (1.0, -0.3), (0.55, 0.1), (0.9, 0.5), (0.6, 0.8), (1.0, 1.0), (0.0, 1.0)]
COLUMN = [(0.0, -1.0), (1.0, -1.0), (1.0, -0.9), (0.78, -0.84), (0.7, 0.84), (0.95, 0.9), (0.95, 1.0), (0.0, 1.0)]

CUSTOM.update(
    {
        "cushion": lambda: superellipsoid(0.35, 14, 7),
        "small cushion": lambda: superellipsoid(0.45, 8, 4),
        "blossom": lambda: superellipsoid(1.0, 7, 4),
        "pillow": lambda: superellipsoid(0.7, 12, 6),
        "disc": lambda: lathe([(0, -1), (1, -1), (1, 1), (0, 1)], 28),
        "face": lambda: extrude(_CIRCLE),
        "garment": lambda: extrude(GARMENT, axis=0),
        "cone": lambda: lathe([(0, -1), (1, -1), (0, 1)], 12, smooth=False),
        "ring": lambda: torus(0.2, 16, 6),
        "thinring": lambda: torus(0.07, 18, 5),
        "plant": lambda: _foliage(16, 0.45, 0.14, 1),
        "palm": lambda: _foliage(14, 0.75, 0.09, 2),
        "snakeplant": lambda: _foliage(11, 0.05, 0.1, 3),
        "flowers": lambda: _foliage(14, 0.1, 0.03, 4),
        "bush": _bush,
        "curtain": _curtain,
        "tub": lambda: _basin(0.45),
        "basin": lambda: _basin(0.8),
        "bowlseat": lambda: _basin(1.0, 0.28),
        "car": lambda: extrude(CAR, axis=0),
        "cabin": lambda: extrude(CABIN),
        "grand": lambda: extrude(GRAND, axis=2),
        "guitar": lambda: extrude(GUITAR),
        "rocker": lambda: extrude(ROCKER, axis=0),
        "wedge": lambda: extrude([(-1, -1), (1, -1), (1, 1)], axis=0),
        "spandrel": lambda: extrude(SPANDREL),
        "prism": lambda: extrude([(-1, -1), (1, -1), (0, 1)], axis=0),
    }
)
_TURNED: dict[str, list[tuple[float, float]]] = {
    "bust": BUST, "vase": VASE, "pot": POT, "teapot": TEAPOT, "bottle": BOTTLE, "shade": SHADE, "bucket": BUCKET,
    "bowl": BOWL, "turned": TURNED, "column": COLUMN,
}  # fmt: skip


def _turner(profile: list[tuple[float, float]]) -> Callable[[], UnitMesh]:
    return lambda: lathe(profile, 14)


CUSTOM.update({name: _turner(profile) for name, profile in _TURNED.items()})
