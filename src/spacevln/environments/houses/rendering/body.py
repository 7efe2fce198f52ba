"""Draws the robot into a finished picture of a house; houses do not move, the robot does."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from spacevln.core.geometry import Float, Pose
from spacevln.core.sensing import Camera
from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M, Frame
from spacevln.environments.houses.rendering.raster import nearest_triangles, shade
from spacevln.environments.houses.rendering.triangles import LAYER_PX, triangles_of

_SHELL, _DARK, _BAND = (0.93, 0.93, 0.95, 1.0), (0.13, 0.14, 0.17, 1.0), (0.36, 0.13, 0.71, 1.0)


class DrawnBody:
    """A slim robot: two wheels, a mast, and a camera head that looks ahead.

    Args:
        radius_m: of the disc that collides.
        camera_height_m: where its camera is, above the feet.
    """

    def __init__(self, radius_m: float, camera_height_m: float) -> None:
        model = _model(radius_m, camera_height_m)
        soup = triangles_of(model, np.zeros(model.ngeom, np.int32))
        vertices = soup.vertices
        self._geoms = np.arange(model.ngeom)
        self._first, self._count = soup.first // 3, soup.count // 3
        self._triangles = soup.indices.reshape(-1, 3)
        self._points, self._normals = (np.ascontiguousarray(vertices[name]) for name in ("position", "normal"))
        self._uv, self._rgba = (np.ascontiguousarray(vertices[name]) for name in ("uv", "rgba"))
        self._marks = np.stack([vertices[name] for name in ("layer", "emission", "shine")], axis=1)
        self._instance = np.ascontiguousarray(vertices["instance"])
        self._layers = soup.layers

    def draw(self, frame: Frame, T_world_camera: Float, camera: Camera, at: Pose) -> None:
        """Draw the robot at a pose into ``frame.rgb``, wherever the house does not hide it.

        Args:
            frame: of the house; changed.
            T_world_camera: (4, 4), of that picture.
            camera: of that picture.
            at: where the robot stands, scene frame.
        """
        c, s = math.cos(at.yaw_rad), math.sin(at.yaw_rad)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        points = (self._points @ turn.T + at.position_m).astype(np.float32)
        normals = (self._normals @ turn.T).astype(np.float32)
        size = frame.depth_m.shape
        depth = np.where(frame.depth_m > 0, frame.depth_m, RANGE_M).astype(np.float64)
        hit, weights = np.full(size, -1, np.int32), np.zeros((*size, 2), np.float32)
        eye, rotation = np.ascontiguousarray(T_world_camera[:3, 3]), np.ascontiguousarray(T_world_camera[:3, :3].T)
        lens = np.array([camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px])
        nearest_triangles(
            points, self._triangles, self._first, self._count, self._geoms, eye, rotation, lens, NEAR_M, RANGE_M,
            depth, hit, weights,
        )  # fmt: skip
        rgb, instance_ids = np.empty((*size, 3), np.uint8), np.empty(size, np.int32)
        drawn = hit >= 0
        shade(
            hit, depth, weights, self._triangles, points, normals, self._uv, self._rgba, self._marks, self._instance,
            self._layers, self._layers, LAYER_PX, eye, np.zeros(3), rgb, instance_ids,
        )  # fmt: skip
        frame.rgb[drawn] = rgb[drawn]


def _model(radius_m: float, camera_height_m: float) -> mujoco.MjModel:
    """Geoms in the body's frame: x ahead, y left, z up from the feet."""
    spec = mujoco.MjSpec()
    cylinder, box, capsule = (mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CAPSULE)
    side = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    ahead = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)
    upright = (1.0, 0.0, 0.0, 0.0)
    wheel_m, deck_m, head_m = 0.06, 0.16, camera_height_m
    add = spec.worldbody.add_geom
    for sign in (-1, 1):
        add(type=cylinder, size=(wheel_m, 0.012, 0), pos=(0, sign * 0.85 * radius_m, wheel_m), quat=side, rgba=_DARK)
    add(type=cylinder, size=(0.95 * radius_m, 0.045, 0), pos=(0, 0, 0.1), quat=upright, rgba=_SHELL)
    add(type=cylinder, size=(0.96 * radius_m, 0.008, 0), pos=(0, 0, 0.12), quat=upright, rgba=_BAND)
    add(type=capsule, size=(0.017, (head_m - deck_m) / 2, 0), pos=(-0.2 * radius_m, 0, (head_m + deck_m) / 2), rgba=_DARK)
    add(type=cylinder, size=(0.6 * radius_m, 0.02, 0), pos=(-0.2 * radius_m, 0, 0.42), quat=upright, rgba=_SHELL)
    add(type=box, size=(0.03, 0.075, 0.03), pos=(0, 0, head_m), rgba=_SHELL)
    for sign in (-1, 1):
        add(type=cylinder, size=(0.017, 0.004, 0), pos=(0.032, sign * 0.045, head_m), quat=ahead, rgba=_DARK)
    add(type=box, size=(0.031, 0.076, 0.006), pos=(0, 0, head_m + 0.032), rgba=_BAND)
    return spec.compile()
