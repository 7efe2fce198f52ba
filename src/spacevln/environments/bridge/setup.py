"""What every simulator behind the bridge is told."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from spacevln_bridge import messages as say

from spacevln.core.interfaces import EnvironmentSpec
from spacevln.core.sensing import Camera


@dataclass(frozen=True, kw_only=True)
class BridgeSetup:
    """How to run a simulator in a Python of its own.

    Args:
        python: interpreter that has the simulator, or ``tcp://HOST:PORT`` of a worker that listens.
        scenes: folder that the datasets' scene names are relative to.
        width_px, height_px, hfov_deg, camera_height_m: the camera, over the agent's feet.
        step_m, turn_deg: primitives.
        depth_min_m, depth_max_m: measurements outside are none.
        gpu_device: number of the graphics card; -1 for software rendering.
        seed: of the simulator.
    """

    simulator: ClassVar[str]
    """Its name in :class:`spacevln_bridge.messages.Hello`."""
    title: ClassVar[str]
    """Its name for people."""

    python: str
    scenes: str
    width_px: int = 640
    height_px: int = 480
    hfov_deg: float = 79.0
    camera_height_m: float = 0.88
    step_m: float = 0.25
    turn_deg: float = 30.0
    depth_min_m: float = 0.5
    depth_max_m: float = 5.0
    gpu_device: int = 0
    seed: int = 0

    @property
    def spec(self) -> EnvironmentSpec:
        """What the body can do and see."""
        camera = Camera(self.width_px, self.height_px, self.hfov_deg, self.camera_height_m)
        return EnvironmentSpec(camera, step_m=self.step_m, turn_deg=self.turn_deg)

    @abstractmethod
    def request(self, scene: Path) -> say.Open | say.OpenSplats:
        """What asks the worker for a scene, at its full path."""
