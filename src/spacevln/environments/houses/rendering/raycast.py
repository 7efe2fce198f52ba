"""Rendering without any graphics library: the nearest triangle on the ray of every pixel, textured and lit as with OpenGL."""

from __future__ import annotations

import cv2
import numpy as np

from spacevln.core.errors import EnvironmentFailure
from spacevln.core.geometry import Float
from spacevln.core.sensing import Camera
from spacevln.environments.houses.rendering.culling import Visibility
from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M, Drawable, Frame
from spacevln.environments.houses.rendering.raster import nearest_triangles, shade
from spacevln.environments.houses.rendering.shaders import SKY
from spacevln.environments.houses.rendering.triangles import LAYER_PX, triangles_of

_COARSE_PX = 64
_COARSE_BEYOND_M = 3.0


class RaycastRenderer:
    """One thread, no graphics library; see-through things are drawn solid.

    Args:
        drawable: what to draw.
    """

    name = "raycast"

    def __init__(self, drawable: Drawable) -> None:
        soup = triangles_of(drawable.model, drawable.geom_instance)
        vertices = soup.vertices
        self._visibility = Visibility.of(drawable)
        self._triangles = soup.indices.reshape(-1, 3)
        self._first, self._count = soup.first // 3, soup.count // 3
        self._points, self._normals = (np.ascontiguousarray(vertices[name]) for name in ("position", "normal"))
        self._uv, self._rgba = (np.ascontiguousarray(vertices[name]) for name in ("uv", "rgba"))
        self._marks = np.stack([vertices[name] for name in ("layer", "emission", "shine")], axis=1)
        self._instance = np.ascontiguousarray(vertices["instance"])
        self._fine = soup.layers
        size = (_COARSE_PX, _COARSE_PX)
        self._coarse = np.stack([cv2.resize(layer, size, interpolation=cv2.INTER_AREA) for layer in soup.layers])
        self._closed = False

    def render(self, T_world_camera: Float, camera: Camera) -> Frame:
        """See :class:`protocol.Renderer`."""
        if self._closed:
            raise EnvironmentFailure("The renderer was closed: make a new one.")
        size = (camera.height_px, camera.width_px)
        depth, hit = np.full(size, RANGE_M + 1e-9), np.full(size, -1, np.int32)
        weights = np.zeros((*size, 2), np.float32)
        eye, rotation = np.ascontiguousarray(T_world_camera[:3, 3]), np.ascontiguousarray(T_world_camera[:3, :3].T)
        lens = np.array([camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px])
        shown = self._visibility.near_first(T_world_camera, camera)
        nearest_triangles(
            self._points,
            self._triangles,
            self._first,
            self._count,
            shown,
            eye,
            rotation,
            lens,
            NEAR_M,
            RANGE_M,
            depth,
            hit,
            weights,
        )
        rgb, instance_ids = np.empty((*size, 3), np.uint8), np.empty(size, np.int32)
        sky = 255.0 * np.array(SKY[:3])
        beyond = _COARSE_BEYOND_M * camera.width_px / LAYER_PX
        shade(
            hit, depth, weights, self._triangles, self._points, self._normals, self._uv, self._rgba, self._marks,
            self._instance, self._fine, self._coarse, beyond, eye, sky, rgb, instance_ids,
        )  # fmt: skip
        return Frame(rgb, depth.astype(np.float32), instance_ids)

    def close(self) -> None:
        """Nothing has to be freed; it only ends the use."""
        self._closed = True
