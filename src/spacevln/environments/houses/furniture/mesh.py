"""Triangles of primitives and of the self-made unit meshes, with normals and texture coordinates in metres."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.materials import Material, material
from spacevln.environments.houses.plan import Part, PartShape

_THIN_M = 0.035
"""Rods thinner than this, and balls smaller than twice this, get fewer faces."""
Array = NDArray[np.float64]
Faces = NDArray[np.int32]
Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """Triangles.

    Args:
        points: (N, 3) m.
        normals: (N, 3) unit.
        uv: (N, 2) texture coordinates, v upwards.
        faces: (M, 3) indices, counter-clockwise seen from outside.
    """

    points: Array
    normals: Array
    uv: Array
    faces: Faces


@dataclass(frozen=True, slots=True, eq=False)
class UnitMesh:
    """A mesh within -1..1 on each axis.

    Args:
        points, normals, faces: as in ``Triangles``.
        u_mask, v_mask: (N, 3); texture directions of a vertex by the dominant axis of its normal.
        axis: (N,) that axis.
    """

    points: Array
    normals: Array
    faces: Faces
    u_mask: Array
    v_mask: Array
    axis: NDArray[np.int64]


def unit_mesh(points: Array, faces: Faces, normals: Array | None = None) -> UnitMesh:
    """Complete a mesh: flat normals when none are given, and the directions of its texture."""
    if normals is None:
        corners = points[faces]
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-12)
        points, normals = corners.reshape(-1, 3), flat.repeat(3, axis=0)
        faces = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
    axis = np.abs(normals).argmax(axis=1)
    sign = np.where(np.take_along_axis(normals, axis[:, None], 1)[:, 0] >= 0, 1.0, -1.0)
    u_mask, v_mask = np.zeros_like(points), np.zeros_like(points)
    rows = np.arange(len(points))
    # seen from outside, u runs to the right and v up; on top, v runs to the back
    u_mask[rows, np.choose(axis, [1, 0, 0])] = np.choose(axis, [sign, -sign, np.ones_like(sign)])
    v_mask[rows, np.choose(axis, [2, 2, 1])] = np.choose(axis, [np.ones_like(sign), np.ones_like(sign), sign])
    return UnitMesh(points, normals, faces.astype(np.int32), u_mask, v_mask, axis)


def _box() -> UnitMesh:
    points: list[Array] = []
    normals: list[Array] = []
    faces: list[tuple[int, int, int]] = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            first, second = (axis + 1) % 3, (axis + 2) % 3
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                point = np.zeros(3)
                point[axis], point[first], point[second] = sign, a * sign, b
                points.append(point)
                normals.append(np.eye(3)[axis] * sign)
            k = len(points) - 4
            faces += [(k, k + 1, k + 2), (k, k + 2, k + 3)]
    return unit_mesh(np.array(points), np.array(faces, np.int32), np.array(normals))


def lathe(profile: Sequence[tuple[float, float]], segments: int = 16, smooth: bool = True) -> UnitMesh:
    """Turn a profile of (radius, height) from bottom to top around the z axis."""
    radii, heights = np.array(profile, float).T
    angles = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    points: list[Array] = []
    normals: list[Array] = []
    faces: list[NDArray[np.int64]] = []
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    slopes = np.stack([np.diff(heights), -np.diff(radii)], axis=1)
    lengths = np.linalg.norm(slopes, axis=1, keepdims=True)
    slopes = slopes / np.maximum(lengths, 1e-12)
    for i in range(len(radii) - 1):
        lower = upper = slopes[i]
        if smooth:
            # neighbouring bands share a normal unless they meet in a sharp edge
            if i > 0 and slopes[i] @ slopes[i - 1] > 0.6:
                lower = slopes[i] + slopes[i - 1]
            if i + 2 < len(radii) and slopes[i] @ slopes[i + 1] > 0.6:
                upper = slopes[i] + slopes[i + 1]
        base = len(points) * segments
        for index, slope in ((i, lower), (i + 1, upper)):
            points.append(np.column_stack([ring * radii[index], np.full(segments, heights[index])]))
            slope = slope / max(float(np.linalg.norm(slope)), 1e-12)
            normals.append(np.column_stack([ring * slope[0], np.full(segments, slope[1])]))
        k = np.arange(segments)
        n = (k + 1) % segments
        if radii[i] > 0:
            faces.append(np.column_stack([base + k, base + n, base + segments + n]))
        if radii[i + 1] > 0:
            faces.append(np.column_stack([base + k, base + segments + n, base + segments + k]))
    return unit_mesh(np.vstack(points), np.vstack(faces).astype(np.int32), np.vstack(normals))


def extrude(outline: Sequence[tuple[float, float]], axis: int = 1) -> UnitMesh:
    """A prism over a counter-clockwise outline (need not be convex), along ``axis`` from -1 to 1.

    The outline is given in (x, z) for axis 1, (y, z) for axis 0 and (x, y) for axis 2.
    """
    flat = np.array(outline, float)
    n = len(flat)
    cap = _ear_clip(flat)
    order = {0: (1, 2, 0), 1: (0, 2, 1), 2: (0, 1, 2)}[axis]
    # (x, z) with y as the third axis is left-handed
    mirror = axis == 1
    corners = []
    for a, b, c in cap:
        top, bottom = ((a, c, b), (a, b, c)) if mirror else ((a, b, c), (a, c, b))
        corners += [(*flat[i], 1.0) for i in top] + [(*flat[i], -1.0) for i in bottom]
    for i in range(n):
        j = (i + 1) % n
        p, q = flat[i], flat[j]
        quad = [(*p, -1.0), (*q, -1.0), (*q, 1.0), (*p, 1.0)]
        if mirror:
            quad = [quad[1], quad[0], quad[3], quad[2]]
        corners += [quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]]
    raw = np.array(corners)
    points = np.empty_like(raw)
    points[:, order] = raw
    return unit_mesh(points, np.arange(len(points), dtype=np.int32).reshape(-1, 3))


def _ear_clip(outline: Array) -> list[tuple[int, int, int]]:
    remaining, triangles = list(range(len(outline))), []

    def cross(o: int, a: int, b: int) -> float:
        (ox, oy), (ax, ay), (bx, by) = outline[o], outline[a], outline[b]
        return float((ax - ox) * (by - oy) - (ay - oy) * (bx - ox))

    while len(remaining) > 3:
        for k in range(len(remaining)):
            a, b, c = remaining[k - 1], remaining[k], remaining[(k + 1) % len(remaining)]
            others = (p for p in remaining if p not in (a, b, c))
            if cross(a, b, c) > 1e-12 and not any(
                cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0 for p in others
            ):
                break
        triangles.append((remaining[k - 1], remaining[k], remaining[(k + 1) % len(remaining)]))
        remaining.pop(k)
    return [*triangles, (remaining[0], remaining[1], remaining[2])]


def superellipsoid(power: float, segments: int = 16, rings: int = 8) -> UnitMesh:
    """A rounded box; ``power`` 1 is an ellipsoid, smaller is boxier."""
    latitude, longitude = np.linspace(-np.pi / 2, np.pi / 2, rings + 1), np.linspace(-np.pi, np.pi, segments + 1)
    lat, lon = np.meshgrid(latitude, longitude, indexing="ij")

    def curve(value: Array, exponent: float) -> Array:
        return np.asarray(np.sign(value) * np.abs(value) ** exponent)

    def surface(exponent: float) -> Array:
        c = curve(np.cos(lat), exponent)
        grid = [c * curve(np.cos(lon), exponent), c * curve(np.sin(lon), exponent), curve(np.sin(lat), exponent)]
        return np.stack(grid, -1).reshape(-1, 3)

    points, normals = surface(power), surface(2 - power)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    row = segments + 1
    i, j = np.meshgrid(np.arange(rings), np.arange(segments), indexing="ij")
    a = (i * row + j).ravel()
    lower = np.column_stack([a, a + 1, a + row + 1])[(i > 0).ravel()]
    upper = np.column_stack([a, a + row + 1, a + row])[(i < rings - 1).ravel()]
    return unit_mesh(points, np.vstack([lower, upper]).astype(np.int32), normals)


def double_sided(mesh: UnitMesh) -> UnitMesh:
    """The same surface seen from both sides (leaves, curtains)."""
    n = len(mesh.points)
    return unit_mesh(
        np.vstack([mesh.points, mesh.points]),
        np.vstack([mesh.faces, mesh.faces[:, ::-1] + n]),
        np.vstack([mesh.normals, -mesh.normals]),
    )


def torus(tube: float = 0.2, segments: int = 20, sides: int = 8) -> UnitMesh:
    """A ring around the y axis, outer radius 1."""
    a = np.linspace(0, 2 * np.pi, segments, endpoint=False)[:, None]
    b = np.linspace(0, 2 * np.pi, sides, endpoint=False)[None, :]
    radius = 1 - tube + tube * np.cos(b)
    points = np.stack([radius * np.cos(a), np.broadcast_to(np.sin(b), radius.shape) + 0 * a, radius * np.sin(a)], -1)
    normals = np.stack([np.cos(b) * np.cos(a), np.broadcast_to(np.sin(b), radius.shape) + 0 * a, np.cos(b) * np.sin(a)], -1)
    i, j = np.meshgrid(np.arange(segments), np.arange(sides), indexing="ij")
    p = (i * sides + j).ravel()
    q = (i * sides + (j + 1) % sides).ravel()
    r = (((i + 1) % segments) * sides + (j + 1) % sides).ravel()
    s = (((i + 1) % segments) * sides + j).ravel()
    faces = np.vstack([np.column_stack([p, q, r]), np.column_stack([p, r, s])])
    return unit_mesh(points.reshape(-1, 3), faces.astype(np.int32), normals.reshape(-1, 3))


CUSTOM: dict[str, Callable[[], UnitMesh]] = {}
"""Self-made meshes by name; ``furniture.shapes`` fills it."""


@lru_cache(maxsize=256)
def named_mesh(name: str) -> UnitMesh:
    """A unit mesh of the mesh catalogue.

    Raises:
        UnknownNameError: nothing of that name exists.
    """
    if name == "box":
        return _box()
    if name == "cylinder":
        return lathe([(0, -1), (1, -1), (1, 1), (0, 1)], 14)
    if name == "thin cylinder":
        return lathe([(0, -1), (1, -1), (1, 1), (0, 1)], 8)
    if name == "ellipsoid":
        return superellipsoid(1.0, 14, 8)
    if name == "small ellipsoid":
        return superellipsoid(1.0, 9, 6)
    if name not in CUSTOM:
        raise UnknownNameError("mesh", name, CUSTOM)
    return CUSTOM[name]()


def rotation(euler_rad: tuple[float, float, float]) -> Array:
    """Rotation matrix of intrinsic xyz angles."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(euler_rad), np.sin(euler_rad)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return np.asarray(about_x @ about_y @ about_z)


def _texture_coordinates(mesh: UnitMesh, size: Array, stuff: Material) -> Array:
    if stuff.palette_uv is not None:
        return np.tile(np.array(stuff.palette_uv), (len(mesh.points), 1))
    if stuff.scale_m is None:
        u, v = (mesh.points * mesh.u_mask).sum(1), (mesh.points * mesh.v_mask).sum(1)
        return np.column_stack([(u + 1) / 2, (v + 1) / 2])
    scaled = mesh.points * size
    uv = np.column_stack([(scaled * mesh.u_mask).sum(1), (scaled * mesh.v_mask).sum(1)])
    if stuff.grain:
        for axis, (across, up) in enumerate(((1, 2), (0, 2), (0, 1))):
            if size[up] > size[across]:
                rows = mesh.axis == axis
                uv[rows] = uv[rows][:, ::-1]
    return np.asarray(uv / stuff.scale_m)


@lru_cache(maxsize=8192)
def part_triangles(part: Part) -> Triangles:
    """Triangles of one part in the item's frame."""
    made = _turned(part.shape, part.size, part.euler_rad, part.material, part.mesh)
    return Triangles(made.points + np.array(part.position), made.normals, made.uv, made.faces)


@lru_cache(maxsize=8192)  # a design is first built, then moved over its footprint: the same part in two positions
def _turned(shape: PartShape, extent: Triple, euler_rad: Triple, look: str, name: str) -> Triangles:
    """Triangles of a part that lies at the origin."""
    if shape == "capsule":
        mesh, size = named_mesh("ellipsoid"), np.array([extent[0], extent[0], extent[1] + extent[0]])
    elif shape == "cylinder":
        mesh, size = named_mesh("thin cylinder" if extent[0] < _THIN_M else "cylinder"), np.array([extent[0], *extent[:2]])
    elif shape == "ellipsoid":
        mesh, size = named_mesh("small ellipsoid" if max(extent) < 2 * _THIN_M else "ellipsoid"), np.array(extent)
    else:
        mesh, size = named_mesh(name if shape == "mesh" else shape), np.array(extent)
    uv = _texture_coordinates(mesh, size, material(look))
    points, normals = mesh.points * size, mesh.normals
    if not size[0] == size[1] == size[2] and mesh is not named_mesh("box"):
        normals = normals / np.maximum(size, 1e-9)
        normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    if any(euler_rad):
        turn = rotation(euler_rad).T
        points, normals = points @ turn, normals @ turn
    return Triangles(points, normals, uv, mesh.faces)


def join(pieces: Sequence[Triangles]) -> Triangles:
    """Several pieces as one."""
    if len(pieces) == 1:
        return pieces[0]
    offsets = np.cumsum([0, *(len(piece.points) for piece in pieces[:-1])])
    return Triangles(
        np.concatenate([piece.points for piece in pieces]),
        np.concatenate([piece.normals for piece in pieces]),
        np.concatenate([piece.uv for piece in pieces]),
        np.concatenate([piece.faces + offset for piece, offset in zip(pieces, offsets, strict=True)]).astype(np.int32),
    )
