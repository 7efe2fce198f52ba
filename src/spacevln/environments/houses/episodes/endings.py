"""Saying where to stop: the stop conditions of a route's end."""

from __future__ import annotations

import math
from collections.abc import Callable

from spacevln.environments.houses.episodes import making as make
from spacevln.environments.houses.episodes.clauses import Clause, Cross, Stop, Thing
from spacevln.environments.houses.episodes.nouns import SIDE_WORDS, definite, portal_words, room_words, thing_words
from spacevln.environments.houses.episodes.stops import in_front
from spacevln.environments.houses.episodes.stretch import Stretch
from spacevln.environments.houses.episodes.topology import Portal, is_hallway

Ending = tuple[Clause, ...]
Options = list[tuple[float, Callable[[], Ending]]]


def ending(stretch: Stretch, before: list[Clause]) -> Ending | None:
    """The last clauses: a stop condition that holds at the route's end, or None when there is none.

    Args:
        stretch: the last leg.
        before: the clauses of the leg before; empty when the last doorway was not mentioned.
    """
    end = stretch.route.end
    entered = bool(before) and any(isinstance(atom, Cross) and not atom.climb for atom in before[-1].atoms)
    options: Options = []
    match end.kind:
        case "item":
            options = _item(stretch)
        case "entry" | "room":
            options = _inside(stretch, entered)
        case "doorway":
            options = _doorway(stretch, entered)
        case "before":
            options = _before(stretch)
        case "landing" | "stairs":
            options = _stairs(stretch, before)
        case "end":
            options = _hall_end(stretch)
    if not options:
        return None
    weights = [w for w, _ in options]
    pick = stretch.rng.choice(len(options), p=[w / sum(weights) for w in weights])
    return options[int(pick)][1]()


def _stop(code: str, form: str, meaning: Stop, nouns: tuple[str, ...] = (), **slots: str) -> Clause:
    return make.stop((code,), form, meaning, tuple(sorted(slots.items())), nouns)


def _item(stretch: Stretch) -> Options:
    item = stretch.route.end.item
    if item is None:
        return []
    thing = stretch.thing(item)
    lm = definite(thing_words(thing))
    options: Options = [
        (1.0, lambda: (_stop("Z3", "stop_near", Stop("near", thing), (thing.noun,), lm=lm),)),
        (0.3, lambda: (_stop("Z4", "stop_at", Stop("near", thing), (thing.noun,), lm=lm),)),
        (0.3, lambda: (make.toward(thing, stretch.rng), _stop("Z7", "stop_here", Stop("near", thing)))),
        (0.18, lambda: (_stop("Z8", "stop_once_reach", Stop("near", thing), (thing.noun,), lm=lm),)),
        (0.2, lambda: (make.toward(thing, stretch.rng),)),
    ]
    front = in_front(item)
    if math.dist(front, stretch.route.end.xy) < max(0.7, item.size[0] / 3) and item.solid:
        options.append((1.0, lambda: (_stop("Z4", "stop_front", Stop("front", thing), (thing.noun,), lm=lm),)))
    options += _between(stretch, thing)
    return options


def _between(stretch: Stretch, thing: Thing) -> Options:
    """Also near something else: the stop names both."""
    item, xy = stretch.route.end.item, stretch.route.end.xy
    others = [
        o
        for p, o in stretch.landmarks()
        if item is not None
        and o.category != item.category
        and math.dist((o.x, o.y), xy) < 1.8
        and math.dist((o.x, o.y), (item.x, item.y)) < 2.2
    ]
    if not others:
        return []
    other = stretch.thing(others[int(stretch.rng.integers(len(others)))])
    slots = {"lm": definite(thing_words(thing)), "lm2": definite(thing_words(other))}
    meaning = Stop("near", thing, other)
    return [(0.3, lambda: (_stop("Z3", "stop_near_both", meaning, (thing.noun, other.noun), **slots),))]


def _inside(stretch: Stretch, entered: bool) -> Options:
    words = room_words(stretch.room.type, stretch.rng)
    kind = stretch.room.type.replace("_", " ")
    space = definite(words)
    options: Options = []
    if stretch.route.end.kind == "room":
        options.append((1.0, lambda: (_stop("Z6", "stop_in", Stop("in", space=kind), (words,), space=space),)))
    if entered and stretch.leg.length_m < 1.2:
        options += [
            (1.0, lambda: (_stop("Z7", "stop_here", Stop("here")),)),
            (0.35, lambda: (_stop("Z6", "stop_inside", Stop("inside", space=kind), (words,), space=space),)),
            (0.3, lambda: (_stop("Z8", "stop_once_in", Stop("inside", space=kind), (words,), space=space),)),
            (0.45, lambda: ()),
        ]
    return options


def _door_slots(stretch: Stretch, portal: Portal) -> tuple[str, str, str]:
    noun, _ = portal_words(portal, stretch.rng)
    other = stretch.topology.house.rooms[portal.other(stretch.room.id)]
    return definite(noun), noun, other.type.replace("_", " ")


def _doorway(stretch: Stretch, entered: bool) -> Options:
    portal = stretch.route.end.portal
    if portal is None or not entered or stretch.leg.length_m > 1.2:
        return []
    kind = stretch.room.type.replace("_", " ")
    words = room_words(stretch.room.type, stretch.rng)
    door = ("doorway" if stretch.chance(0.8) else "entrance") if portal.kind == "doorway" else "entrance"
    return [
        (1.0, lambda: (_stop("Z1", "stop_doorway", Stop("doorway"), (door,), door=definite(door)),)),
        (
            0.7,
            lambda: (
                _stop(
                    "Z1",
                    "stop_doorway_of",
                    Stop("doorway", space=kind),
                    (door, words),
                    door=definite(door),
                    space=definite(words),
                ),
            ),
        ),
    ]


def _before(stretch: Stretch) -> Options:
    portal = stretch.route.end.portal
    if portal is None:
        return []
    # the end lies on this room's side of a portal that is not walked through
    door, noun, kind = _door_slots(stretch, portal)
    words = room_words(kind, stretch.rng)
    space = definite(words)
    options: Options = [
        (0.5, lambda: (_stop("Z2", "stop_door", Stop("door"), (noun,), door=door),)),
        (0.8, lambda: (_stop("Z2", "stop_door_to", Stop("door", space=kind), (noun, words), door=door, space=space),)),
        (0.4, lambda: (_stop("Z6", "stop_outside", Stop("outside", space=kind), (words,), space=space),)),
        (0.3, lambda: (_stop("Z1", "stop_doorway_of", Stop("doorway", space=kind), (noun, words), door=door, space=space),)),
        (0.2, lambda: (_stop("Z8", "stop_before_space", Stop("outside", space=kind), (words,), space=space),)),
    ]
    angle = stretch.route.nodes[-1].yaw_rad
    bearing = math.remainder(
        math.atan2(portal.centre[1] - stretch.node.xy[1], portal.centre[0] - stretch.node.xy[0]) - angle, math.tau
    )
    turn = math.remainder(portal.out_yaw(stretch.room.id) - float(stretch.leg.yaws[len(stretch.leg.yaws) // 2]), math.tau)
    if (
        stretch.index
        and bearing * turn > 0
        and math.radians(30) < abs(bearing) < math.radians(110)
        and abs(turn) > math.radians(45)
    ):
        side = 1 if bearing > 0 else -1
        slots = {"door": door, "side": SIDE_WORDS[side]}
        options.append((0.5, lambda: (_stop("Z2", "stop_door_side", Stop("door", side=side), (noun,), **slots),)))
    return options


def _stairs(stretch: Stretch, before: list[Clause]) -> Options:
    portal = stretch.route.end.portal
    if portal is None:
        return []
    where = "bottom" if portal.rooms[0] == stretch.room.id else "top"
    climbed = bool(before) and any(isinstance(atom, Cross) and atom.climb for atom in before[-1].atoms)
    form = f"stop_{where}"
    options: Options = [(1.0, lambda: (_stop("Z5", form, Stop(where), ("stairs",)),))]
    if climbed:
        options += [(0.4, lambda: (_stop("Z7", "stop_here", Stop("here")),)), (0.15, lambda: ())]
    elif is_hallway(stretch.room) or stretch.leg.length_m > 1.5:
        options.append((0.4, lambda: (_stop("Z8", "stop_before_stairs", Stop(where), ("stairs",)),)))
    return options


def _hall_end(stretch: Stretch) -> Options:
    words = room_words(stretch.room.type, stretch.rng)
    space = definite(words)
    kind = stretch.room.type.replace("_", " ")
    return [
        (1.0, lambda: (_stop("Z6", "stop_end", Stop("end", space=kind), (words,), space=space),)),
        (0.6, lambda: (make.hallway(stretch.room, stretch.rng, end=True), _stop("Z7", "stop_here", Stop("here")))),
    ]
