"""Has the stage's destination been reached? (appendix "Stage and Episode Termination Criteria"; DESIGN 5.3, 5.6)."""

from __future__ import annotations

import math
from enum import StrEnum

from spacevln.control.anchors import same_space
from spacevln.control.settings import ControlSettings
from spacevln.core import LandmarkPool, Pose, SpaceKind, Subtask


class ArrivalKind(StrEnum):
    """Which evidence showed an arrival."""

    LANDMARK = "landmark"
    FLOOR = "floor"
    SPACE = "space"
    TARGET = "target"


class StageArrival:
    """Watches one stage for the arrival at its next anchor.

    The kind of the anchor decides which evidence counts:

    - a floor transition: the floor has changed since the stage began;
    - a tracked landmark: its arrival flag in the landmark pool, which holds nothing but the landmark of this stage; with a
      metric target also within ``meant_landmark_m`` of that, since another door is not the door that was meant; without one,
      not by a thing in reach from the start that does not lie ahead (:meth:`depart`);
    - a space without a landmark: entered during the stage, and at least ``past_opening_m`` inside;
    - a metric target without a landmark: within ``target_radius_m``.

    Args:
        subtask: sigma_k.
        floor, region: where the stage begins; ``""`` for an unknown region.
    """

    def __init__(self, subtask: Subtask, floor: int, region: str, settings: ControlSettings) -> None:
        self._subtask = subtask
        self._start_floor = floor
        self._start_region = region
        self._settings = settings
        self._entered_at: Pose | None = None
        self._left_behind: frozenset[int] = frozenset()

    def depart(self, pool: LandmarkPool) -> None:
        """The body faces the chosen direction and sets off.

        What is in reach already and lies more than ``ahead_deg`` off that direction is another door, or another chair, than the
        one that the stage heads for; while it stays in reach it is no arrival.
        """
        ahead_rad = math.radians(self._settings.ahead_deg)
        self._left_behind = frozenset(each.instance for each in pool if each.arrived and abs(each.bearing_rad) > ahead_rad)

    def reached(self, pose: Pose, floor: int, region: str, pool: LandmarkPool) -> ArrivalKind | None:
        """The evidence of an arrival now, or None. Called after every primitive: entering a space is noticed on the way."""
        anchor = self._subtask.next_anchor
        if anchor is None:
            return None
        inside = self._inside_space(anchor.space, pose, region)
        if anchor.space_kind is SpaceKind.FLOOR_TRANSITION:
            return ArrivalKind.FLOOR if floor != self._start_floor else None
        if self._subtask.landmark:
            return ArrivalKind.LANDMARK if self._at_landmark(pose, pool) else None
        if inside:
            return ArrivalKind.SPACE
        at_target = self._subtask.target_m is not None and self._near_target(pose, self._settings.target_radius_m)
        return ArrivalKind.TARGET if at_target else None

    def _at_landmark(self, pose: Pose, pool: LandmarkPool) -> bool:
        arrived = {candidate.instance for candidate in pool if candidate.arrived}
        if self._subtask.target_m is not None:
            return bool(arrived) and self._near_target(pose, self._settings.meant_landmark_m)
        self._left_behind &= arrived
        return bool(arrived - self._left_behind)

    def _inside_space(self, space: str, pose: Pose, region: str) -> bool:
        """Whether the body is ``past_opening_m`` from where it came into a region of this type during this stage."""
        if not space or not same_space(region, space) or same_space(region, self._start_region):
            self._entered_at = None
            return False
        if self._entered_at is None:
            self._entered_at = pose
        return self._entered_at.distance_m(pose.x_m, pose.y_m) >= self._settings.past_opening_m

    def _near_target(self, pose: Pose, radius_m: float) -> bool:
        """Whether the metric target is this near and on this floor; True when there is none."""
        target = self._subtask.target_m
        if target is None:
            return True
        return pose.distance_m(target[0], target[1]) <= radius_m and abs(pose.z_m - target[2]) < self._settings.floor_change_m
