"""Object-goal search: a seen instance first, else the unseen place with the best chance for the steps it costs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from spacevln.core import PlannerContext
from spacevln.perception.matching import Match
from spacevln.reasoning.rules.beliefs import Beliefs
from spacevln.reasoning.rules.flights import STAIRS_SIGHT
from spacevln.reasoning.rules.grid import NOWHERE, resampled
from spacevln.reasoning.rules.heading import way_length_m
from spacevln.reasoning.rules.instances import KIND_STEPS, WITHIN_M, instances, obstacle_between, standing_place
from spacevln.reasoning.rules.sightings import PRECISE_QUALITY, XY, Portal
from spacevln.reasoning.rules.state import EpisodeState
from spacevln.reasoning.rules.world import World

STEPS_PER_M = 4.6  # forwards of 0.25 m, and turns on the way
STUCK = 2  # failed stages to the only place left
PIECE_M = 1.8
STAGE_STEPS = 16.0  # a look-around and the turns to the next direction
STAGE_M = 4.0  # of way
FURTHER_STEPS = 36.0  # to the next room, when its door is not known yet, look-around included
STAIRS_STEPS = 30.0
STAIRS = 0.5  # share of homes with stairs whose goal is on another storey than the start
ON_THE_WAY = 1.5  # a place that the last stage headed for: turning back for a little more costs twice
SIGHT = 0.5  # what each look for the steps of stairs leaves of their hope
FAILED = 0.2  # what a failed stage leaves of a place's hope
AROUND = 0.2  # and one that parts nothing
GUESSED = 0.6  # and a portal whose threshold was not seen
LOOKED_M = 0.9  # a place this near to a look-around hides nothing more
OVERLOOKED_M = 1.5  # nor does a place beyond a portal in clear sight of one
EDGE = 0.5  # a frontier shows a part of a room
EDGE_UNVISITED = 0.5  # and more of one that was only looked into
EDGE_UNSEEN = 0.4  # and there is more of a room behind it than its known floor tells
TIGHT = 0.1  # hope that cannot be reached with the steps left
GIVEN_UP = 3  # stages to one thing in vain: others first, until few steps are left
LAST_TRY_STEPS = 60
VAIN_M = 4.0  # of way, that a stage in vain is worth


# chance of finding the goal there, chance of finding it one room further, steps beside the way, where
Option = tuple[float, float, float, "Quest"]


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


def find_object(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    """The next place of the search; None when nothing is left to look at."""
    found = _seen_instance(context, world, goal, state, Match.NAME) if goal else None
    if found is None and goal and context.steps_left < KIND_STEPS:
        found = _seen_instance(context, world, goal, state, Match.KIND)
    if found is None:
        found = _best_unseen(context, world, goal, state)
    return found or (_seen_instance(context, world, goal, state, Match.KIND) if goal else None)


def _seen_instance(context: PlannerContext, world: World, goal: str, state: EpisodeState, least: Match) -> Quest | None:
    best: tuple[float, Quest] | None = None
    for thing in instances(world, goal, least):
        xy = standing_place(context, world, thing, state)
        if xy is None:
            continue
        vain = state.vain.get(thing.id, 0)
        near = float(thing.distance_m(context.pose.xy_m[None])[0]) <= WITHIN_M
        if vain >= GIVEN_UP and context.steps_left > LAST_TRY_STEPS and not near:
            continue
        cost = way_length_m(context, xy) + VAIN_M * vain
        if best is None or cost < best[0]:
            best = (cost, Quest(xy, world.floor, True, "", f"a {thing.names[0]} is seen", thing=thing.id))
    return None if best is None else best[1]


def _best_unseen(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    """Chance over steps: of independent places to search, the order by that ratio finds the object soonest."""
    beliefs = Beliefs(world, goal)
    best: tuple[float, XY, Quest] | None = None
    options = (
        *_beyond_portals(context, world, beliefs),
        *_edges(context, world, beliefs),
        *_storeys(world, beliefs, state),
    )
    for here, further, steps, quest in options:
        way_m = way_length_m(context, quest.xy)
        needed = STAGE_STEPS * max(1.0, way_m / STAGE_M) + steps + STEPS_PER_M * way_m
        worth = max(_worth(here, needed, context.steps_left), _worth(here + further, needed + FURTHER_STEPS, context.steps_left))
        worth *= FAILED ** (state.failed(quest.floor, quest.xy) + state.spent(quest.floor, quest.xy))
        if state.on_the_way_to(quest.floor, quest.xy):
            worth *= ON_THE_WAY
        rank = (round(worth, 9), quest.xy, quest)
        if best is None or rank[:2] > best[:2]:
            best = rank
    if best is None or (state.failed(world.floor, best[1]) >= STUCK and context.stage % 2):
        return None  # elsewhere first: the same place would fail in the same way
    return _stage_of(context, best[2], state)


def _worth(chance: float, needed: float, steps_left: int) -> float:
    """Chance for a step; of what cannot be reached with the steps left, little."""
    return chance / needed * (TIGHT if needed > steps_left else 1.0)


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
        floor == world.floor and math.dist(xy, seen) < LOOKED_M and not obstacle_between(context, seen, xy)
        for floor, seen in world.visited
    )


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
            share = GUESSED if portal.quality < PRECISE_QUALITY else 1.0
            if around:
                share *= AROUND
            region = world.region(world.floor, far) if far else ""
            words = f"the {portal.category} leads to {region or 'an unseen place'}"
            quest = Quest(xy, world.floor, False, region or f"{portal.category} beyond", words)
            yield share * beliefs.unseen(far) * beliefs.holds(far, near), share * beliefs.leads_on(far, near), 0.0, quest


def _inside(world: World, portal: Portal, side: int) -> XY:
    """A place just inside the room on a side of a portal, from which most of the room is in view."""
    for reach in (0.7, 0.9, 0.5, 1.1):
        xy = portal.beside(side, reach)
        if world.room_at(world.floor, xy, 0.1):
            return xy
    return portal.beside(side, 0.7)


def _edges(context: PlannerContext, world: World, beliefs: Beliefs) -> Iterator[Option]:
    for frontier in world.frontiers:
        if not math.isfinite(frontier.geodesic_m) or _looked(context, world, frontier.position_m):
            continue
        room = world.room_at(world.floor, frontier.position_m, 0.6)
        looked_into = room and (world.floor, room) not in world.visited_rooms
        share = EDGE_UNVISITED if looked_into else EDGE * min(frontier.width_m, 2.0) / 2.0
        here = share * max(beliefs.unseen(room), EDGE_UNSEEN) * beliefs.holds(room)
        region = world.region(world.floor, room) if room else ""
        words = f"part of the {region or 'place'} is not seen yet"
        quest = Quest(frontier.position_m, world.floor, False, "edge of the known floor", words)
        yield here, share * beliefs.leads_on(room), 0.0, quest


def _storeys(world: World, beliefs: Beliefs, state: EpisodeState) -> Iterator[Option]:
    """Other storeys, by stairs that were not walked yet."""
    for stairs in world.stairs_on(world.floor):
        flight = world.flights.get(stairs.id)
        if world.climbed(flight.entry if flight else stairs.xy):
            continue
        room = world.room_of_thing[stairs.id][1]
        xy = flight.entry if flight else world.sight_of(stairs, room)
        if xy is not None:
            hope = STAIRS * beliefs.on_another_storey() * (1.0 if flight else SIGHT ** state.verified.count(STAIRS_SIGHT))
            yield hope, 0.0, STAIRS_STEPS, Quest(xy, world.floor, False, "stairs", "the stairs lead to another floor", True)
