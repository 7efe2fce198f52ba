"""Trails through the perceived world that agree best with an instruction.

A trail starts where the episode started and is a sequence of legs. Clauses are aligned with it monotonically: the vector of a
trail holds, for every number of clauses, the best score of having followed that many of them. A trail ends at a stop place (all
clauses followed), or where knowledge ends: an unexplored portal, the edge of the known floor, stairs. Those keep a hope for the
clauses that remain, so that unexplored hypotheses compete with complete ones.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from spacevln.language import Clause, ClauseType, NounKind
from spacevln.reasoning.rules.beliefs import Beliefs
from spacevln.reasoning.rules.grid import NOWHERE
from spacevln.reasoning.rules.legs import Leg, Node
from spacevln.reasoning.rules.matching import WEIGHT, Matcher, thing_fits
from spacevln.reasoning.rules.route import REACHED_BY, part_of_stairs
from spacevln.reasoning.rules.sightings import XY, Thing
from spacevln.reasoning.rules.world import World

T = ClauseType
SKIP = 0.8  # of a clause's weight, lost when it is not followed
HOPE = (0.35, 0.62)  # of a clause's weight, expected of what is not seen yet: with few steps left, with many
HOPE_STEPS = (50, 170)
LAST_STEPS = 45  # with fewer one stops where the landmark of the stop was not found
UNSEEN_STOP = 0.2  # of a stop's score where that landmark was not seen
BARE_STOP = 0.65  # of a stop's weight, where it names nothing
UNMENTIONED_CROSSING = 0.45
UNMENTIONED_TURN = 0.25
BIG_TURN_RAD = math.radians(60)
BEAM = 28
DEPTH = 8
SLACK_M = 1.0
LEG_COST_PER_M = 0.01
LIKELY = 0.8  # of a clause's weight, for a room that surely holds what it names
UNLIKELY_AT_MOST, LIKELY_AT_MOST = 0.4, 0.15  # what was not seen is never worth as much as what was
EDGE, EDGE_PER_M = 0.8, 0.3  # what the edge of the known floor is worth less than a way out, and more by its width
NO = -math.inf
APPROACH_M = 0.65
CLIMBED = -10  # and less: the node's "portal" is a flight of stairs

Vector = tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Trail:
    """Joined legs, the node they lead to, and how many clauses they follow at which score."""

    legs: tuple[Leg, ...]
    node: Node
    vector: Vector
    length_m: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """Where a trail leads.

    Args:
        trail: its legs, the last one included.
        value: score with hope and costs.
        goal: (x, y) to walk to, on ``floor``.
        complete: all clauses are followed and this is the stop place.
        followed: number of clauses followed at the goal.
        kind: ``"place"``, ``"portal"``, ``"frontier"`` or ``"stairs"``.
        thing: that the stop is told by.
    """

    trail: Trail
    value: float
    goal: XY
    floor: int
    complete: bool
    followed: int
    kind: str
    thing: Thing | None = None


def advance(
    vector: Vector, clauses: Sequence[Clause], leg: Leg, matcher: Matcher, first: bool, stop_score: float | None
) -> Vector:
    """The vector after a leg.

    Args:
        stop_score: of a final STOP fulfilled by the end of the leg; None on legs that go on.
    """
    count = len(clauses)
    states: list[list[tuple[float, float, int, int]]] = [[] for _ in range(count + 1)]
    for j, score in enumerate(vector):
        if score > NO:
            states[j].append((score, 0.0, 0, 0))
    for j in range(count):
        kept = sorted(states[j], key=lambda state: (-state[0], state[1]))[:4]
        states[j] = kept
        if not kept:
            continue
        clause = clauses[j]
        weight = WEIGHT[clause.type]
        if clause.type is T.STOP:
            if stop_score is not None:
                states[j + 1].extend((score + stop_score, leg.length_m, mask, turns) for score, _, mask, turns in kept)
            continue
        states[j + 1].extend((score - SKIP * weight, s, mask, turns) for score, s, mask, turns in kept)
        for option in matcher.options(clause, leg):
            for score, s, mask, turns in kept:
                used_up = mask & (option.crossing | option.bars) or (option.turn >= 0 and turns >> option.turn & 1)
                if option.s_m < s - SLACK_M or used_up:
                    continue
                used = turns | (1 << option.turn) if option.turn >= 0 else turns
                states[j + 1].append((score + option.score, max(s, option.s_m), mask | option.crossing, used))
    crossing = leg.kind in ("cross", "stairs")
    big = [i for i, (s, angle) in enumerate(leg.turns) if abs(angle) > BIG_TURN_RAD and not (first and s < 1e-6)]
    cost = LEG_COST_PER_M * leg.length_m
    out = []
    for j, options in enumerate(states):
        best = NO
        implied = crossing and j < count and matcher.goes_on_beyond(clauses[j], leg)
        for score, _, mask, turns in options:
            lost = UNMENTIONED_CROSSING if crossing and not mask and not implied else 0.0
            lost += UNMENTIONED_TURN * sum(1 for i in big if not turns >> i & 1)
            best = max(best, score - lost - cost)
        out.append(best)
    return tuple(out)


def worth(clause: Clause) -> float:
    """The best score that a clause can have."""
    return WEIGHT[clause.type] * (BARE_STOP if clause.type is T.STOP and clause.place is None else 1.0)


class Search:
    """Finds the hypotheses of an instruction in a world.

    Args:
        world: perceived.
        clauses: of the instruction; the last one is a STOP.
        steps_left: the fewer, the less the unseen is worth.
    """

    def __init__(self, world: World, clauses: Sequence[Clause], steps_left: int) -> None:
        self.world = world
        self.clauses = tuple(clauses)
        self.matcher = Matcher(world)
        self._looks_on = steps_left >= LAST_STEPS
        share = min(1.0, max(0.0, (steps_left - HOPE_STEPS[0]) / (HOPE_STEPS[1] - HOPE_STEPS[0])))
        hope = HOPE[0] + share * (HOPE[1] - HOPE[0])
        tail = [0.0]
        for clause in reversed(self.clauses):
            tail.append(tail[-1] + hope * worth(clause))
        self.tail = tail[::-1]
        self._beliefs: dict[str, Beliefs] = {}
        self._approach: dict[tuple[int, int], XY | None] = {}

    def run(self, start: Node) -> list[Hypothesis]:
        """Hypotheses, best first."""
        beam = [Trail((), start, (0.0, *(NO for _ in self.clauses)))]
        found: list[Hypothesis] = []
        for _ in range(DEPTH):
            following: list[Trail] = []
            for trail in beam:
                if trail.node.room == 0:
                    continue
                found.extend(self._ends(trail))
                found.extend(self._edges(trail))
                for onward in self._crossings(trail):
                    following.append(onward)
                    unknown = self._unknown_beyond(onward)
                    if unknown is not None:
                        found.append(unknown)
            beam = self._pruned(following)
            if not beam:
                break
        return sorted(found, key=lambda h: (-h.value, h.goal))

    def _pruned(self, trails: list[Trail]) -> list[Trail]:
        """The best trails, at most three per node."""
        per_node: dict[tuple[int, int], int] = {}
        kept = []
        for trail in sorted(trails, key=lambda t: -self._promise(t.vector)):
            key = (trail.node.portal, trail.node.side)
            per_node[key] = per_node.get(key, 0) + 1
            if per_node[key] <= 3:
                kept.append(trail)
        return kept[:BEAM]

    def _promise(self, vector: Vector) -> float:
        return max(score + hope for score, hope in zip(vector, self.tail, strict=True))

    def _followed(self, vector: Vector) -> int:
        return max(range(len(vector)), key=lambda j: (vector[j] + self.tail[j], j))

    def _step(self, trail: Trail, leg: Leg, node: Node, stop_score: float | None = None) -> Trail:
        vector = advance(trail.vector, self.clauses, leg, self.matcher, not trail.legs, stop_score)
        return Trail((*trail.legs, leg), node, vector, trail.length_m + leg.length_m)

    def _crossings(self, trail: Trail) -> Iterator[Trail]:
        node = trail.node
        used = {leg.portal.id for leg in trail.legs if leg.portal is not None}
        left_behind = {(leg.node.floor, leg.node.room) for leg in trail.legs} - {(node.floor, node.room)}
        for portal, side in self.world.portals_of(node.floor, node.room):
            if portal.id in used:
                continue
            leg = self.world.leg(node, portal.beside(side, 0.35), "cross", portal, side)
            beyond = self.world.across(portal, side)
            if leg is not None and (beyond.room == NOWHERE or (beyond.floor, beyond.room) not in left_behind):
                yield self._step(trail, leg, beyond)
        yield from self._climbs(trail)

    def _climbs(self, trail: Trail) -> Iterator[Trail]:
        """Stairs that were walked before lead to the other floor's node."""
        node = trail.node
        for number, link in enumerate(self.world.links):
            for floor, xy, other, other_xy, yaw in (
                (link.floor, link.xy, link.other_floor, link.other_xy, link.yaw_rad),
                (link.other_floor, link.other_xy, link.floor, link.xy, link.yaw_rad + math.pi),
            ):
                if floor != node.floor or node.portal == CLIMBED - number or self.world.room_at(floor, xy, 0.8) != node.room:
                    continue
                leg = self.world.leg(node, xy, "stairs", label="up" if other > floor else "down")
                if leg is not None:
                    room = self.world.room_at(other, other_xy, 0.8)
                    yield self._step(trail, leg, Node(other, room, other_xy, yaw, CLIMBED - number, int(other > floor)))

    def _unknown_beyond(self, trail: Trail) -> Hypothesis | None:
        """What a portal or its room may still hide."""
        node, portal = trail.node, trail.legs[-1].portal
        if portal is None:
            return None
        visited = (node.floor, node.room) in self.world.visited_rooms
        if node.room and visited:
            return None
        j = self._followed(trail.vector)
        value = trail.vector[j] + self.tail[j] - (0.1 if node.room else 0.0)
        value += self._likely(j, node.floor, node.room, self.world.portal_rooms[portal.id][trail.legs[-1].side])
        side = trail.legs[-1].side
        goal = next(
            (xy for reach in (1.2, 1.0, 0.8, 0.6) if self.world.room_at(node.floor, xy := portal.beside(1 - side, reach), 0.1)),
            portal.beside(1 - side, 0.7),
        )
        return Hypothesis(trail, value, goal, node.floor, False, j, "portal")

    def _likely(self, followed: int, floor: int, room: int, before: int) -> float:
        """How much more a room promises than any other, when the next thing to come to is of a kind met in some rooms only."""
        if floor != self.world.floor:
            return 0.0
        coming = next(
            (clause for clause in self.clauses[followed:] if clause.type not in (T.TURN, T.STRAIGHT, T.TURN_AROUND)), None
        )
        if coming is None or coming.place is None or coming.place.kind is not NounKind.OBJECT:
            return 0.0
        name = coming.place.head
        if name not in self._beliefs:
            self._beliefs[name] = Beliefs(self.world, name)
        beliefs = self._beliefs[name]
        more = beliefs.holds(room, before) - beliefs.holds(NOWHERE)
        return WEIGHT[coming.type] * min(max(LIKELY * more, -UNLIKELY_AT_MOST), LIKELY_AT_MOST)

    def _edges(self, trail: Trail) -> Iterator[Hypothesis]:
        """Edges of the known floor in the room of a node, and unclimbed stairs."""
        node = trail.node
        for frontier in self.world.frontiers_of(node.floor, node.room):
            leg = self.world.leg(
                node, frontier.position_m, "frontier", label=f"{frontier.position_m[0]:.1f},{frontier.position_m[1]:.1f}"
            )
            if leg is None:
                continue
            onward = self._step(trail, leg, node)
            j = self._followed(onward.vector)
            value = onward.vector[j] + self.tail[j] - EDGE + EDGE_PER_M * min(1.5, frontier.width_m)
            value += self._likely(j, node.floor, node.room, NOWHERE)
            yield Hypothesis(onward, value, frontier.position_m, node.floor, False, j, "frontier")
        for stairs in self.world.stairs_of(node.floor, node.room):
            flight = self.world.flights.get(stairs.id)
            if self.world.climbed(flight.entry if flight else stairs.xy):
                continue
            goal = flight.entry if flight else self.world.sight_of(stairs, node.room)
            leg = self.world.leg(node, goal, "stairs", thing=stairs, label=self.world.leads(stairs)) if goal else None
            if leg is not None and goal is not None:
                onward = self._step(trail, leg, node)
                j = self._followed(onward.vector)
                yield Hypothesis(onward, onward.vector[j] + self.tail[j] - 0.1, goal, node.floor, False, j, "stairs", stairs)

    def _ends(self, trail: Trail) -> Iterator[Hypothesis]:
        """Complete hypotheses: stop places in the room of a node."""
        if trail.vector[-2] == NO and max(trail.vector) == NO:
            return
        for goal, score, thing, label in self._places(trail.node):
            leg = self.world.leg(trail.node, goal, "place", thing=thing, label=label)
            if leg is None:
                continue
            ended = self._step(trail, leg, trail.node, score)
            if ended.vector[-1] > NO:
                yield Hypothesis(ended, ended.vector[-1], goal, trail.node.floor, True, len(self.clauses), "place", thing)

    def _places(self, node: Node) -> Iterator[tuple[XY, float, Thing | None, str]]:
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

    def _beside_things(self, node: Node, weight: float) -> Iterator[tuple[XY, float, Thing | None, str]]:
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

    def _at_portals(self, node: Node, weight: float) -> Iterator[tuple[XY, float, Thing | None, str]]:
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
            fits = self.matcher.portal_fits(phrase, portal, leg)
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
