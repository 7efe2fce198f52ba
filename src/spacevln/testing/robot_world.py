"""Flatland as the world of a simulated robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spacevln.core import Camera, EpisodeSpec, InstructionTask, Pose
from spacevln.core.geometry import Float
from spacevln.environments.houses.walking.motion import sweep_disc
from spacevln.environments.robot.simulation.world import Sight
from spacevln.environments.robot.transforms import pose_of_matrix
from spacevln.testing.flatland import Box, Flatland

_TALLEST_FREE_M = 1.3


class FlatlandWorld:
    """Boxes on a floor that stop the body's disc; implements the simulated robot's ``World``."""

    def __init__(self, boxes: Sequence[Box] | None = None) -> None:
        self._boxes = Flatland(boxes).boxes
        solid = [box for box in self._boxes if not box.passable and box.z0_m < _TALLEST_FREE_M]
        rows = [
            ((b.x0_m + b.x1_m) / 2, (b.y0_m + b.y1_m) / 2, 1.0, 0.0, (b.x1_m - b.x0_m) / 2, (b.y1_m - b.y0_m) / 2) for b in solid
        ]
        self._solid: Float = np.array(rows, np.float64).reshape(-1, 6)

    def render(self, T_scene_camera: Float, camera: Camera) -> Sight:
        """The picture from a level camera."""
        pose = replace(pose_of_matrix(T_scene_camera), z_m=0.0)
        seen = Flatland(self._boxes, camera).reset(EpisodeSpec("flatland", "flatland", pose, InstructionTask("go")))
        ids = np.zeros(seen.depth_m.shape, np.int32) if seen.labels is None else seen.labels.instance_ids
        return Sight(seen.rgb, seen.depth_m, ids)

    def sweep(self, pose: Pose, dx_m: float, dy_m: float, radius_m: float) -> tuple[Pose, bool]:
        """Move a disc until it touches a box."""
        x, y, hit = sweep_disc(
            (pose.x_m, pose.y_m), (dx_m, dy_m), self._solid, np.zeros((0, 3)), radius_m=radius_m, sliding=False
        )
        return Pose(x, y, 0.0, pose.yaw_rad), hit

    def close(self) -> None:
        """Nothing to free."""
