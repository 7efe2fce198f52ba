"""A camera that follows the robot from behind and above, for pictures of a run; no agent sees through it."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float, Pose
from spacevln.core.sensing import Camera
from spacevln.environments.houses.rendering import Drawable, DrawnBody, Renderer

HFOV_DEG = 75.0
BOOM_M = 1.9
"""From the point above the robot to the camera, where nothing is in between."""
ENOUGH_M = 1.3
"""With this much of it the camera stays straight behind; else it looks for a longer way to the sides."""
RISE_RAD = math.radians(12.0)
PIVOT_M = 1.45
HEADROOM_M = 0.2
GAP_M = 0.2
"""Kept from what the boom meets."""
SWINGS_RAD = tuple(math.radians(angle) for angle in (0, 25, -25, 50, -50, 75, -75))
LOOK_AHEAD_M, LOOK_HEIGHT_M = 0.6, 0.55
UP = np.array([0.0, 0.0, 1.0])


class ChaseCamera:
    """Follows the robot through one house.

    Args:
        drawable: the house.
        renderer: of it.
        body: the robot as it is drawn.
        size_px: (width, height) of the renderer's pictures.
    """

    def __init__(self, drawable: Drawable, renderer: Renderer, body: DrawnBody, size_px: tuple[int, int]) -> None:
        self._model = drawable.model
        self._data = mujoco.MjData(drawable.model)
        mujoco.mj_kinematics(self._model, self._data)
        self._renderer, self._body = renderer, body
        self._camera = Camera(*size_px, hfov_deg=HFOV_DEG, height_m=PIVOT_M)

    def view(self, at: Pose) -> NDArray[np.uint8]:
        """The robot at a pose, scene frame, seen from outside: (H, W, 3).

        Raises:
            EnvironmentFailure: the graphics library failed.
        """
        T_world_camera = self.stand(at)
        frame = self._renderer.render(T_world_camera, self._camera)
        self._body.draw(frame, T_world_camera, self._camera, at)
        return frame.rgb

    def stand(self, at: Pose) -> Float:
        """Where the camera is (4, 4): behind and above; nearer or to the side where a wall or a thing is in the way."""
        feet = np.array(at.position_m)
        above = self._free_m(feet + 0.5 * UP, UP)
        pivot = feet + min(PIVOT_M, 0.5 + above - HEADROOM_M) * UP
        longest, chosen = -1.0, np.zeros(3)
        for swing in SWINGS_RAD:
            back = at.yaw_rad + math.pi + swing
            along = np.array([math.cos(back) * math.cos(RISE_RAD), math.sin(back) * math.cos(RISE_RAD), math.sin(RISE_RAD)])
            length = min(BOOM_M, max(0.0, self._free_m(pivot, along) - GAP_M))
            if length > longest + 1e-6:
                longest, chosen = length, along
            if length >= ENOUGH_M:
                break
        eye = pivot + longest * chosen
        ahead = np.array([math.cos(at.yaw_rad), math.sin(at.yaw_rad), 0.0])
        return _looking(eye, feet + LOOK_AHEAD_M * ahead + LOOK_HEIGHT_M * UP)

    def _free_m(self, start: Float, along: Float) -> float:
        """How far a ray goes before it meets something."""
        met = np.full(1, -1, np.int32)
        distance = mujoco.mj_ray(self._model, self._data, start, along, None, 1, -1, met)
        return math.inf if distance < 0 else float(distance)


def _looking(eye: Float, target: Float) -> Float:
    """A level camera frame (4, 4) at a point that looks at another: x along the optical axis, y left, z up."""
    ahead = (target - eye) / np.linalg.norm(target - eye)
    left = np.cross(UP, ahead)
    left /= np.linalg.norm(left)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = ahead, left, np.cross(ahead, left), eye
    return T
