"""From a metric goal to a reachable place on the way there, a direction of the look-around, and lengths of ways."""

from __future__ import annotations

import math

import numpy as np

from spacevln.core import PlannerContext, View, wrap_angle
from spacevln.reasoning.rules.grid import FloorGrid, comfortable_guide
from spacevln.reasoning.rules.lattice import Gait, first_run
from spacevln.reasoning.rules.sightings import XY

TRAVERSABLE_M = 0.5
ARRIVED_M = 0.3
RING_M = (0.15, 0.3, 0.45, 0.6)
BLIND_M = 0.8  # where no way is known, a stage goes this far along the loose one


def reachable_goal(context: PlannerContext, grid: FloorGrid, goal: XY) -> tuple[XY, bool]:
    """The goal itself, a place beside it, or the furthest place on a looser way to it, and whether a known way leads there."""
    here = context.pose.xy_m
    if math.isfinite(context.space.geodesic_m(here, np.array(goal))):
        return goal, True
    back = math.atan2(here[1] - goal[1], here[0] - goal[0])
    for radius in RING_M:
        for turn in (0.0, 0.8, -0.8, 1.6, -1.6, 2.4, -2.4, math.pi):
            xy = (goal[0] + radius * math.cos(back + turn), goal[1] + radius * math.sin(back + turn))
            if math.isfinite(context.space.geodesic_m(here, np.array(xy))):
                return xy, True
    loose = grid.loose_walk((float(here[0]), float(here[1])), goal)
    if loose is None:
        return goal, False
    for point in loose[::-1]:
        if context.pose.distance_m(*point) > 0.5 and math.isfinite(context.space.geodesic_m(here, point)):
            return (float(point[0]), float(point[1])), True
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(loose, axis=0).T))])
    at = min(BLIND_M, float(arc[-1]))
    return (float(np.interp(at, arc, loose[:, 0])), float(np.interp(at, arc, loose[:, 1]))), False


def bearing_of_way(context: PlannerContext, goal: XY) -> float:
    """Egocentric direction in which the executor would begin the way to a goal; straight to it where nothing leads nearer."""
    pose, gait = context.pose, Gait(headings=len(context.views))
    guide = comfortable_guide(context.space, pose, goal)
    nothing, free_m = np.empty((0, 2)), gait.run * gait.step_m
    run = first_run(gait, context.space, nothing, pose, guide, np.array(goal), ARRIVED_M, free_m, (True, True), aligning=True)
    if not (run.turns or run.forwards):
        return pose.bearing_rad(*goal)
    return wrap_angle(run.turns * 2 * math.pi / gait.headings)


def choose_view(context: PlannerContext, bearing_rad: float) -> View:
    """The traversable view nearest to a direction; the nearest of all when none is traversable."""
    open_views = [view for view in context.views if view.obstacle_m >= TRAVERSABLE_M] or list(context.views)
    return min(open_views, key=lambda view: (round(abs(wrap_angle(view.heading_rad - bearing_rad)), 6), view.label))


def way_length_m(context: PlannerContext, goal: XY) -> float:
    """Known way to a goal; a pessimistic straight line where none is known."""
    known = context.space.geodesic_m(context.pose.xy_m, np.array(goal))
    return float(known) if math.isfinite(known) else 1.5 * context.pose.distance_m(*goal) + 1.0
