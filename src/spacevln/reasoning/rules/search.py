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

from spacevln.language import Clause, ClauseType, NounKind
from spacevln.reasoning.rules.alignment import NO, Vector, advance, worth
from spacevln.reasoning.rules.beliefs import Beliefs
from spacevln.reasoning.rules.grid import NOWHERE
from spacevln.reasoning.rules.legs import CLIMBED, Leg, Node
from spacevln.reasoning.rules.matching import WEIGHT, Matcher
from spacevln.reasoning.rules.sightings import XY, Thing
from spacevln.reasoning.rules.stop_places import StopPlaces
from spacevln.reasoning.rules.world import World

T = ClauseType
HOPE = (0.35, 0.62)  # of a clause's weight, expected of what is not seen yet: with few steps left, with many
HOPE_STEPS = (50, 170)
LAST_STEPS = 45  # with fewer one stops where the landmark of the stop was not found
BEAM = 28
DEPTH = 8
LIKELY = 0.8  # of a clause's weight, for a room that surely holds what it names
UNLIKELY_AT_MOST, LIKELY_AT_MOST = 0.4, 0.15  # what was not seen is never worth as much as what was
EDGE, EDGE_PER_M = 0.8, 0.3  # what the edge of the known floor is worth less than a way out, and more by its width


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
        self._stops = StopPlaces(world, self.clauses, self.matcher, steps_left >= LAST_STEPS)
        share = min(1.0, max(0.0, (steps_left - HOPE_STEPS[0]) / (HOPE_STEPS[1] - HOPE_STEPS[0])))
        hope = HOPE[0] + share * (HOPE[1] - HOPE[0])
        tail = [0.0]
        for clause in reversed(self.clauses):
            tail.append(tail[-1] + hope * worth(clause))
        self.tail = tail[::-1]
        self._beliefs: dict[str, Beliefs] = {}

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
        for goal, score, thing, label in self._stops.of(trail.node):
            leg = self.world.leg(trail.node, goal, "place", thing=thing, label=label)
            if leg is None:
                continue
            ended = self._step(trail, leg, trail.node, score)
            if ended.vector[-1] > NO:
                yield Hypothesis(ended, ended.vector[-1], goal, trail.node.floor, True, len(self.clauses), "place", thing)
