"""Plays a log as an environment: whatever is asked for, the recorded body does what it did."""

from __future__ import annotations

from dataclasses import replace

from spacevln.core.actions import Action, Motion, Stop
from spacevln.core.errors import ContractError, EnvironmentFailure
from spacevln.core.geometry import Pose, wrap_angle
from spacevln.core.interfaces import EnvironmentSpec
from spacevln.core.sensing import Observation
from spacevln.core.task import EpisodeSpec
from spacevln.environments.playback.log import Log


class PlaybackEnvironment:
    """Implements :class:`~spacevln.core.interfaces.Environment` over a log, for debugging perception and mapping.

    Args:
        log: its first frame is the start of every episode.
        step_m, turn_deg: primitives that are accepted.
    """

    def __init__(self, log: Log, step_m: float = 0.25, turn_deg: float = 30.0) -> None:
        self._log, self._index = log, -1
        self._spec = EnvironmentSpec(log.head.camera, step_m, turn_deg)
        self._origin = Pose(0.0, 0.0)

    @property
    def spec(self) -> EnvironmentSpec:
        """The log's camera."""
        return self._spec

    @property
    def frames_left(self) -> int:
        """How many primitives can still be played."""
        return len(self._log) - 1 - self._index

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Back to the first frame.

        Raises:
            EnvironmentFailure: the log is empty.
        """
        del episode
        if not len(self._log):
            raise EnvironmentFailure("The log has no frame: record it anew.")
        self._index, self._origin = 0, self._log.frames[0].pose
        return self.observe()

    def observe(self) -> Observation:
        """The present frame."""
        if self._index < 0:
            raise ContractError("PlaybackEnvironment.observe() was called before reset(): reset to an episode first.")
        seen = self._log.observation(self._index)
        back = Pose(0.0, 0.0).relative_to(self._origin).T_world_body
        return replace(seen, pose=seen.pose.relative_to(self._origin), T_world_camera=back @ seen.T_world_camera)

    def execute(self, action: Action) -> Motion:
        """The next frame, and how the body came there.

        Raises:
            EnvironmentFailure: the log has ended.
        """
        if isinstance(action, Stop):
            return Motion(0.0, 0.0, False)
        if not self.frames_left:
            raise EnvironmentFailure(f"The log has ended after {len(self._log)} frames: there is nothing more to play.")
        before = self._log.frames[self._index].pose
        self._index += 1
        after = self._log.frames[self._index].pose
        return Motion(before.distance_m(after.x_m, after.y_m), wrap_angle(after.yaw_rad - before.yaw_rad), False)

    def close(self) -> None:
        """Nothing to free."""
        self._index = -1
