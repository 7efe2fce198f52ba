"""Habitat-Sim as an environment; its own navigation mesh measures ways."""

from __future__ import annotations

from spacevln_bridge import messages as say

from spacevln.environments.bridge.conversation import ANSWER_S, OPEN_S
from spacevln.environments.bridge.environment import BridgedEnvironment
from spacevln.environments.bridge.labels import SceneLabels
from spacevln.environments.bridge.simulator import Opened
from spacevln.environments.habitat.geodesics import SceneGeodesics
from spacevln.environments.habitat.setup import HabitatSetup


class HabitatEnvironment(BridgedEnvironment):
    """Implements :class:`spacevln.core.Environment` in Habitat-Sim.

    Args:
        setup: how.
        answer_s, open_s: how long the simulator may take for a step, and for opening a scene.
    """

    def __init__(self, setup: HabitatSetup, *, answer_s: float = ANSWER_S, open_s: float = OPEN_S) -> None:
        super().__init__(setup, answer_s=answer_s, open_s=open_s)
        self._wants_labels = setup.labels
        self._geodesics: dict[str, SceneGeodesics] = {}

    def geodesics(self, scene: str) -> SceneGeodesics:
        """Ground truth in a scene, for evaluation only; kept for the last scene."""
        if scene not in self._geodesics:
            self._geodesics = {scene: SceneGeodesics(self.simulator, scene)}
        return self._geodesics[scene]

    def _labels_of(self, opened: Opened) -> SceneLabels | None:
        return SceneLabels(opened.categories) if self._wants_labels and isinstance(opened, say.Opened) else None
