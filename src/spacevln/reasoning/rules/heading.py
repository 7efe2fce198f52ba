"""From a metric goal to a direction of the look-around and the words for it."""

from __future__ import annotations

import math

import numpy as np

from spacevln.core import PlannerContext, View, wrap_angle
from spacevln.reasoning.rules.sightings import XY

TRAVERSABLE_M = 0.5
LOOK_AHEAD_M = 1.0


def bearing_of_way(context: PlannerContext, goal: XY) -> float:
    """Egocentric direction of the first metre of the way to a goal."""
    pose = context.pose
    path = context.space.path(pose.xy_m, np.array(goal))
    if len(path) < 2:
        return pose.bearing_rad(*goal)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    at = min(LOOK_AHEAD_M, float(arc[-1]))
    if at < 0.05:
        return pose.bearing_rad(*goal)
    return pose.bearing_rad(float(np.interp(at, arc, path[:, 0])), float(np.interp(at, arc, path[:, 1])))


def choose_view(context: PlannerContext, bearing_rad: float) -> View:
    """The traversable view nearest to a direction; the nearest of all when none is traversable."""
    open_views = [view for view in context.views if view.obstacle_m >= TRAVERSABLE_M] or list(context.views)
    return min(open_views, key=lambda view: (round(abs(wrap_angle(view.heading_rad - bearing_rad)), 6), view.label))


def way_length_m(context: PlannerContext, goal: XY) -> float:
    """Known way to a goal; a pessimistic straight line where none is known."""
    known = context.space.geodesic_m(context.pose.xy_m, np.array(goal))
    return float(known) if math.isfinite(known) else 1.5 * context.pose.distance_m(*goal) + 1.0
