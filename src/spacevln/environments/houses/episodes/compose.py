"""Saying a route in clauses: samples typed clauses along its legs; :mod:`.endings` says where to stop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from spacevln.core.geometry import wrap_angle
from spacevln.environments.houses.episodes import making as make
from spacevln.environments.houses.episodes.clauses import Clause, Cross
from spacevln.environments.houses.episodes.crossing import cross
from spacevln.environments.houses.episodes.endings import ending
from spacevln.environments.houses.episodes.nouns import (
    FLAT,
    category_of,
    is_landmark,
    is_plural,
    room_type_of,
    salience,
    thing_words,
)
from spacevln.environments.houses.episodes.reading import SIDE_LOW
from spacevln.environments.houses.episodes.routes import Route
from spacevln.environments.houses.episodes.stretch import CLEAR_TURN_RAD, Stretch
from spacevln.environments.houses.episodes.topology import Passed, Topology, is_hallway
from spacevln.environments.houses.plan import Item


def describe(topology: Topology, route: Route, rng: np.random.Generator, detail: float) -> tuple[Clause, ...] | None:
    """Clauses that say a route, or None when its end cannot be said.

    Args:
        topology: of the house.
        route: what to say.
        rng: draws everything.
        detail: 1.0 is R2R's usual amount; more names more turns, landmarks and attributes.
    """
    clauses: list[Clause] = []
    last = len(route.legs) - 1
    said: list[Clause] = []
    for index in range(len(route.legs)):
        stretch = Stretch(topology, route, index, rng, detail)
        if index < last:
            said = crossing_stretch(stretch, clauses)
            clauses += said
            continue
        final = ending(stretch, said)
        if final is None:
            return None
        named = {noun for clause in final for noun in clause.nouns}
        clauses += [c for c in approach(stretch) if not named & set(c.nouns)] + list(final)
    return joined(clauses, rng)


def crossing_stretch(stretch: Stretch, before: list[Clause]) -> list[Clause]:
    """The clauses of a leg through a portal; sometimes none, when the next words imply the crossing."""
    hidden = stretch.leg.portal is not None and stretch.leg.portal.kind == "opening"
    implied = 0.35 if hidden or (stretch.index == 0 and not is_hallway(stretch.room)) else 0.08
    merged = bool(stretch.index) and (not before or not any(isinstance(a, Cross) for a in before[-1].atoms))
    level = stretch.leg.portal is None or stretch.leg.portal.kind != "stairs"
    if level and not merged and stretch.rng.random() < implied / stretch.detail:
        return approach(stretch)[-1:] if stretch.chance(0.3) else []
    crossing = cross(stretch)
    return [*approach(stretch, turn_said=crossing.codes[0] in ("T3", "T5")), crossing]


def approach(stretch: Stretch, turn_said: bool = False) -> list[Clause]:
    """Turns, landmarks and spaces on the way through one room, before its end is said."""
    leg = stretch.leg
    timed: list[tuple[float, Clause]] = []
    first = entry_turn(stretch)
    if first is not None:
        timed.append((-1.0, first))
    if leg.length_m > 1.5:
        timed += middle(stretch, first is not None, first is not None and first.form == "turn_down")
    for s, angle in leg.turns:
        # a later bend needs something said before it, or it would be read as the turn at the start
        said = any(at < s for at, _ in timed) or abs(leg.first_turn_rad) < math.radians(20)
        if 0.0 < s < leg.length_m and abs(angle) > CLEAR_TURN_RAD and said and stretch.chance(0.45):
            timed.append((s, turn_clause(stretch, angle, s)))
    if (
        not turn_said
        and leg.portal is not None
        and leg.length_m > 1.6
        and abs(leg.exit_turn_rad) > CLEAR_TURN_RAD
        and abs(leg.exit_turn_rad) < math.radians(140)
        and (len(timed) > (first is not None))
        and stretch.chance(0.5)
    ):
        timed.append((leg.length_m, turn_clause(stretch, leg.exit_turn_rad, leg.length_m)))
    order = sorted(range(len(timed)), key=lambda k: (timed[k][0], k))
    return [timed[k][1] for k in order]


def entry_turn(stretch: Stretch) -> Clause | None:
    """How the leg begins: around, to a side, straight, or with something behind you."""
    angle = stretch.leg.first_turn_rad
    size = abs(angle)
    if stretch.leg.length_m < 0.8:
        return None
    if stretch.index == 0:
        if stretch.chance(0.035):
            oriented = orientation(stretch)
            if oriented is not None:
                return oriented
        if size > math.radians(125):
            return make.around(stretch.rng) if stretch.chance(0.32) else None
        if size > CLEAR_TURN_RAD and stretch.chance(0.28):
            return turn_clause(stretch, angle, 0.0)
    elif CLEAR_TURN_RAD < size < math.radians(150) and stretch.chance(0.43):
        return turn_clause(stretch, angle, 0.0)
    elif math.radians(28) < size < math.radians(48) and stretch.chance(0.15):
        return make.slight(angle, stretch.rng)
    if size < math.radians(25) and stretch.leg.length_m > 2.0 and stretch.chance(0.2):
        return make.straight(stretch.rng)
    return None


def turn_clause(stretch: Stretch, angle: float, s: float) -> Clause:
    """A turn: plain, as "take a left", sharp, or at a landmark within 1.6 m."""
    rng = stretch.rng
    k = min(round(s / 0.2), len(stretch.leg.points) - 1)
    near = [
        item
        for passed, item in stretch.landmarks()
        if abs(passed.s_m - s) < 1.2 and passed.distance_m < 1.5 and stretch.topology.seen(item, stretch.leg.points[: k + 1])
    ]
    options: list[tuple[float, Callable[[], Clause]]] = [
        (0.6, lambda: make.turn(angle)),
        (0.13, lambda: make.take_turn(angle)),
    ]
    if abs(angle) > math.radians(110):
        options.append((0.4, lambda: make.sharp(angle, rng)))
    if near:
        item = stretch.salient(near)
        options.append((0.12, lambda: make.turn_at(angle, stretch.thing(item), rng)))
    if is_hallway(stretch.room) and s == 0.0 and stretch.leg.length_m > 1.5:
        options.append((0.15, lambda: make.turn_down(angle, stretch.room, rng)))
    return stretch.pick(options)


def orientation(stretch: Stretch) -> Clause | None:
    """Which way to face, "with the bed behind you": something large seen from the start, relative to the first steps."""
    walk = float(stretch.leg.yaws[0])
    x, y = stretch.node.xy
    z_m = stretch.topology.house.floors[stretch.room.floor].z_m
    found = []
    for item in stretch.topology.house.items:
        if item.room != stretch.room.id or not is_landmark(item, z_m) or max(item.size) < 0.6:
            continue
        if not stretch.topology.seen(item, stretch.leg.points[:2]):
            continue
        bearing = wrap_angle(math.atan2(item.y - y, item.x - x) - walk)
        if abs(bearing) > math.radians(145):
            found.append((item, 2))
        elif abs(bearing) < math.radians(20):
            found.append((item, 3))
        elif math.radians(60) < abs(bearing) < math.radians(120):
            found.append((item, 1 if bearing > 0 else -1))
    if not found:
        return None
    item, side = found[int(stretch.rng.integers(len(found)))]
    return make.orient(stretch.thing(item), side)


def middle(stretch: Stretch, moved: bool, hall_said: bool) -> list[tuple[float, Clause]]:
    """Spaces and landmarks on the way through a room, with their arc positions."""
    leg, rng = stretch.leg, stretch.rng
    z_m = stretch.topology.house.floors[stretch.room.floor].z_m
    out: list[tuple[float, Clause]] = []
    if not hall_said and is_hallway(stretch.room) and leg.length_m > 1.8 and stretch.chance(0.32):
        ends = stretch.topology.hallway_ends(stretch.room.id)
        near_end = any(math.dist(leg.points[-1], end) < 1.3 for end, _ in ends)
        out.append((0.4, make.hallway(stretch.room, rng, end=near_end and stretch.chance(0.5))))
    elif not is_hallway(stretch.room) and stretch.index > 0 and leg.length_m > 2.2 and stretch.chance(0.3):
        out.append((0.4, make.through_space(stretch.room, rng)))
    seen = stretch.landmarks()
    if seen and stretch.chance(0.34):
        weights = np.array([salience(item) for _, item in seen])
        count = min(len(seen), 1 + stretch.chance(0.12))
        take = [seen[int(k)] for k in rng.choice(len(seen), count, replace=False, p=weights / weights.sum())]
        solid = [pair for pair in seen if pair[1].solid and pair[1].z - z_m < 0.1]
        pair = [(a, b) for a in solid for b in solid if a[0].side > 0 > b[0].side and abs(a[0].s_m - b[0].s_m) < 0.8]
        if pair and stretch.chance(0.08):
            (a, one), (b, two) = pair[int(rng.integers(len(pair)))]
            out.append((min(a.s_m, b.s_m), make.between(stretch.thing(one), stretch.thing(two))))
        else:
            out += [(passed.s_m, pass_clause(stretch, passed, item)) for passed, item in take]
    if not out and not moved and leg.length_m > 3.0 and abs(leg.first_turn_rad) < math.radians(25) and stretch.chance(0.15):
        out.append((0.3, make.straight(rng)))
    return out


def pass_clause(stretch: Stretch, passed: Passed, item: Item) -> Clause:
    """A landmark on the way: past, on a side, around, along, toward, straight past, or "there is"."""
    rng, thing = stretch.rng, stretch.thing(item)
    if category_of(item) in FLAT:
        return make.over(thing)
    options: list[tuple[float, Callable[[], Clause]]] = [
        (1.0, lambda: make.past(thing)),
        (0.14, lambda: make.toward(thing, rng)) if passed.distance_m < 1.5 else (1e-9, lambda: make.past(thing)),
    ]
    if abs(stretch.leg.first_turn_rad) < SIDE_LOW or passed.s_m > 2.0:
        options.append((0.45, lambda: make.straight_past(thing)))
    if passed.side:
        options += [
            (0.1, lambda: make.past_side(thing, passed.side)),
            (0.25 * item.solid, lambda: make.side_of(thing, -passed.side)),
            (0.0 if is_plural(thing_words(thing)) else 0.04, lambda: make.there_is(thing, passed.side)),
        ]
        if passed.distance_m < 0.9 and max(item.size[:2]) > 0.8 and item.solid:
            options += [(0.14, lambda: make.around_thing(thing)), (0.14, lambda: make.along_thing(thing))]
    return stretch.pick(options)


def joined(clauses: list[Clause], rng: np.random.Generator) -> tuple[Clause, ...]:
    """Rooms get one name each, and some clauses become events: "once you ..., ..." and "... until you ..."."""
    out = same_names(clauses)
    for k in range(len(out) - 1):
        a, b = out[k], out[k + 1]
        if a.form in make.ONCE_FORMS and not b.wrap and rng.random() < 0.07 and (k == 0 or not out[k - 1].wrap):
            out[k] = replace(a, wrap="once", codes=(*a.codes, "C1"))
        elif a.form in make.UNTIL_AFTER and b.form in make.UNTIL_FORMS and not a.wrap and rng.random() < 0.3:
            out[k + 1] = replace(b, wrap="until", codes=(*b.codes, "C2"))
    return tuple(out)


def same_names(clauses: list[Clause]) -> list[Clause]:
    """The clauses with one word for each type of room."""
    words: dict[str, str] = {}
    out = []
    for clause in clauses:
        slots = dict(clause.slots)
        nouns = list(clause.nouns)
        for name in ("space", "space2"):
            if name not in slots:
                continue
            old = slots[name].removeprefix("the ")
            new = words.setdefault(room_type_of(old), old)
            slots[name] = f"the {new}"
            nouns = [new if noun == old else noun for noun in nouns]
        out.append(replace(clause, slots=tuple(slots.items()), nouns=tuple(nouns)))
    return out
