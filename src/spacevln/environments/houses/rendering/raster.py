"""Finding and shading the nearest triangle on every pixel's ray; compiled with numba, no graphics library.

A ray through a pixel has the direction r = (1, left, up) in the camera frame. It meets the triangle (a, b, c) where the three
volumes r.(b x c), r.(c x a), r.(a x b) have one sign; their sum divides the triangle's own volume a.(b x c) to give the depth.
The volumes are linear in the pixel's coordinates, so each triangle is tested only where it appears, at three sums a pixel, and
nothing has to be clipped.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]


@njit(cache=True)
def _span(
    a: float, b: float, c: float, xa: float, xb: float, xc: float, focal: float, centre: float, size: int
) -> tuple[int, int]:
    """Rows or columns in which a triangle appears, end exclusive; (a, b, c) is its coordinate left or up, x ahead."""
    near = 1e-3
    if xa < near and xb < near and xc < near:
        return 0, 0
    if xa < near or xb < near or xc < near:
        return 0, size
    pa, pb, pc = centre - focal * a / xa, centre - focal * b / xb, centre - focal * c / xc
    low, high = min(pa, min(pb, pc)), max(pa, max(pb, pc))
    if high <= 0.0 or low >= size:
        return 0, 0
    return max(0, math.ceil(low - 0.5)), min(size, math.floor(high - 0.5) + 1)


@njit(cache=True)
def _bring(v: F64, points: F32, corners: NDArray[np.uint32], eye: F64, to_camera: F64) -> None:
    """The three corners of a triangle in the camera frame, as rows of ``v``."""
    for k in range(3):
        p = points[corners[k]]
        x, y, z = p[0] - eye[0], p[1] - eye[1], p[2] - eye[2]
        for r in range(3):
            v[k, r] = to_camera[r, 0] * x + to_camera[r, 1] * y + to_camera[r, 2] * z


@njit(cache=True)
def _cross(a: F64, b: F64) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def _draw(v: F64, t: int, lens: F64, near: float, longest: float, depth: F64, hit: I32, weights: F32) -> None:
    """Enter triangle ``t`` with the corners ``v`` wherever it is the nearest so far."""
    height, width = depth.shape
    fx, fy, cx, cy = lens
    n0 = _cross(v[1], v[2])
    volume = v[0, 0] * n0[0] + v[0, 1] * n0[1] + v[0, 2] * n0[2]
    if volume >= -1e-15:  # seen from behind, or on edge
        return
    column0, column1 = _span(v[0, 1], v[1, 1], v[2, 1], v[0, 0], v[1, 0], v[2, 0], fx, cx, width)
    row0, row1 = _span(v[0, 2], v[1, 2], v[2, 2], v[0, 0], v[1, 0], v[2, 0], fy, cy, height)
    if column0 >= column1 or row0 >= row1:
        return
    n1, n2 = _cross(v[2], v[0]), _cross(v[0], v[1])
    d0, d1, d2 = n0[1] / fx, n1[1] / fx, n2[1] / fx
    left = (cx - column0 - 0.5) / fx
    for row in range(row0, row1):
        up = (cy - row - 0.5) / fy
        e0 = n0[0] + left * n0[1] + up * n0[2]
        e1 = n1[0] + left * n1[1] + up * n1[2]
        e2 = n2[0] + left * n2[1] + up * n2[2]
        for column in range(column0, column1):
            if e0 <= 0.0 and e1 <= 0.0 and e2 <= 0.0:
                total = e0 + e1 + e2
                if total < 0.0:
                    here = volume / total
                    if near <= here < depth[row, column] and here <= longest:
                        depth[row, column] = here
                        hit[row, column] = t
                        weights[row, column, 0] = e1 / total
                        weights[row, column, 1] = e2 / total
            e0 -= d0
            e1 -= d1
            e2 -= d2


@njit(cache=True)
def nearest_triangles(
    points: F32,
    triangles: NDArray[np.uint32],
    first: I32,
    count: I32,
    shown: NDArray[np.int64],
    eye: F64,
    to_camera: F64,
    lens: F64,
    near: float,
    longest: float,
    depth: F64,
    hit: I32,
    weights: F32,
) -> None:
    """Depth, triangle and barycentric weights of every pixel.

    Args:
        points: (V, 3) scene frame.
        triangles: (F, 3) vertices.
        first, count: (ngeom,) rows of ``triangles`` of every geom.
        shown: geoms to look at, near ones first.
        eye: (3,) camera position; ``to_camera`` (3, 3) rotation into its frame.
        lens: fx, fy, cx, cy [px].
        near, longest: depths between which a hit counts [m].
        depth, hit, weights: results (H, W), (H, W), (H, W, 2): filled with ``longest``, -1 and 0 before.
    """
    v = np.empty((3, 3))
    for g in shown:
        for t in range(first[g], first[g] + count[g]):
            _bring(v, points, triangles[t], eye, to_camera)
            _draw(v, t, lens, near, longest, depth, hit, weights)


@njit(cache=True)
def _texel(layers: NDArray[np.uint8], layer: int, u: float, v: float, out: F64) -> None:
    """Bilinear colour, 0 to 255, of a texture that repeats."""
    size = layers.shape[1]
    x, y = u * size - 0.5, v * size - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    fx, fy = x - x0, y - y0
    i0, j0 = int(y0) % size, int(x0) % size
    i1, j1 = (i0 + 1) % size, (j0 + 1) % size
    for c in range(3):
        top = layers[layer, i0, j0, c] * (1 - fx) + layers[layer, i0, j1, c] * fx
        low = layers[layer, i1, j0, c] * (1 - fx) + layers[layer, i1, j1, c] * fx
        out[c] = top * (1 - fy) + low * fy


@njit(cache=True)
def shade(
    hit: I32,
    depth: F64,
    weights: F32,
    triangles: NDArray[np.uint32],
    points: F32,
    normals: F32,
    uv: F32,
    rgba: NDArray[np.uint8],
    marks: NDArray[np.uint8],
    instance: I32,
    fine: NDArray[np.uint8],
    coarse: NDArray[np.uint8],
    coarse_beyond_m: float,
    eye: F64,
    sky: F64,
    rgb: NDArray[np.uint8],
    instance_ids: I32,
) -> None:
    """Colour and instance id of every pixel; the light is that of :mod:`shaders`.

    Args:
        hit, depth, weights: of :func:`nearest_triangles`; the depth of a miss becomes 0.
        triangles, points, normals, uv, rgba, marks, instance: of the soup; ``marks`` are layer, emission, shine.
        fine, coarse: textures (L, n, n, 3) for near and for far pixels.
        coarse_beyond_m: depth from which the coarse one is taken.
        eye, sky: camera position; background colour, 0 to 255.
        rgb, instance_ids: results.
    """
    height, width = hit.shape
    n, at, texel = np.empty(3), np.empty(3), np.empty(3)
    for row in range(height):
        for column in range(width):
            t = hit[row, column]
            if t < 0:
                depth[row, column] = 0.0
                instance_ids[row, column] = 0
                for c in range(3):
                    rgb[row, column, c] = np.uint8(sky[c])
                continue
            a, b, c3 = triangles[t, 0], triangles[t, 1], triangles[t, 2]
            wb, wc = weights[row, column, 0], weights[row, column, 1]
            wa = 1.0 - wb - wc
            for c in range(3):
                n[c] = wa * normals[a, c] + wb * normals[b, c] + wc * normals[c3, c]
                at[c] = eye[c] - (wa * points[a, c] + wb * points[b, c] + wc * points[c3, c])
            length = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) + 1e-12
            distance = math.sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) + 1e-12
            lamp = max((n[0] * at[0] + n[1] * at[1] + n[2] * at[2]) / (length * distance), 0.0)
            light = 0.68 + (0.10 * n[2] + 0.10 * n[0] + 0.06 * n[1]) / length + 0.24 * lamp
            layer, emission, shine = marks[a, 0], marks[a, 1] / 255.0, marks[a, 2] / 255.0
            if layer < 255:
                u = wa * uv[a, 0] + wb * uv[b, 0] + wc * uv[c3, 0]
                v = wa * uv[a, 1] + wb * uv[b, 1] + wc * uv[c3, 1]
                _texel(fine if depth[row, column] < coarse_beyond_m else coarse, layer, u, v, texel)
            else:
                texel[:] = 255.0
            light = light * (1.0 - emission) + 1.15 * emission
            gloss = 0.22 * 255.0 * shine * lamp**8
            for c in range(3):
                rgb[row, column, c] = np.uint8(min(255.0, texel[c] * rgba[a, c] / 255.0 * light + gloss + 0.5))
            instance_ids[row, column] = instance[a]
