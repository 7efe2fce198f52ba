"""Object-goal search: a seen instance first, else the most promising unseen place."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacevln.core import PlannerContext
from spacevln.language import REGION_CUES, head_noun
from spacevln.language.occurrence import ROOMS_OF
from spacevln.perception.attributes import Agreement
from spacevln.perception.matching import fit
from spacevln.reasoning.rules.heading import way_length_m
from spacevln.reasoning.rules.search import approach_point
from spacevln.reasoning.rules.sightings import XY
from spacevln.reasoning.rules.state import EpisodeState
from spacevln.reasoning.rules.world import World

WALK_COST_PER_M = 0.12
UNKNOWN_PROMISE = 0.45
HALLWAY_PROMISE = 0.6
LEAST_PROMISE = 0.08
FAILURE_COST = 1.5
STAIRS_COST = 0.9


@dataclass(frozen=True, slots=True)
class Quest:
    """Where to look next.

    Args:
        xy, floor: place.
        seen: an instance of the goal is there.
        space: what the place is.
        reason: in words.
        stairs: the way leads to another floor.
    """

    xy: XY
    floor: int
    seen: bool
    space: str
    reason: str
    stairs: bool = False


def likely_regions(goal: str) -> dict[str, float]:
    """How likely a room of each type holds the goal, 0 to 1: from co-occurrence, else from what tells a room."""
    words = " ".join(goal.lower().replace("_", " ").split())
    if words in ROOMS_OF or head_noun(goal) in ROOMS_OF:
        return ROOMS_OF.get(words) or ROOMS_OF[head_noun(goal)]
    head = head_noun(goal)
    weights = {region: cues[head] for region, cues in REGION_CUES.items() if head in cues}
    strongest = max(weights.values(), default=0.0)
    return {region: weight / strongest for region, weight in weights.items()} if strongest else {}


def find_object(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    """The next place of the search; None when nothing is left to look at."""
    return _seen_instance(context, world, goal, state) or _best_unseen(context, world, goal, state)


def _seen_instance(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    best: tuple[float, Quest] | None = None
    for thing in world.sightings.things:
        verdict = None if not goal else fit(goal, thing.category, thing.attributes)
        if thing.floor != world.floor or verdict is None or verdict is not Agreement.AGREED:
            continue
        floor, room = world.room_of_thing[thing.id]
        if not room:
            continue
        xy = approach_point(world, thing, floor, room, (context.pose.x_m, context.pose.y_m))
        if xy is None:
            continue
        cost = way_length_m(context, xy) + 4.0 * state.failed(floor, xy)
        if best is None or cost < best[0]:
            best = (cost, Quest(xy, floor, True, "", f"a {thing.category} is seen"))
    return None if best is None else best[1]


def _best_unseen(context: PlannerContext, world: World, goal: str, state: EpisodeState) -> Quest | None:
    likely = likely_regions(goal)
    options: list[tuple[float, Quest]] = []
    for portal in world.sightings.portals:
        if portal.floor != world.floor:
            continue
        rooms = world.portal_rooms[portal.id]
        for side in (0, 1):
            near, far = rooms[side], rooms[1 - side]
            if (
                not near
                or (far and (world.floor, far) in world.visited_rooms)
                or ((world.floor, near) not in world.visited_rooms and far)
            ):
                continue
            gain = 2.0 * promise(world, far, likely)
            xy = next(
                (p for reach in (1.2, 0.9, 0.6) if world.room_at(world.floor, p := portal.beside(1 - side, reach), 0.1)),
                portal.beside(1 - side, 0.7),
            )
            region = world.region(world.floor, far) if far else ""
            options.append(
                (
                    gain,
                    Quest(
                        xy,
                        world.floor,
                        False,
                        region or f"{portal.category} beyond",
                        f"the {portal.category} leads to {region or 'an unseen place'}",
                    ),
                )
            )
    for frontier in world.frontiers:
        if not math.isfinite(frontier.geodesic_m):
            continue
        room = world.room_at(world.floor, frontier.position_m, 0.6)
        gain = (0.4 + 0.3 * min(frontier.width_m, 2.0)) * (0.2 + promise(world, room, likely))
        region = world.region(world.floor, room) if room else ""
        options.append(
            (
                gain,
                Quest(
                    frontier.position_m,
                    world.floor,
                    False,
                    "edge of the known floor",
                    f"part of the {region or 'place'} is not seen yet",
                ),
            )
        )
    for stairs in world.sightings.things:
        if stairs.category == "stairs" and stairs.floor == world.floor:
            room = world.room_of_thing[stairs.id][1]
            point = approach_point(world, stairs, world.floor, room, (context.pose.x_m, context.pose.y_m)) if room else None
            if point is not None:
                used = sum(1 for link in world.links if world.floor in (link.floor, link.other_floor))
                options.append(
                    (
                        1.0 - STAIRS_COST - used,
                        Quest(point, world.floor, False, "stairs", "the stairs lead to another floor", True),
                    )
                )
    scored = [
        (gain - WALK_COST_PER_M * way_length_m(context, q.xy) - FAILURE_COST * state.failed(q.floor, q.xy), q)
        for gain, q in options
    ]
    return max(scored, key=lambda item: (round(item[0], 6), item[1].xy))[1] if scored else None


def promise(world: World, room: int, likely: dict[str, float]) -> float:
    """How likely entering a room brings the goal nearer: it may hold it, or, as a hallway, lead on to where it is."""
    region = world.region(world.floor, room) if room else ""
    if not region:
        return UNKNOWN_PROMISE
    if not likely:
        return UNKNOWN_PROMISE if region != "hallway" else HALLWAY_PROMISE
    held = likely.get(region, 0.0)
    return max(held, HALLWAY_PROMISE) if region == "hallway" else max(held, LEAST_PROMISE)
