"""GN-Bench as an environment: its simulator moves and draws, its occupancy maps are measured here."""

from __future__ import annotations

from pathlib import Path

from spacevln.environments.bridge.conversation import ANSWER_S, OPEN_S
from spacevln.environments.bridge.environment import BridgedEnvironment
from spacevln.environments.gn_bench.geodesics import OccupancyGeodesics
from spacevln.environments.gn_bench.occupancy import load_occupancy
from spacevln.environments.gn_bench.setup import GNBenchSetup


class GNBenchEnvironment(BridgedEnvironment):
    """Implements :class:`spacevln.core.Environment` in GN-Bench's simulator.

    Args:
        setup: how; its scenes must lie on this machine too, as ways are measured on their occupancy maps.
        answer_s, open_s: how long the simulator may take for a step, and for opening a scene.
    """

    def __init__(self, setup: GNBenchSetup, *, answer_s: float = ANSWER_S, open_s: float = OPEN_S) -> None:
        super().__init__(setup, answer_s=answer_s, open_s=open_s)
        self._geodesics: dict[str, OccupancyGeodesics] = {}

    def geodesics(self, scene: str) -> OccupancyGeodesics:
        """Ground truth in a building, for evaluation only; kept for the last building.

        Raises:
            PrerequisiteError: its occupancy map is not there.
        """
        if scene not in self._geodesics:
            setup = self.simulator.setup
            occupancy = load_occupancy(Path(setup.scenes) / scene)
            self._geodesics = {scene: OccupancyGeodesics(occupancy, step_m=setup.step_m, turn_deg=setup.turn_deg)}
        return self._geodesics[scene]
