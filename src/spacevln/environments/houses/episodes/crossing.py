"""Saying that one walks through a doorway, an opening or up the stairs."""

from __future__ import annotations

import math
from collections.abc import Callable

from spacevln.core.geometry import wrap_angle
from spacevln.environments.houses.episodes import making as make
from spacevln.environments.houses.episodes.clauses import Clause
from spacevln.environments.houses.episodes.reading import travel_yaw
from spacevln.environments.houses.episodes.stretch import CLEAR_TURN_RAD, Stretch
from spacevln.environments.houses.episodes.topology import is_hallway


def cross(stretch: Stretch) -> Clause:
    """Walking through the portal at the end of a leg, in one of the ways in which people say it."""
    leg, rng = stretch.leg, stretch.rng
    portal, there = leg.portal, stretch.next_room
    if portal is None or there is None:
        raise ValueError("a stretch without a portal has no crossing")
    if portal.kind == "stairs":
        return make.stairs(1 if portal.rooms[0] == stretch.room.id else -1, rng)
    here = stretch.room
    leaving = stretch.index == 0 or not is_hallway(here)
    options: list[tuple[float, Callable[[], Clause]]] = [
        (0.6 if not is_hallway(there) else 0.2, lambda: make.enter(there, rng)),
        (0.3, lambda: make.through_door(portal, rng, stretch.chance(0.25))),
        (0.16, lambda: make.go_to_space(there, rng)),
    ]
    if leaving and not is_hallway(here):
        weight = 1.1 if stretch.index == 0 else 0.2
        options += [
            (weight, lambda: make.leave(here, rng)),
            (weight * 0.16, lambda: make.leave_through(here, portal, rng)),
            (weight * 0.1, lambda: make.leave_into(here, there, rng)),
        ]
    if abs(leg.first_turn_rad) < math.radians(30) and abs(leg.exit_turn_rad) < math.radians(35):
        options.append((0.45, lambda: make.straight_through(portal, rng)))
        options.append((0.4, lambda: make.straight_into(there, rng)))
    turned = leg.exit_turn_rad if leg.length_m > 1.1 else leg.first_turn_rad
    if CLEAR_TURN_RAD < abs(turned) < math.radians(140):
        options.append((0.12, lambda: make.turn_into(turned, there, rng)))
    options += sided(stretch, turned)
    return stretch.pick(options)


def sided(stretch: Stretch, turned: float) -> list[tuple[float, Callable[[], Clause]]]:
    """Crossings that name a side or an ordinal."""
    leg, rng = stretch.leg, stretch.rng
    portal, there = leg.portal, stretch.next_room
    if portal is None or there is None:
        return []
    options: list[tuple[float, Callable[[], Clause]]] = []
    travel = travel_yaw(leg, stretch.node)
    counted = stretch.topology.ordinals(stretch.node, portal, travel)
    said = abs(stretch.leg.first_turn_rad) > CLEAR_TURN_RAD
    bearing = math.atan2(portal.centre[1] - stretch.node.xy[1], portal.centre[0] - stretch.node.xy[0]) - stretch.node.yaw_rad
    bearing = wrap_angle(bearing)
    side = 0
    if abs(turned) > CLEAR_TURN_RAD and leg.length_m > 1.1:
        side = 1 if turned > 0 else -1
    if stretch.index and not said and math.radians(30) < abs(bearing) < math.radians(110) and (not side or side * bearing > 0):
        side = 1 if bearing > 0 else -1
    if side and stretch.index:
        options += [(0.3, lambda: make.door_on_side(portal, side, rng)), (0.25, lambda: make.room_on_side(there, side, rng))]
    if counted is not None and is_hallway(stretch.room) and leg.length_m > 1.1:
        sign, ordinal = counted
        if ordinal <= 3:
            options += [
                (0.4, lambda: make.ordinal_door(portal, sign, ordinal, rng)),
                (0.2, lambda: make.ordinal_turn(sign, ordinal)),
            ]
    if not is_hallway(there) and stretch.index and there.type != "balcony":
        options.append((0.12, lambda: make.next_room()))
    return options
