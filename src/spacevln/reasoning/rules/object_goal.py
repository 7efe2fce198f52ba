"""Object-goal search: a seen instance first, else the unseen place with the best chance for the steps it costs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from spacevln.core import PlannerContext, StageEnd
from spacevln.language import head_noun
from spacevln.perception.attributes import Agreement
from spacevln.perception.matching import fit
from spacevln.reasoning.rules.beliefs import Beliefs
from spacevln.reasoning.rules.flights import STAIRS_ENTRY
from spacevln.reasoning.rules.grid import NOWHERE, resampled
from spacevln.reasoning.rules.heading import way_length_m
from spacevln.reasoning.rules.sightings import PRECISE_QUALITY, XY, Portal, Thing
from spacevln.reasoning.rules.state import EpisodeState
from spacevln.reasoning.rules.world import World

STEPS_PER_M = 4.6  # forwards of 0.25 m, and turns on the way
STUCK = 2  # failed stages to the only place left
PIECE_M = 1.8
STAGE_STEPS = 16.0  # a look-around and the turns to the next direction
STAIRS_STEPS = 30.0
AT_ENTRY_M = 1.0  # of a flight
STAIRS = 0.25  # share of homes whose goal is on another storey than the start
FAILED = 0.2  # what a failed stage leaves of a place's hope
AROUND = 0.2  # and one that parts nothing
GUESSED = 0.6  # and a portal whose threshold was not seen
WALL_STEP_M = 0.05
LOOKED_M = 0.9  # a place this near to a look-around hides nothing more
OVERLOOKED_M = 1.5  # nor does a place beyond a portal in clear sight of one
EDGE = 0.5  # a frontier shows a part of a room
EDGE_UNSEEN = 0.4  # and there is more of a room behind it than its known floor tells
TIGHT = 0.1  # hope that cannot be reached with the steps left
STAND_OFF_M = 0.65  # from a goal's nearest surface
AT_GOAL_M = 0.75
FAR_M = 1.3  # from a thing's surface: more than a table between
DETOUR_M = 0.6  # beyond the straight line: something as long as a wall lies between
GIVEN_UP = 3  # stages to one thing in vain: others first, until few steps are left
LAST_TRY_STEPS = 60
VAIN_M = 4.0  # of way, that a stage in vain is worth
STOOD_M = 0.35  # around a place from which the goal was not confirmed
KIND_STEPS = 70  # another kind of the goal's genus does when no more steps are left


Option = tuple[float, float, "Quest"]  # chance of finding the goal there, steps beside the way, where


class Match(IntEnum):
    """How well a seen thing's name fits the goal's."""

    KIND = 1  # of the same genus: "wall cabinet" for "cabinet"
    NAME = 2  # the very name or another name of the same


@dataclass(frozen=True, slots=True)
class Quest:
    """Where to look next.

    Args:
        xy, floor: place.
        seen: an instance of the goal is there.
        space: what the place is.
        reason: in words.
        stairs: the way leads to another floor.
        thing: number of the instance that is seen.
    """

    xy: XY
    floor: int
    seen: bool
    space: str
    reason: str
    stairs: bool = False
    thing: int | None = None


def match(goal: str, name: str, attributes: tuple[str, ...]) -> Match | None:
    """How well a thing of a name fits a goal; None when it does not.

    An object goal names a category, so that a qualifier on one side alone makes another kind: a "round table" is a kind of
    "table", and a "table" need not be round.
    """
    if fit(goal, name, attributes) is not Agreement.AGREED:
        return None
    wanted, found = _words(goal), _words(name)
    if wanted == found:
        return Match.NAME
    qualified = found[-len(wanted) :] == wanted or wanted[-len(found) :] == found
    return Match.NAME if head_noun(goal) == head_noun(name) and not qualified else Match.KIND


def _words(name: str) -> list[str]:
    return name.lower().replace("-", " ").split()


def find_object(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    """The next place of the search; None when nothing is left to look at."""
    found = _seen_instance(context, world, goal, state, Match.NAME) if goal else None
    if found is None and goal and context.steps_left < KIND_STEPS:
        found = _seen_instance(context, world, goal, state, Match.KIND)
    if found is None:
        found = _best_unseen(context, world, goal, state)
    return found or (_seen_instance(context, world, goal, state, Match.KIND) if goal else None)


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
        for thing in _instances(world, goal, least)
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


def _on_its_side(context: PlannerContext, thing: Thing, xy: XY) -> bool:
    """Whether a place lies on the side of a wall from which a thing was seen: no long way around to the floor before it."""
    before = _before(context, thing)
    if before is None:
        return True
    return context.space.geodesic_m(np.array(xy), np.array(before)) <= math.dist(xy, before) + DETOUR_M


def _instances(world: World, goal: str, least: Match) -> Iterator[Thing]:
    for thing in world.sightings.things:
        if thing.floor == world.floor:
            verdicts = [verdict for name in thing.names if (verdict := match(goal, name, thing.attributes)) is not None]
            if verdicts and max(verdicts) >= least:
                yield thing


def _seen_instance(context: PlannerContext, world: World, goal: str, state: EpisodeState, least: Match) -> Quest | None:
    best: tuple[float, Quest] | None = None
    for thing in _instances(world, goal, least):
        xy = standing_place(context, world, thing, state)
        if xy is None:
            continue
        vain = state.vain.get(thing.id, 0)
        if vain >= GIVEN_UP and context.steps_left > LAST_TRY_STEPS:
            continue
        cost = way_length_m(context, xy) + VAIN_M * vain
        if best is None or cost < best[0]:
            best = (cost, Quest(xy, world.floor, True, "", f"a {thing.names[0]} is seen", thing=thing.id))
    return None if best is None else best[1]


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
        and float(thing.distance_m(np.array([before]))[0]) > FAR_M
        and context.pose.distance_m(*before) > STOOD_M
    ):
        return before  # the floor at its feet is not known yet
    grid = world.grids[world.floor]
    cells = np.argwhere(grid.rooms > 0)
    centres = grid.origin + (cells + 0.5) * 0.15
    near = np.hypot(*(centres - np.array(thing.xy)).T) < 1.8 + thing.extent_m
    cells, centres = cells[near], centres[near]
    if not len(centres):
        return before
    distance = thing.distance_m(centres)
    clear = grid.clearance_m[cells[:, 0], cells[:, 1]]
    room = world.room_of_thing[thing.id][1]
    elsewhere = grid.rooms[cells[:, 0], cells[:, 1]] != room if room else np.zeros(len(cells), dtype=np.bool_)
    eye, side = np.array(thing.seen_from) - np.array(thing.xy), centres - np.array(thing.xy)
    cosine = (side @ eye) / np.maximum(np.hypot(*side.T) * math.hypot(*eye), 1e-6)
    cost = np.abs(distance - STAND_OFF_M) + 0.05 * np.hypot(*(centres - context.pose.xy_m).T)
    cost += np.where(clear < 0.2, 0.6, 0.0) + 0.8 * elsewhere + 0.1 * (1.0 - cosine)
    for floor, xy in (*world.visited, *state.failures):
        if floor == world.floor:
            cost += 0.5 * (np.hypot(*(centres - np.array(xy)).T) < STOOD_M)
    for index in np.argsort(cost, kind="stable")[:60:4]:
        xy = (float(centres[index, 0]), float(centres[index, 1]))
        reachable = distance[index] < 1.6 and math.isfinite(context.space.geodesic_m(context.pose.xy_m, centres[index]))
        if reachable and _on_its_side(context, thing, xy):
            return xy
    return thing.front


def _best_unseen(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    """Chance over steps: of independent places to search, the order by that ratio finds the object soonest."""
    beliefs = Beliefs(world, goal)
    best: tuple[float, XY, Quest] | None = None
    options = (*_beyond_portals(context, world, beliefs), *_edges(context, world, beliefs), *_storeys(context, world, beliefs))
    for chance, steps, quest in options:
        needed = STAGE_STEPS + steps + STEPS_PER_M * way_length_m(context, quest.xy)
        hope = chance * FAILED ** (state.failed(quest.floor, quest.xy) + state.spent(quest.floor, quest.xy))
        if needed > context.steps_left:
            hope *= TIGHT
        rank = (round(hope / needed, 9), quest.xy, quest)
        if best is None or rank[:2] > best[:2]:
            best = rank
    if best is None or (state.failed(world.floor, best[1]) >= STUCK and context.stage % 2):
        return None  # elsewhere first: the same place would fail in the same way
    return _stage_of(context, best[2], state)


def _stage_of(context: PlannerContext, quest: Quest, state: EpisodeState) -> Quest:
    """A way that a stage did not manage as a whole is taken in pieces."""
    if not state.failed(quest.floor, quest.xy):
        return quest
    path = context.space.path(context.pose.xy_m, np.array(quest.xy))
    if len(path) < 2:
        return quest
    x, y = resampled(path, PIECE_M)[1]
    return replace(quest, xy=(float(x), float(y)))


def _looked(context: PlannerContext, world: World, xy: XY) -> bool:
    """Whether a look-around was made beside a place, with no wall between."""
    return any(
        floor == world.floor and math.dist(xy, seen) < LOOKED_M and not _wall_between(context, seen, xy)
        for floor, seen in world.visited
    )


def _wall_between(context: PlannerContext, a: XY, b: XY) -> bool:
    along = np.arange(0.0, 1.0, WALL_STEP_M / max(math.dist(a, b), WALL_STEP_M))[:, None]
    return bool(context.space.is_obstacle(np.array(a) + along * (np.array(b) - np.array(a))).any())


def _overlooked(context: PlannerContext, world: World, xy: XY) -> bool:
    """Whether a look-around was made in clear sight of a place, not far from it."""
    return any(
        floor == world.floor and math.dist(xy, seen) < OVERLOOKED_M and context.space.line_of_sight(np.array(seen), np.array(xy))
        for floor, seen in world.visited
    )


def _beyond_portals(context: PlannerContext, world: World, beliefs: Beliefs) -> Iterator[Option]:
    for portal in world.sightings.portals:
        if portal.floor != world.floor:
            continue
        rooms = world.portal_rooms[portal.id]
        for side in (0, 1):
            near, far = rooms[side], rooms[1 - side]
            around = near == far  # known floor leads around the threshold as well: little is hidden beyond
            far = NOWHERE if around else far
            if not near or (far and (world.floor, far) in world.visited_rooms):
                continue
            if far and (world.floor, near) not in world.visited_rooms:
                continue
            xy = _inside(world, portal, 1 - side)
            if _looked(context, world, xy) or _overlooked(context, world, xy):
                continue
            hope = beliefs.unseen(far) * beliefs.holds(far, near) + beliefs.leads_on(far, near)
            if portal.quality < PRECISE_QUALITY:
                hope *= GUESSED
            if around:
                hope *= AROUND
            region = world.region(world.floor, far) if far else ""
            words = f"the {portal.category} leads to {region or 'an unseen place'}"
            yield hope, 0.0, Quest(xy, world.floor, False, region or f"{portal.category} beyond", words)


def _inside(world: World, portal: Portal, side: int) -> XY:
    """A place just inside the room on a side of a portal, from which most of the room is in view."""
    for reach in (1.0, 1.2, 0.8, 0.6):
        xy = portal.beside(side, reach)
        if world.room_at(world.floor, xy, 0.1):
            return xy
    return portal.beside(side, 0.7)


def _edges(context: PlannerContext, world: World, beliefs: Beliefs) -> Iterator[Option]:
    for frontier in world.frontiers:
        if not math.isfinite(frontier.geodesic_m) or _looked(context, world, frontier.position_m):
            continue
        room = world.room_at(world.floor, frontier.position_m, 0.6)
        share = EDGE * min(frontier.width_m, 2.0) / 2.0
        hope = share * max(beliefs.unseen(room), EDGE_UNSEEN) * beliefs.holds(room)
        hope += share * beliefs.leads_on(room)
        region = world.region(world.floor, room) if room else ""
        words = f"part of the {region or 'place'} is not seen yet"
        yield hope, 0.0, Quest(frontier.position_m, world.floor, False, "edge of the known floor", words)


def _storeys(context: PlannerContext, world: World, beliefs: Beliefs) -> Iterator[Option]:
    """Other storeys, by stairs that were not walked yet."""
    for stairs in world.stairs_on(world.floor):
        flight = world.flights.get(stairs.id)
        if world.climbed(flight.entry if flight else stairs.xy):
            continue
        room = world.room_of_thing[stairs.id][1]
        xy = flight.entry if flight else world.sight_of(stairs, room)
        if xy is not None:
            at_entry = flight is not None and context.pose.distance_m(*flight.entry) < AT_ENTRY_M
            hope = 1.0 if at_entry and _came_for_stairs(context) else STAIRS * beliefs.on_another_storey()
            yield hope, STAIRS_STEPS, Quest(xy, world.floor, False, "stairs", "the stairs lead to another floor", True)


def _came_for_stairs(context: PlannerContext) -> bool:
    """Whether the last stage headed for the entry of stairs: one does not turn away at the foot of what one came for."""
    last = context.last_subtask
    return last is not None and last.next_anchor is not None and last.next_anchor.space == STAIRS_ENTRY.space
