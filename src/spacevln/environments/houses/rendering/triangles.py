"""All triangles of a compiled house in one set of arrays, scene frame, with what it takes to shade them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import ContractError
from spacevln.core.geometry import Float

LAYER_PX = 256
_DEFAULT_RGBA = np.array((0.5, 0.5, 0.5, 1.0), np.float32)
_SEGMENTS, _RINGS = 20, 10

VERTEX = np.dtype(
    [
        ("position", np.float32, 3),
        ("normal", np.float32, 3),
        ("uv", np.float32, 2),
        ("rgba", np.uint8, 4),
        ("layer", np.uint8),  # texture layer, 255 = none
        ("emission", np.uint8),
        ("shine", np.uint8),
        ("pad", np.uint8),
        ("instance", np.int32),
    ]
)
NO_LAYER = 255


@dataclass(frozen=True, slots=True, eq=False)
class Soup:
    """Triangles of every geom.

    Args:
        vertices: (V,) of ``VERTEX``.
        indices: (3 * F,) uint32.
        first, count: (ngeom,) int32, each geom's part of ``indices``.
        layers: (L, LAYER_PX, LAYER_PX, 3) uint8, textures; row 0 is at v = 0.
        transparent: (ngeom,) bool.
    """

    vertices: NDArray[np.void]
    indices: NDArray[np.uint32]
    first: NDArray[np.int32]
    count: NDArray[np.int32]
    layers: NDArray[np.uint8]
    transparent: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    points: Float
    normals: Float
    uv: Float
    faces: NDArray[np.int64]


def triangles_of(model: mujoco.MjModel, geom_instance: NDArray[np.int32]) -> Soup:
    """The triangles of a model that does not move.

    Raises:
        ContractError: a geom is of a kind that houses do not have (a plane, a height field).
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rotation = data.geom_xmat.reshape(-1, 3, 3)
    rgba, textures = _looks(model)
    used = sorted({int(t) for t in textures if t >= 0})
    layer_of = {texture: layer for layer, texture in enumerate(used)}
    vertices, indices = [], []
    first, count = np.zeros(model.ngeom, np.int32), np.zeros(model.ngeom, np.int32)
    vertex_total = index_total = 0
    for g in range(model.ngeom):
        shape = _shape(model, g)
        material = int(model.geom_matid[g])
        block = np.zeros(len(shape.points), VERTEX)
        block["position"] = shape.points @ rotation[g].T + data.geom_xpos[g]
        block["normal"] = shape.normals @ rotation[g].T
        block["uv"] = shape.uv
        block["rgba"] = np.clip(255 * rgba[g], 0, 255)
        block["layer"] = layer_of.get(int(textures[g]), NO_LAYER)
        if material >= 0:
            block["emission"] = np.clip(255 * model.mat_emission[material], 0, 255)
            block["shine"] = np.clip(255 * model.mat_specular[material], 0, 255)
        block["instance"] = geom_instance[g]
        vertices.append(block)
        indices.append((shape.faces.ravel() + vertex_total).astype(np.uint32))
        first[g], count[g] = index_total, shape.faces.size
        vertex_total += len(block)
        index_total += shape.faces.size
    layers = np.stack([_layer(model, t) for t in used]) if used else np.full((1, LAYER_PX, LAYER_PX, 3), 255, np.uint8)
    return Soup(np.concatenate(vertices), np.concatenate(indices), first, count, layers, rgba[:, 3] < 0.999)


def _looks(model: mujoco.MjModel) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Colour (ngeom, 4) and texture (ngeom,), -1 for none: a geom's own colour goes before its material's."""
    material = model.geom_matid
    rgba = np.array(model.geom_rgba)
    plain = (rgba == _DEFAULT_RGBA).all(axis=1) & (material >= 0)
    rgba[plain] = model.mat_rgba[material[plain]]
    texture = np.full(model.ngeom, -1, np.int64)
    role = int(mujoco.mjtTextureRole.mjTEXROLE_RGB)
    texture[material >= 0] = model.mat_texid[material[material >= 0], role]
    return rgba, texture


def _layer(model: mujoco.MjModel, texture: int) -> NDArray[np.uint8]:
    height, width = int(model.tex_height[texture]), int(model.tex_width[texture])
    channels, start = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
    pixels = np.asarray(model.tex_data[start : start + height * width * channels]).reshape(height, width, channels)
    if model.tex_type[texture] == mujoco.mjtTexture.mjTEXTURE_CUBE:
        pixels = pixels[: min(height, width)]  # one face stands for all six
    rgb = pixels[..., :3] if channels >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
    if rgb.shape[:2] != (LAYER_PX, LAYER_PX):
        smaller = rgb.shape[0] < LAYER_PX
        rgb = cv2.resize(rgb, (LAYER_PX, LAYER_PX), interpolation=cv2.INTER_LINEAR if smaller else cv2.INTER_AREA)
    return np.ascontiguousarray(rgb, np.uint8)


def _shape(model: mujoco.MjModel, g: int) -> _Shape:
    kind = mujoco.mjtGeom(int(model.geom_type[g]))
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return _mesh(model, int(model.geom_dataid[g]))
    builder = _PRIMITIVES.get(kind)
    if builder is None:
        raise ContractError(
            f"Geom {g} of the house is a {kind.name}: boxes, cylinders, ellipsoids, capsules and meshes can be drawn."
        )
    size = np.array(model.geom_size[g])
    shape = builder(size)
    material = int(model.geom_matid[g])
    if material < 0:
        return shape
    uv = shape.uv * (model.mat_texrepeat[material] if model.mat_texuniform[material] else 1.0)
    return _Shape(shape.points, shape.normals, uv, shape.faces)


def _mesh(model: mujoco.MjModel, m: int) -> _Shape:
    faces = slice(model.mesh_faceadr[m], model.mesh_faceadr[m] + model.mesh_facenum[m])
    corners = [np.asarray(model.mesh_face[faces]), np.asarray(model.mesh_facenormal[faces])]
    points = model.mesh_vert[model.mesh_vertadr[m] : model.mesh_vertadr[m] + model.mesh_vertnum[m]]
    normals = model.mesh_normal[model.mesh_normaladr[m] : model.mesh_normaladr[m] + model.mesh_normalnum[m]]
    uv = np.zeros((1, 2))
    if model.mesh_texcoordadr[m] >= 0:
        uv = model.mesh_texcoord[model.mesh_texcoordadr[m] : model.mesh_texcoordadr[m] + model.mesh_texcoordnum[m]]
        corners.append(np.asarray(model.mesh_facetexcoord[faces]))
    else:
        corners.append(np.zeros_like(corners[0]))
    if all(np.array_equal(corners[0], other) for other in corners[1:]):
        return _Shape(points, normals, uv, corners[0].astype(np.int64))
    triples, index = np.unique(np.stack(corners, axis=-1).reshape(-1, 3), axis=0, return_inverse=True)
    return _Shape(points[triples[:, 0]], normals[triples[:, 1]], uv[triples[:, 2]], index.reshape(-1, 3).astype(np.int64))


def _box(size: Float) -> _Shape:
    points: list[Float] = []
    normals, uv, faces = [], [], []
    for axis in range(3):
        a, b = ((1, 2), (0, 2), (0, 1))[axis]
        for sign in (-1.0, 1.0):
            quad = np.zeros((4, 3))
            quad[:, axis] = sign * size[axis]
            quad[:, a] = np.array((-1, 1, 1, -1)) * size[a]
            quad[:, b] = np.array((-1, -1, 1, 1)) * size[b]
            normal = np.zeros(3)
            normal[axis] = sign
            k = 4 * len(points)
            turned = (sign > 0) != (axis == 1)
            faces += [(k, k + 1, k + 2), (k, k + 2, k + 3)] if turned else [(k, k + 2, k + 1), (k, k + 3, k + 2)]
            points.append(quad)
            normals.append(np.tile(normal, (4, 1)))
            uv.append(quad[:, [a, b]])
    return _Shape(np.concatenate(points), np.concatenate(normals), np.concatenate(uv), np.array(faces))


def _turned(profile: list[tuple[float, float, float, float]]) -> _Shape:
    """A surface of revolution about z from rows (radius, height, normal's radial part, normal's height part), bottom to top."""
    angle = np.linspace(0, math.tau, _SEGMENTS + 1)
    rows = np.array(profile)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([np.column_stack([r * ring, np.full(len(ring), h)]) for r, h, _, _ in rows])
    normals = np.concatenate([np.column_stack([n * ring, np.full(len(ring), m)]) for _, _, n, m in rows])
    uv = np.concatenate([np.column_stack([angle * rows[:, 0].max(), np.full(len(ring), h)]) for _, h, _, _ in rows])
    i, j = (v.ravel() for v in np.meshgrid(np.arange(len(rows) - 1), np.arange(_SEGMENTS), indexing="ij"))
    a, b = i * (_SEGMENTS + 1) + j, (i + 1) * (_SEGMENTS + 1) + j
    faces = np.concatenate([np.column_stack([a, a + 1, b + 1]), np.column_stack([a, b + 1, b])])
    return _Shape(points, normals, uv, faces)


def _cylinder(size: Float) -> _Shape:
    r, h = float(size[0]), float(size[1])
    return _turned([(0, -h, 0, -1), (r, -h, 0, -1), (r, -h, 1, 0), (r, h, 1, 0), (r, h, 0, 1), (0, h, 0, 1)])


def _capsule(size: Float) -> _Shape:
    r, h = float(size[0]), float(size[1])
    arc = np.linspace(-math.pi / 2, math.pi / 2, 2 * (_RINGS // 2) + 1)
    rows = [(r * math.cos(t), r * math.sin(t) + math.copysign(h, t), math.cos(t), math.sin(t)) for t in arc if t < 1e-9]
    rows += [(r * math.cos(t), r * math.sin(t) + h, math.cos(t), math.sin(t)) for t in arc if t > -1e-9]
    return _turned(rows)


def _ellipsoid(size: Float) -> _Shape:
    arc = np.linspace(-math.pi / 2, math.pi / 2, _RINGS + 1)
    ball = _turned([(math.cos(t), math.sin(t), math.cos(t), math.sin(t)) for t in arc])
    normals = ball.normals / size
    return _Shape(ball.points * size, normals / np.linalg.norm(normals, axis=1, keepdims=True), ball.uv, ball.faces)


def _sphere(size: Float) -> _Shape:
    return _ellipsoid(np.repeat(size[:1], 3))


_PRIMITIVES: dict[mujoco.mjtGeom, Callable[[Float], _Shape]] = {
    mujoco.mjtGeom.mjGEOM_BOX: _box,
    mujoco.mjtGeom.mjGEOM_CYLINDER: _cylinder,
    mujoco.mjtGeom.mjGEOM_CAPSULE: _capsule,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: _ellipsoid,
    mujoco.mjtGeom.mjGEOM_SPHERE: _sphere,
}
