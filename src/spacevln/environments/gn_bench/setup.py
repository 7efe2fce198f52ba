"""Everything that decides what an episode of GN-Bench is like."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from spacevln_bridge import messages as say

from spacevln.environments.bridge.setup import BridgeSetup


@dataclass(frozen=True, kw_only=True)
class GNBenchSetup(BridgeSetup):
    """How to run GN-Bench. The body is a point: the simulator keeps it 4 pixels of the occupancy map from obstacles."""

    simulator: ClassVar[str] = "gn-bench"
    title: ClassVar[str] = "GN-Bench's simulator"

    def request(self, scene: Path) -> say.OpenSplats:
        """What asks for a scene."""
        return say.OpenSplats(
            scene=str(scene),
            width_px=self.width_px,
            height_px=self.height_px,
            hfov_deg=self.hfov_deg,
            camera_height_m=self.camera_height_m,
            step_m=self.step_m,
            turn_deg=self.turn_deg,
            gpu_device=self.gpu_device,
            seed=self.seed,
        )
