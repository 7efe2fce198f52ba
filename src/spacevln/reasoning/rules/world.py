"""The perceived world: rooms of known floor joined by portals, with what was seen in them. Never ground truth.

A room's type is inferred from the things in it (``language.region_scores``) and from its shape; the simulator's room labels
do not reach this far.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from spacevln.core import Frontier, Pose, SpatialMap
from spacevln.language import REGION_CUES, region_scores
from spacevln.language.nouns_lexicon import STAIRS
from spacevln.reasoning.rules.flights import Flight, flight_of, leads_of, open_end
from spacevln.reasoning.rules.grid import NOWHERE, FloorGrid
from spacevln.reasoning.rules.legs import Leg, Node, make_leg
from spacevln.reasoning.rules.sightings import XY, Portal, Sightings, Thing

FLOOR_HEIGHT_M = 1.5
SIDE_REACHES_M = (0.35, 0.5, 0.65, 0.8, 0.25)
HALLWAY_BREADTH_M = 2.6
LEAST_FRONTIER_M = 0.5
ENTRY_WITHIN_M = 0.6
CLIMBED_M = 1.5
LOOK_AT_M = (0.6, 2.2)  # from a flight
LOOK_AGAIN_M = 1.2
LOW_END_M = 3.0  # of detour, that a metre less height at a flight's end is worth
LOOKED_AT_M = 1.1  # an edge this near to an earlier look-around hides nothing more
RELATED = {
    "patio": ("balcony",),
    "balcony": ("patio",),
    "lobby": ("hallway",),
    "hallway": ("lobby", "mudroom"),
    "closet": ("dressing room", "storage"),
    "dressing room": ("closet",),
    "storage": ("closet", "pantry", "garage"),
    "library": ("office",),
    "office": ("library", "studio"),
    "studio": ("office",),
    "media room": ("living room",),
    "pantry": ("kitchen", "storage"),
    "mudroom": ("hallway",),
    "attic": ("storage",),
}


@dataclass(frozen=True, slots=True)
class Link:
    """A flight of stairs that was walked: where it was left and where it ended."""

    floor: int
    xy: XY
    other_floor: int
    other_xy: XY
    yaw_rad: float


class World:
    """One planning boundary's picture of everything known.

    Args:
        sightings: things and portals so far.
        grids: known floor by storey.
        frontiers: of the current storey.
        floor: current storey.
        links: stairs walked so far.
        levels: height of the storeys where the body stood [m].
        visited: places of earlier boundaries, (floor, xy).
    """

    def __init__(
        self,
        sightings: Sightings,
        grids: dict[int, FloorGrid],
        frontiers: Sequence[Frontier],
        floor: int,
        links: Sequence[Link],
        levels: Mapping[int, float],
        visited: Sequence[tuple[int, XY]],
    ) -> None:
        self.sightings = sightings
        self.grids = grids
        self.frontiers = tuple(f for f in frontiers if f.width_m >= LEAST_FRONTIER_M and not _looked_at(f, floor, visited))
        self.floor = floor
        self.links = tuple(links)
        self.levels = levels
        self.visited = tuple(visited)
        self.visited_rooms = {(f, grids[f].room_at(xy)) for f, xy in visited if f in grids}
        self._scores: dict[tuple[int, int], dict[str, float]] = {}
        self._sights: dict[tuple[int, int], XY | None] = {}
        self._legs: dict[tuple[object, ...], Leg | None] = {}

    def room_at(self, floor: int, xy: XY, within_m: float = 0.5) -> int:
        """Room of a point; 0 when unknown."""
        return self.grids[floor].room_at(xy, within_m) if floor in self.grids else NOWHERE

    @cached_property
    def room_of_thing(self) -> dict[int, tuple[int, int]]:
        """(floor, room) of every thing."""
        return {t.id: (t.floor, self.room_at(t.floor, t.front, 0.7)) for t in self.sightings.things}

    @cached_property
    def portal_rooms(self) -> dict[int, tuple[int, int]]:
        """Rooms on the two sides of every portal; 0 where unknown."""
        out = {}
        for portal in self.sightings.portals:
            sides = []
            for side in (0, 1):
                rooms = (self.room_at(portal.floor, portal.beside(side, reach), 0.2) for reach in SIDE_REACHES_M)
                sides.append(next((room for room in rooms if room), NOWHERE))
            out[portal.id] = (sides[0], sides[1])
        return out

    def portals_of(self, floor: int, room: int) -> list[tuple[Portal, int]]:
        """Portals of a room with the side that lies in it."""
        found = []
        for portal in self.sightings.portals:
            if portal.floor == floor:
                for side in (0, 1):
                    if self.portal_rooms[portal.id][side] == room:
                        found.append((portal, side))
                        if self.portal_rooms[portal.id][1 - side] == room:
                            found.append((portal, 1 - side))
                        break
        return found

    def things_of(self, floor: int, room: int) -> list[Thing]:
        """Things seen in a room."""
        return [thing for thing in self.sightings.things if self.room_of_thing[thing.id] == (floor, room)]

    @cached_property
    def flights(self) -> dict[int, Flight]:
        """What is known of the flights of stairs that were seen, by the number of the thing."""
        flights = {}
        for thing in self._stairs:
            if thing.floor in self.levels:
                flight = flight_of(thing, self.levels[thing.floor], self.sightings.square_rad)
                if flight is not None:
                    flights[thing.id] = flight
        return flights

    def flights_on(self, floor: int) -> list[Flight]:
        """The flights that lead away from a storey."""
        return [self.flights[thing.id] for thing in self.stairs_on(floor) if thing.id in self.flights]

    def leads(self, stairs: Thing) -> str:
        """Whether stairs lead ``"up"`` or ``"down"`` from their storey; ``""`` when that was not seen."""
        return self._leads.get(stairs.id, "")

    @cached_property
    def _leads(self) -> dict[int, str]:
        return {thing.id: leads_of(thing, self.levels[thing.floor]) for thing in self._stairs if thing.floor in self.levels}

    @cached_property
    def _stairs(self) -> list[Thing]:
        return [thing for thing in self.sightings.things if thing.category in STAIRS]

    def leads_from(self, floor: int) -> set[str]:
        """Where stairs lead from a storey, as far as they were seen or walked: "up", "down"."""
        walked = {(link.floor, link.other_floor) for link in self.links} | {(link.other_floor, link.floor) for link in self.links}
        return {leads for thing in self.stairs_on(floor) if (leads := self.leads(thing))} | {
            "up" if b > a else "down" for a, b in walked if a == floor
        }

    def stairs_of(self, floor: int, room: int) -> list[Thing]:
        """Flights of stairs that are entered from a room; without a known entry, those seen in it."""
        found = []
        for thing in self.stairs_on(floor):
            flight = self.flights.get(thing.id)
            at = self.room_of_thing[thing.id][1] if flight is None else self.room_at(floor, flight.entry, ENTRY_WITHIN_M)
            if at == room:
                found.append(thing)
        return found

    def stairs_on(self, floor: int) -> list[Thing]:
        """Flights of stairs seen on a storey."""
        return [thing for thing in self._stairs if thing.floor == floor]

    def sight_of(self, stairs: Thing, room: int) -> XY | None:
        """A place of a room from which the steps of stairs may be seen; None when there is none, or all were looked from."""
        key = (stairs.id, room)
        if key not in self._sights:
            self._sights[key] = self._railing_end(stairs) or self._beside(stairs, room)
        return self._sights[key]

    def _railing_end(self, stairs: Thing) -> XY | None:
        """Where a railing opens to the steps, unless one looked there already."""
        end = open_end(stairs, self.levels[stairs.floor], self.sightings.square_rad) if stairs.floor in self.levels else None
        seen = end is not None and any(f == stairs.floor and math.dist(xy, end) < ENTRY_WITHIN_M for f, xy in self.visited)
        return None if seen else end

    def climbed(self, xy: XY) -> bool:
        """Whether a place belongs to stairs that were walked."""
        return any(_off_segment(xy, link.xy, link.other_xy) < CLIMBED_M for link in self.links)

    def _beside(self, stairs: Thing, room: int) -> XY | None:
        """A place beside the stairs, to their low end, away from earlier looks."""
        if room == NOWHERE:
            return None
        grid = self.grids[stairs.floor]
        centres = grid.centres(room)
        distance = stairs.distance_m(centres)
        fit = (distance > LOOK_AT_M[0]) & (distance < LOOK_AT_M[1])
        for floor, xy in self.visited:
            if floor == stairs.floor:
                fit &= np.hypot(*(centres - np.array(xy)).T) > LOOK_AGAIN_M
        if not fit.any():
            return None
        relief = np.array(stairs.relief).reshape(-1, 6)
        here = np.array(self.visited[-1][1]) if self.visited else centres[0]
        cost = np.hypot(*(centres[fit] - here).T)
        if len(relief):
            nearest = cKDTree(relief[:, :2]).query(centres[fit], k=min(12, len(relief)))[1]
            cost = cost + LOW_END_M * relief[nearest.reshape(len(cost), -1), 2].mean(axis=1)
        x, y = centres[fit][int(np.argmin(cost))]
        return float(x), float(y)

    def frontiers_of(self, floor: int, room: int) -> list[Frontier]:
        """Edges of the known floor that belong to a room of the current storey."""
        if floor != self.floor:
            return []
        return [f for f in self.frontiers if math.isfinite(f.geodesic_m) and self.room_at(floor, f.position_m, 0.6) == room]

    def scores(self, floor: int, room: int) -> dict[str, float]:
        """Evidence for each region type of a room, hallways from its shape included."""
        key = (floor, room)
        if key not in self._scores:
            if not room:
                self._scores[key] = {}
            else:
                scores = region_scores([(thing.category, 1.0) for thing in self.things_of(floor, room)])
                grid = self.grids[floor]
                breadth = grid.breadth_m(room)
                strongest = max(scores.values(), default=0.0)
                doors = len(self.portals_of(floor, room))
                if (breadth < HALLWAY_BREADTH_M and (floor, room) in self.visited_rooms) or doors >= 3:
                    narrow = 1.5 if breadth < HALLWAY_BREADTH_M else 0.5
                    scores["hallway"] = scores.get("hallway", 0.0) + max(0.0, narrow * min(doors, 4) / 2 - 0.4 * strongest)
                self._scores[key] = scores
        return self._scores[key]

    def region(self, floor: int, room: int) -> str:
        """Best region type of a room, ``""`` without evidence."""
        scores = self.scores(floor, room)
        best = max(scores, key=lambda name: (scores[name], name), default="")
        return best if best and scores[best] >= 1.0 else ""

    def compatible(self, region: str, floor: int, room: int) -> float:
        """How well a room agrees with a region type: 1 surely, 0 unknown, -1 surely another."""
        if not region:
            return 0.0
        scores = self.scores(floor, room)
        strongest = max(scores.values(), default=0.0)
        own = max(scores.get(name, 0.0) for name in (region, *RELATED.get(region, ())))
        if strongest < 1.0:
            return 0.0
        if own >= 0.55 * strongest:
            return min(1.0, 0.5 + own / 8.0)
        known = region in REGION_CUES or region == "hallway"
        return (own - strongest) / max(strongest, 5.0) if known else -0.3

    def leg(
        self,
        node: Node,
        goal: XY,
        kind: str,
        portal: Portal | None = None,
        side: int = 0,
        thing: Thing | None = None,
        label: str = "",
    ) -> Leg | None:
        """The leg from a node to a place of its room, cached."""
        key = (
            node.portal,
            node.side,
            node.floor,
            node.room,
            kind,
            portal.id if portal else -1,
            side,
            thing.id if thing else -1,
            round(goal[0], 1),
            round(goal[1], 1),
        )
        if key not in self._legs:
            points = self.grids[node.floor].walk(node.room, node.xy, goal) if node.room else None
            self._legs[key] = None if points is None else make_leg(node, points, kind, portal, side, thing, label)
        return self._legs[key]

    def across(self, portal: Portal, side: int) -> Node:
        """Just beyond a portal for someone who comes from ``side``."""
        room = self.portal_rooms[portal.id][1 - side]
        return Node(portal.floor, room, portal.beside(1 - side, 0.45), portal.normal_rad(side), portal.id, 1 - side)


def _off_segment(xy: XY, a: XY, b: XY) -> float:
    """Distance of a point from the segment between two others."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = ((xy[0] - a[0]) * dx + (xy[1] - a[1]) * dy) / max(dx * dx + dy * dy, 1e-9)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(xy[0] - a[0] - t * dx, xy[1] - a[1] - t * dy)


def _looked_at(frontier: Frontier, floor: int, visited: Sequence[tuple[int, XY]]) -> bool:
    return any(f == floor and math.dist(frontier.position_m, xy) < LOOKED_AT_M for f, xy in visited)


def known_points(
    sightings: Sightings, pose: Pose, visited: Sequence[tuple[int, XY]], frontiers: Sequence[Frontier], floor: int
) -> np.ndarray:
    """Places (N, 2) that bound the known part of a storey."""
    things, portals = sightings.on(floor)
    points = [thing.xy for thing in things] + [portal.xy for portal in portals] + [xy for f, xy in visited if f == floor]
    points += [f.position_m for f in frontiers] + [(pose.x_m, pose.y_m)]
    return np.array(points, dtype=np.float64)


def build_grid(
    space: SpatialMap,
    sightings: Sightings,
    pose: Pose,
    visited: Sequence[tuple[int, XY]],
    frontiers: Sequence[Frontier],
    floor: int,
) -> FloorGrid:
    """The grid of the storey that the map shows now."""
    trodden = [xy for f, xy in visited if f == floor]
    return FloorGrid(space, known_points(sightings, pose, visited, frontiers, floor), sightings.on(floor)[1], trodden)
