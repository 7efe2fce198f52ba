"""What a renderer is, and what it draws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float
from spacevln.core.sensing import Camera
from spacevln.environments.houses.plan import House

# Nothing nearer or farther than this is measured [m].
NEAR_M = 0.03
RANGE_M = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class Drawable:
    """A house as a renderer needs it.

    Args:
        house: rooms and openings, for culling.
        model: MuJoCo model whose geoms do not move.
        geom_instance: (ngeom,) int32, instance id of every geom, 0 = none.
    """

    house: House
    model: mujoco.MjModel
    geom_instance: NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One image.

    Args:
        rgb: (H, W, 3) uint8.
        depth_m: (H, W) float32 along the optical axis; 0 = nothing within ``RANGE_M``.
        instance_ids: (H, W) int32; 0 = nothing that has a label.
    """

    rgb: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    instance_ids: NDArray[np.int32]


class Renderer(Protocol):
    """Draws one house."""

    name: str

    def render(self, T_world_camera: Float, camera: Camera) -> Frame:
        """The image of a camera.

        Args:
            T_world_camera: (4, 4), camera frame (x along the optical axis, y left, z up) to the scene.
            camera: intrinsics.

        Raises:
            EnvironmentFailure: the graphics library failed.
        """

    def close(self) -> None:
        """Free everything. May be called twice."""
