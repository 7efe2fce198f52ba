"""Seen instances of an object goal: which things are one, where to stand before one, and whether one is reached."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from spacevln.core import PlannerContext, StageEnd
from spacevln.perception.matching import Match, match
from spacevln.reasoning.rules.sightings import XY, Thing
from spacevln.reasoning.rules.state import BEFORE_M, EpisodeState
from spacevln.reasoning.rules.world import World

STAND_OFF_M = 0.65  # from a goal's nearest surface
AT_GOAL_M = 0.75
DETOUR_M = 0.6  # beyond the straight line: something as long as a wall lies between
OF_ITSELF_M = 0.2  # before its surface the map may be a thing's own
LINE_STEP_M = 0.05
WITHIN_M = 0.95  # of a goal's nearest surface; farther off is not at it
AROUND_M = 1.6  # from there one sees where one can stand nearer; once
ROUND = 1.5  # times the straight line, that an unknown way measures
STOOD_M = 0.35  # around a place from which the goal was not confirmed
KIND_STEPS = 70  # another kind of the goal's genus does when no more steps are left


def at_goal(context: PlannerContext, world: World, goal: str) -> bool:
    """Whether an instance of the goal is in view within arm's reach, or the last stage arrived at one that is that near."""
    least = Match.NAME if context.steps_left >= KIND_STEPS else Match.KIND
    for view in context.views:
        for sighting in view.sightings:
            verdict = match(goal, sighting.category, sighting.attributes)
            if verdict is not None and verdict >= least and sighting.distance_m <= AT_GOAL_M:
                return True
    arrived = (
        context.feedback is not None
        and context.feedback.end is StageEnd.ARRIVAL
        and context.last_subtask is not None
        and context.last_subtask.targets_final_anchor
    )
    here = (context.pose.x_m, context.pose.y_m)
    return arrived and any(
        float(thing.distance_m(np.array([here]))[0]) <= AT_GOAL_M + 0.1 and _on_its_side(context, thing, here)
        for thing in instances(world, goal, least)
    )


def _before(context: PlannerContext, thing: Thing) -> XY | None:
    """The known reachable floor nearest to a thing on the line along which it was first seen; None when there is none."""
    (x, y), eye = min(thing.surface or [thing.xy], key=lambda p: math.dist(p, thing.seen_from)), thing.seen_from
    reach = math.dist((x, y), eye)
    for along in np.arange(0.3, reach, 0.15) / max(reach, 0.3):
        xy = (x + float(along) * (eye[0] - x), y + float(along) * (eye[1] - y))
        if math.isfinite(context.space.geodesic_m(context.pose.xy_m, np.array(xy))):
            return xy
    return None


def obstacle_between(context: PlannerContext, a: XY, b: XY) -> bool:
    """Whether an obstacle is known on the line from a place to another."""
    along = np.arange(0.0, 1.0, LINE_STEP_M / max(math.dist(a, b), LINE_STEP_M))[:, None]
    return bool(context.space.is_obstacle(np.array(a) + along * (np.array(b) - np.array(a))).any())


def _on_its_side(context: PlannerContext, thing: Thing, xy: XY) -> bool:
    """Whether a place lies on the side of a wall from which a thing was seen.

    That is so where nothing but air is between, as beside a dresser that was seen over a bed; or where the floor before the
    thing is no long way around, as at a table that it stands on.
    """
    face = min(thing.surface or [thing.xy], key=lambda point: math.dist(point, xy))
    reach = math.dist(xy, face)
    short = max(0.0, 1.0 - OF_ITSELF_M / max(reach, OF_ITSELF_M))
    if not obstacle_between(context, xy, (xy[0] + short * (face[0] - xy[0]), xy[1] + short * (face[1] - xy[1]))):
        return True
    before = _before(context, thing)
    if before is None:
        return True
    return context.space.geodesic_m(np.array(xy), np.array(before)) <= math.dist(xy, before) + DETOUR_M


def instances(world: World, goal: str, least: Match) -> Iterator[Thing]:
    """The seen things of the current storey that fit a goal at least so well."""
    for thing in world.sightings.things:
        if thing.floor == world.floor:
            verdicts = [verdict for name in thing.names if (verdict := match(goal, name, thing.attributes)) is not None]
            if verdicts and max(verdicts) >= least:
                yield thing


def standing_place(context: PlannerContext, world: World, thing: Thing, state: EpisodeState) -> XY | None:
    """A free place to stand before a thing, at ``STAND_OFF_M`` from its seen surface; None when there is none.

    Preferred are places in the room it was seen in, on the side from which it was seen, with room around them, near the agent,
    and away from where the agent already stood in vain.
    """
    before = _before(context, thing)
    if (
        before is not None
        and not state.failed(world.floor, before)
        and not state.spent(world.floor, before)
        and float(thing.distance_m(np.array([before]))[0]) > BEFORE_M
        and context.pose.distance_m(*before) > STOOD_M
    ):
        return before  # the floor at its feet is not known yet
    grid = world.grids[world.floor]
    cells = np.argwhere(grid.rooms > 0)
    centres = grid.origin + (cells + 0.5) * 0.15
    near = np.hypot(*(centres - np.array(thing.xy)).T) < 1.8 + thing.extent_m
    cells, centres = cells[near], centres[near]
    if not len(centres):
        return _towards(world, thing, state) or before
    distance = thing.distance_m(centres)
    clear = grid.clearance_m[cells[:, 0], cells[:, 1]]
    room = world.room_of_thing[thing.id][1]
    elsewhere = grid.rooms[cells[:, 0], cells[:, 1]] != room if room else np.zeros(len(cells), dtype=np.bool_)
    eye, side = np.array(thing.seen_from) - np.array(thing.xy), centres - np.array(thing.xy)
    cosine = (side @ eye) / np.maximum(np.hypot(*side.T) * math.hypot(*eye), 1e-6)
    cost = np.abs(distance - STAND_OFF_M) + 0.05 * np.hypot(*(centres - context.pose.xy_m).T)
    cost += np.where(distance > WITHIN_M, 2.0, 0.0) + np.where(clear < 0.2, 0.6, 0.0) + 0.8 * elsewhere + 0.1 * (1.0 - cosine)
    for floor, xy in (*world.visited, *state.failures):
        if floor == world.floor:
            cost += 0.5 * (np.hypot(*(centres - np.array(xy)).T) < STOOD_M)
    farthest_m = WITHIN_M if state.vain.get(thing.id) else AROUND_M
    for index in np.argsort(cost, kind="stable")[:60:4]:
        xy = (float(centres[index, 0]), float(centres[index, 1]))
        reachable = distance[index] < farthest_m and math.isfinite(context.space.geodesic_m(context.pose.xy_m, centres[index]))
        if reachable and _on_its_side(context, thing, xy):
            return xy
    return _towards(world, thing, state) or thing.front


def _towards(world: World, thing: Thing, state: EpisodeState) -> XY | None:
    """The edge of the known floor from which the way on to a thing, that furniture or a wall hides, is shortest."""
    edges = [
        (frontier.geodesic_m + ROUND * math.dist(frontier.position_m, thing.xy), frontier.position_m)
        for frontier in world.frontiers
        if math.isfinite(frontier.geodesic_m)
        and not state.failed(world.floor, frontier.position_m)
        and not state.spent(world.floor, frontier.position_m)
    ]
    return min(edges)[1] if edges else None
