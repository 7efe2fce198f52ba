"""Rendering without any graphics library: one ray per pixel, flat colours, shaded by a lamp at the camera.

Depth and instance ids are as exact as with OpenGL; only textures are missing (their mean colour is used).
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import EnvironmentFailure
from spacevln.core.geometry import Float
from spacevln.core.sensing import Camera
from spacevln.environments.houses.rendering.culling import Visibility, geom_bounds
from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M, Drawable, Frame

_HIDDEN_GROUP = 5
_AMBIENT = 0.45
_DEFAULT_RGBA = 0.5, 0.5, 0.5, 1.0
_SKY = 200, 215, 230


def geom_colours(model: mujoco.MjModel) -> NDArray[np.float32]:
    """(ngeom, 3) mean colour of every geom, 0 to 255: its own, else its material's times the mean of the texture."""
    material_rgb = np.array(model.mat_rgba[:, :3], dtype=np.float64)
    for k, textures in enumerate(model.mat_texid):
        texture = int(textures[mujoco.mjtTextureRole.mjTEXROLE_RGB])
        if texture >= 0:
            channels, start = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
            size = int(model.tex_height[texture]) * int(model.tex_width[texture]) * channels
            pixels = model.tex_data[start : start + size].reshape(-1, channels)[:, :3]
            material_rgb[k] *= pixels.mean(axis=0) / 255
    rgb = np.array(model.geom_rgba[:, :3], dtype=np.float64)
    plain = (model.geom_rgba == np.array(_DEFAULT_RGBA, np.float32)).all(axis=1) & (model.geom_matid >= 0)
    rgb[plain] = material_rgb[model.geom_matid[plain]]
    return (255 * rgb).astype(np.float32)


class RaycastRenderer:
    """MuJoCo's ray caster: no textures, but no graphics library either.

    Args:
        drawable: what to draw. The geom groups of its model become this renderer's.
    """

    name = "raycast"

    def __init__(self, drawable: Drawable) -> None:
        self._model: mujoco.MjModel | None = drawable.model
        self._data = mujoco.MjData(drawable.model)
        mujoco.mj_forward(drawable.model, self._data)
        self._instance = np.append(drawable.geom_instance, np.int32(0)).astype(np.int32)  # the last: no hit
        self._colour = np.concatenate([geom_colours(drawable.model), np.array([_SKY], np.float32)])
        self._visibility = Visibility(drawable.house, *geom_bounds(drawable.model))
        self._groups = np.ones(6, np.uint8)
        self._groups[_HIDDEN_GROUP] = 0
        self._slopes: tuple[Camera, Float] | None = None

    def render(self, T_world_camera: Float, camera: Camera) -> Frame:
        """See :class:`protocol.Renderer`."""
        if self._model is None:
            raise EnvironmentFailure("The renderer was closed: make a new one.")
        eye, rotation = np.ascontiguousarray(T_world_camera[:3, 3]), T_world_camera[:3, :3]
        forward = rotation[:, 0]
        half_fov = math.atan(max(camera.cx_px, camera.width_px - camera.cx_px) / camera.fx_px)
        if abs(float(forward[2])) > 1e-6:
            half_fov = math.pi
        x, y, z = (float(v) for v in eye)
        shown = self._visibility.visible(x, y, z, math.atan2(forward[1], forward[0]), half_fov)
        self._model.geom_group[:] = np.where(shown & (self._model.geom_rgba[:, 3] > 0), 0, _HIDDEN_GROUP)
        rays_camera, length = self._rays(camera)
        rays = rays_camera @ rotation.T
        count = len(rays)
        geoms, distance, normals = np.empty(count, np.int32), np.empty(count), np.empty(3 * count)
        cutoff = RANGE_M * float(length.max())
        mujoco.mj_multiRay(
            self._model, self._data, eye, rays.ravel(), self._groups, True, -1, geoms, distance, normals, count, cutoff
        )
        depth = distance / length
        geoms[(distance < 0) | (depth < NEAR_M)] = -1
        depth[(geoms < 0) | (depth > RANGE_M)] = 0.0
        facing = np.abs(np.einsum("ij,ij->i", normals.reshape(-1, 3), rays))
        shade = np.where(geoms < 0, 1.0, _AMBIENT + (1 - _AMBIENT) * facing)
        size = (camera.height_px, camera.width_px)
        rgb = np.clip(self._colour[geoms] * shade[:, None], 0, 255).astype(np.uint8).reshape(*size, 3)
        return Frame(rgb, depth.astype(np.float32).reshape(size), self._instance[geoms].reshape(size))

    def _rays(self, camera: Camera) -> tuple[Float, Float]:
        """Unit rays (H * W, 3) through the pixels' centres, camera frame, and the length of each per metre of depth."""
        if self._slopes is None or self._slopes[0] != camera:
            u, v = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
            left, up = -(u.ravel() - camera.cx_px) / camera.fx_px, -(v.ravel() - camera.cy_px) / camera.fy_px
            self._slopes = (camera, np.stack([np.ones_like(left), left, up], axis=1))
        slopes = self._slopes[1]
        length = np.linalg.norm(slopes, axis=1)
        return slopes / length[:, None], length

    def close(self) -> None:
        """Let go of the model."""
        self._model = None
