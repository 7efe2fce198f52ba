"""Where a STOP may be meant: places of a room, each with the score of stopping there and what tells it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from spacevln.language import Clause, ClauseType, NounKind
from spacevln.reasoning.rules.alignment import BARE_STOP
from spacevln.reasoning.rules.legs import CLIMBED, Node
from spacevln.reasoning.rules.matching import WEIGHT, Matcher, thing_fits
from spacevln.reasoning.rules.route import REACHED_BY, part_of_stairs
from spacevln.reasoning.rules.sightings import XY, Thing
from spacevln.reasoning.rules.world import World

T = ClauseType
UNSEEN_STOP = 0.2  # of a stop's score where its landmark was not seen
APPROACH_M = 0.65

Place = tuple[XY, float, Thing | None, str]  # where, score of the STOP, what tells it, label of the leg


class StopPlaces:
    """Finds the stop places of an instruction in a world.

    Args:
        world: perceived.
        clauses: of the instruction; the last one is the STOP.
        matcher: judges thresholds.
        looks_on: steps are left to look for the landmark of the stop.
    """

    def __init__(self, world: World, clauses: Sequence[Clause], matcher: Matcher, looks_on: bool) -> None:
        self.world, self.clauses, self.matcher = world, clauses, matcher
        self._looks_on = looks_on
        self._approach: dict[tuple[int, int], XY | None] = {}

    def of(self, node: Node) -> Iterator[Place]:
        """(goal, score of the STOP, thing, label) of every stop place in a node's room."""
        stop = self.clauses[-1]
        weight = WEIGHT[T.STOP]
        phrase = stop.place
        bare = phrase is None
        if phrase is None:
            last = next(
                (c for c in reversed(self.clauses[:-1]) if c.type not in (T.TURN, T.NOTICE, T.STRAIGHT, T.TURN_AROUND, T.ORIENT)),
                None,
            )
            phrase = last.place if last is not None and last.type not in (T.ENTER, T.LEAVE) else None
            missing = phrase is not None and phrase.kind is NounKind.OBJECT and self._looks_on
            yield self.inside(node), BARE_STOP * weight * (UNSEEN_STOP if missing else 1.0), None, "inside"
        share = BARE_STOP if bare else 1.0
        if phrase is None:
            return
        if phrase.part in ("end", "far end", "other end") or (bare and phrase.kind is NounKind.REGION):
            agree = self.world.compatible(phrase.head, node.floor, node.room) if phrase.kind is NounKind.REGION else 0.0
            yield self.far_end(node), weight * share * (0.7 + 0.3 * agree), None, "end"
        elif phrase.kind in (NounKind.OBJECT, NounKind.STAIRS, NounKind.PART):
            yield from self._beside_things(node, weight * share)
        elif phrase.kind is NounKind.OPENING or stop.relation in ("outside", "before", "in front of"):
            yield from self._at_portals(node, weight * share)
        else:
            agree = self.world.compatible(phrase.head, node.floor, node.room) if phrase.kind is NounKind.REGION else 0.3
            yield self.inside(node), weight * (0.55 + 0.45 * agree if agree >= 0 else 0.55 + 1.3 * agree), None, "inside"

    def _beside_things(self, node: Node, weight: float) -> Iterator[Place]:
        stop = self.clauses[-1]
        phrase = stop.place or next(c.place for c in reversed(self.clauses) if c.place is not None)
        part = part_of_stairs(phrase)
        if part and node.portal <= CLIMBED:
            yield node.xy, weight, None, "landing"
        for thing in self.world.things_of(node.floor, node.room):
            value = thing_fits(phrase, thing)
            if not value:
                continue
            flight = self.world.flights.get(thing.id)
            if part and self.world.leads(thing) == REACHED_BY[part]:
                continue  # that is its other end
            second = phrase.also or (phrase.of if phrase.of is not None and phrase.of.kind is NounKind.OBJECT else None)
            if second is not None:
                near = any(
                    thing_fits(second, other) and math.dist(other.xy, thing.xy) < 2.5
                    for other in self.world.things_of(node.floor, node.room)
                    if other.id != thing.id
                )
                value *= 1.0 if near else 0.6
            goal = self.approach(thing, node) if flight is None else flight.entry
            if goal is not None:
                yield goal, weight * value, None if part else thing, ""

    def _at_portals(self, node: Node, weight: float) -> Iterator[Place]:
        """Thresholds that a stop may mean: those of the room, and the one just walked through."""
        stop = self.clauses[-1]
        phrase = stop.place or next(c.place for c in reversed(self.clauses) if c.place is not None)
        for portal, side in self.world.portals_of(node.floor, node.room):
            beyond = self.world.portal_rooms[portal.id][1 - side]
            agree = self.world.compatible(phrase.region, node.floor, beyond) if phrase.region else 0.0
            just_used = portal.id == node.portal
            if just_used and phrase.region:
                agree = max(agree, self.world.compatible(phrase.region, node.floor, node.room))
            goal = portal.beside(side, 0.3)
            leg = self.world.leg(node, goal, "cross", portal, side)
            if leg is None:
                continue
            fits = self.matcher.thresholds.fits(phrase, portal, leg)
            score = 0.75 + 0.25 * agree if not phrase.region or agree > 0 else 0.4 + agree
            yield goal, weight * score * fits * (0.9 if just_used else 1.0), None, f"portal {portal.id}"

    def inside(self, node: Node) -> XY:
        """A metre inside a room."""
        for reach in (0.8, 0.5, 0.3, 0.0):
            xy = (node.xy[0] + reach * math.cos(node.yaw_rad), node.xy[1] + reach * math.sin(node.yaw_rad))
            if self.world.grids[node.floor].room_at(xy, 0.01) == node.room:
                return xy
        return node.xy

    def far_end(self, node: Node) -> XY:
        """The end of a room for someone who walks on from a node."""
        grid = self.world.grids[node.floor]
        centres = grid.centres(node.room)
        clear = np.array([grid.clearance_m[grid.cell((float(x), float(y)))] for x, y in centres])
        ahead = (centres - np.array(node.xy)) @ np.array([math.cos(node.yaw_rad), math.sin(node.yaw_rad)])
        distance = np.hypot(*(centres - np.array(node.xy)).T)
        best = int(np.argmax(np.where(clear >= 0.3, distance + 0.3 * ahead, -1.0)))
        return float(centres[best, 0]), float(centres[best, 1])

    def approach(self, thing: Thing, node: Node) -> XY | None:
        """A free place near a thing's seen surface, on the way from the node."""
        key = (thing.id, node.room)
        if key not in self._approach:
            self._approach[key] = approach_point(self.world, thing, node.floor, node.room, node.xy)
        return self._approach[key]


def approach_point(world: World, thing: Thing, floor: int, room: int, toward: XY) -> XY | None:
    """A free cell of a room about 0.65 m from a thing's seen surface; None when none lies within 1.6 m."""
    grid = world.grids[floor]
    centres = grid.centres(room)
    near = centres[np.hypot(*(centres - np.array(thing.xy)).T) < 1.8 + thing.extent_m]
    if not len(near):
        return None
    distance = thing.distance_m(near)
    clear = np.array([grid.clearance_m[grid.cell((float(x), float(y)))] for x, y in near])
    cost = np.abs(distance - APPROACH_M) + 0.06 * np.hypot(*(near - np.array(toward)).T) + np.where(clear < 0.2, 0.6, 0.0)
    best = int(np.argmin(cost))
    return (float(near[best, 0]), float(near[best, 1])) if distance[best] < 1.6 else None
