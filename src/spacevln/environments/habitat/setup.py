"""Everything that decides what an episode in Habitat-Sim is like, as explicit values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from spacevln_bridge import messages as say

from spacevln.environments.bridge.setup import BridgeSetup


@dataclass(frozen=True, kw_only=True)
class HabitatSetup(BridgeSetup):
    """How to run Habitat-Sim (docs/habitat.md explains each choice), beside what every simulator is told.

    Args:
        scene_dataset: a scene dataset configuration; empty for none.
        cache: folder for navigation meshes; empty to compute them anew each time.
        agent_height_m, agent_radius_m, cell_size_m, cell_height_m, max_climb_m, max_slope_deg: the navigation mesh, which is
            always computed with these values, whatever lies beside the scene.
        sliding: slide along obstacles, or stop at contact.
        labels: ask for the scene's semantic annotations, which the label detector reads.
    """

    simulator: ClassVar[str] = "habitat"
    title: ClassVar[str] = "Habitat-Sim"

    scene_dataset: str = ""
    cache: str = ""
    agent_height_m: float = 0.88
    agent_radius_m: float = 0.1
    cell_size_m: float = 0.05
    cell_height_m: float = 0.2
    max_climb_m: float = 0.2
    max_slope_deg: float = 45.0
    sliding: bool = True
    labels: bool = True

    def request(self, scene: Path) -> say.Open:
        """What asks for a scene."""
        return say.Open(
            scene=str(scene),
            scene_dataset=self.scene_dataset,
            cache=self.cache,
            width_px=self.width_px,
            height_px=self.height_px,
            hfov_deg=self.hfov_deg,
            camera_height_m=self.camera_height_m,
            agent_height_m=self.agent_height_m,
            agent_radius_m=self.agent_radius_m,
            cell_size_m=self.cell_size_m,
            cell_height_m=self.cell_height_m,
            max_climb_m=self.max_climb_m,
            max_slope_deg=self.max_slope_deg,
            step_m=self.step_m,
            turn_deg=self.turn_deg,
            sliding=self.sliding,
            gpu_device=self.gpu_device,
            seed=self.seed,
            labels=self.labels,
        )
