"""Everything that decides what an episode in Habitat-Sim is like, as explicit values."""

from __future__ import annotations

from dataclasses import dataclass

from spacevln.core.interfaces import EnvironmentSpec
from spacevln.core.sensing import Camera


@dataclass(frozen=True, slots=True)
class HabitatSetup:
    """How to run Habitat-Sim (docs/habitat.md explains each choice).

    Args:
        python: interpreter that has habitat_sim, or ``tcp://HOST:PORT`` of a worker that listens.
        scenes: folder that the datasets' scene names are relative to.
        scene_dataset: a scene dataset configuration; empty for none.
        cache: folder for navigation meshes; empty to compute them anew each time.
        width_px, height_px, hfov_deg, camera_height_m: the camera, over the agent's feet.
        agent_height_m, agent_radius_m, cell_size_m, cell_height_m, max_climb_m, max_slope_deg: the navigation mesh, which is
            always computed with these values, whatever lies beside the scene.
        step_m, turn_deg: primitives.
        sliding: slide along obstacles, or stop at contact.
        depth_min_m, depth_max_m: measurements outside are none.
        gpu_device: number of the graphics card; -1 for software rendering.
        seed: of the simulator.
        labels: ask for the scene's semantic annotations, which the label detector reads.
    """

    python: str
    scenes: str
    scene_dataset: str = ""
    cache: str = ""
    width_px: int = 640
    height_px: int = 480
    hfov_deg: float = 79.0
    camera_height_m: float = 0.88
    agent_height_m: float = 0.88
    agent_radius_m: float = 0.1
    cell_size_m: float = 0.05
    cell_height_m: float = 0.2
    max_climb_m: float = 0.2
    max_slope_deg: float = 45.0
    step_m: float = 0.25
    turn_deg: float = 30.0
    sliding: bool = True
    depth_min_m: float = 0.5
    depth_max_m: float = 5.0
    gpu_device: int = 0
    seed: int = 0
    labels: bool = True

    @property
    def spec(self) -> EnvironmentSpec:
        """What the body can do and see."""
        camera = Camera(self.width_px, self.height_px, self.hfov_deg, self.camera_height_m)
        return EnvironmentSpec(camera, step_m=self.step_m, turn_deg=self.turn_deg)
