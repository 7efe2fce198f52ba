"""An environment whose poses are in the frame of a loaded memory instead of that of its own start."""

from __future__ import annotations

from dataclasses import replace

from spacevln.core import Action, Environment, EnvironmentSpec, EpisodeSpec, Motion, Observation, Pose
from spacevln.memory import SavedMemory


class RegisteredEnvironment:
    """Implements :class:`~spacevln.core.interfaces.Environment` around another one.

    Registration is the one thing that a repeated episode is told: where its start lies in the frame of the memory. In a simulator
    it follows from the two start poses in the scene, which stay here; on a robot from its localisation.

    Args:
        environment: gives poses relative to its start.
        known: the memory in whose frame they are wanted.
    """

    def __init__(self, environment: Environment, known: SavedMemory) -> None:
        self._environment, self._known = environment, known
        self._start = Pose(0.0, 0.0)  # T_memory_start

    @property
    def spec(self) -> EnvironmentSpec:
        """Of the environment."""
        return self._environment.spec

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Reset, and register the start."""
        self._start = self._known.start_of(episode.start)
        return self._registered(self._environment.reset(episode))

    def observe(self) -> Observation:
        """What the camera sees now."""
        return self._registered(self._environment.observe())

    def execute(self, action: Action) -> Motion:
        """Carry out one primitive."""
        return self._environment.execute(action)

    def close(self) -> None:
        """Free everything."""
        self._environment.close()

    def _registered(self, observation: Observation) -> Observation:
        return replace(
            observation,
            pose=self._start.compose(observation.pose),
            T_world_camera=self._start.T_world_body @ observation.T_world_camera,
        )
