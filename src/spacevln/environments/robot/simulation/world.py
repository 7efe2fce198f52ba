"""What a simulated robot needs of the world around it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float, Pose
from spacevln.core.sensing import Camera


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What a perfect camera sees: (H, W, 3) uint8, (H, W) float32 metres, (H, W) int32 instance ids."""

    rgb: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    ids: NDArray[np.int32]


class World(Protocol):
    """Scene frame."""

    def render(self, T_scene_camera: Float, camera: Camera) -> Sight:
        """The picture from a camera pose; always called on the same thread."""

    def sweep(self, pose: Pose, dx_m: float, dy_m: float, radius_m: float) -> tuple[Pose, bool]:
        """Move a disc until something stops it: where it then is, and whether something did."""

    def close(self) -> None:
        """Free everything; called on the thread that renders."""
