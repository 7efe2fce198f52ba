"""When a place counts as reached (DESIGN 5.3; paper appendix, "arrival is evaluated with a type-specific threshold")."""

from __future__ import annotations

import math
from types import MappingProxyType

import numpy as np

from spacevln.core import Anchor, CueKind, Pose, SpatialMap
from spacevln.language import normalise_region

ARRIVAL_RADIUS_M = MappingProxyType(
    {CueKind.SOLID: 0.75, CueKind.OPENING: 0.5, CueKind.STAIRS: 0.5, CueKind.NONE: 0.0}
)  # opening and solid [authors' code]; stairs as an opening [ours]
PAST_OPENING_M = 0.5
_WALL_STEP_M = 0.05
_OWN_SURFACE_M = 0.25  # obstacle cells this near to the seen surface are the landmark itself


def blocked_by_wall(pose: Pose, point: tuple[float, float], metric_map: SpatialMap) -> bool:
    """Whether a known obstacle other than the landmark itself stands between the pose and its nearest seen surface."""
    distance = pose.distance_m(*point)
    steps = math.floor((distance - _OWN_SURFACE_M) / _WALL_STEP_M)
    if steps < 2:
        return False
    share = (np.arange(1, steps + 1) * _WALL_STEP_M / distance)[:, None]
    return bool(metric_map.is_obstacle(pose.xy_m + share * (np.array(point) - pose.xy_m)).any())


def reached_space(anchor: Anchor, region: str, pose: Pose, opening_m: tuple[float, float] | None, start: Pose) -> bool:
    """Arrival at an anchor without a landmark: by its space.

    Args:
        anchor: the target.
        region: type of the region the agent stands in, ``""`` when unknown.
        pose: live pose.
        opening_m: middle of the opening that leads in, where one is known.
        start: pose at the beginning of the stage, on this side of the opening.

    Returns:
        True when the region is of the anchor's type and the agent stands at least 0.5 m past the opening.
    """
    if not anchor.space or not region or normalise_region(anchor.space) != normalise_region(region):
        return False
    if opening_m is None:
        return True
    way = np.array(opening_m) - start.xy_m
    length = float(np.hypot(*way))
    if length < 1e-6:
        return pose.distance_m(*opening_m) >= PAST_OPENING_M
    return float((pose.xy_m - np.array(opening_m)) @ way) / length >= PAST_OPENING_M
