"""Stable final arrival: the agent stays at the goal and nobody says so (appendix "Stage and Episode Termination Criteria")."""

from __future__ import annotations

from spacevln.control.anchors import same_anchor, same_space
from spacevln.control.settings import ControlSettings
from spacevln.core import Anchor, LandmarkPool, Pose, Subtask


def inside_final_region(final: Anchor, region: str, pool: LandmarkPool, settings: ControlSettings, *, hsm: bool) -> bool:
    """Whether the agent stands in the final region.

    By the region type of Hierarchical Spatial Memory where the final anchor names a space and that memory is on; else by a
    candidate of the final landmark within ``final_landmark_m``.
    """
    if hsm and final.space:
        return same_space(region, final.space)
    return any(candidate.distance_m <= settings.final_landmark_m for candidate in pool)


class StableFinalArrival:
    """Counts planning boundaries in a row inside the final region with negligible motion."""

    def __init__(self, settings: ControlSettings) -> None:
        self._settings = settings
        self._first: tuple[Pose, Anchor] | None = None
        self._count = 0

    def observe(self, subtask: Subtask, pose: Pose, *, inside: bool) -> bool:
        """Take note of a planning boundary.

        Args:
            subtask: validated sigma_k.
            inside: :func:`inside_final_region`.

        Returns:
            Whether ``stable_boundaries`` in a row headed for the same final anchor, inside its region, within
            ``stable_motion_m`` of the first of them.
        """
        if not (inside and subtask.targets_final_anchor):
            self._first, self._count = None, 0
            return False
        if self._first is None or not self._same(self._first, (pose, subtask.final_anchor)):
            self._first, self._count = (pose, subtask.final_anchor), 0
        self._count += 1
        return self._count >= self._settings.stable_boundaries

    def _same(self, first: tuple[Pose, Anchor], now: tuple[Pose, Anchor]) -> bool:
        drift_m = first[0].distance_m(now[0].x_m, now[0].y_m)
        return same_anchor(first[1], now[1]) and drift_m <= self._settings.stable_motion_m
