"""Evaluates atoms, the meaning of clauses, on walks through a house."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from spacevln.core.geometry import wrap_angle
from spacevln.environments.houses.episodes.bends import STEP_M
from spacevln.environments.houses.episodes.clauses import ANY_ROOM, Along, Atom, Between, Pass, See, Straight, Thing, Toward, Turn
from spacevln.environments.houses.episodes.item_geometry import surface_distance
from spacevln.environments.houses.episodes.topology import PASS_M, SEE_M, Leg, Node, Topology
from spacevln.environments.houses.plan import Item

SIDE_LOW, SIDE_HIGH = math.radians(20), math.radians(165)
STRAIGHT_RAD = math.radians(55)
AROUND_RAD = math.radians(95)
SLACK_M = 1.0
SOON_M = 2.2


@dataclass(frozen=True)
class Trail:
    """Joined legs with arc positions counted from the first."""

    legs: tuple[Leg, ...]
    start_yaw: float

    @property
    def offsets(self) -> tuple[float, ...]:
        """Arc position at which each leg begins."""
        out, s = [], 0.0
        for leg in self.legs:
            out.append(s)
            s += leg.length_m + (leg.portal.length_m if leg.portal else 0.0)
        return tuple(out)

    @property
    def length_m(self) -> float:
        """Arc length up to the last portal or place."""
        return self.offsets[-1] + self.legs[-1].length_m

    def turns(self) -> Iterator[tuple[float, float]]:
        """(arc position, angle) of every bend."""
        for offset, leg in zip(self.offsets, self.legs, strict=True):
            for s, angle in leg.turns:
                yield offset + s, angle

    def at(self, s: float) -> tuple[Leg, int]:
        """The leg and its point index at an arc position."""
        k = max(i for i, offset in enumerate(self.offsets) if offset <= s + 1e-9)
        leg = self.legs[k]
        return leg, min(round((s - self.offsets[k]) / STEP_M), len(leg.points) - 1)


def side_fits(side: int, angle: float, degree: str = "") -> bool:
    """Whether a person may call a bend a turn to the side (+1 left, -1 right, 0 around)."""
    if side == 0:
        return abs(angle) > AROUND_RAD
    low, high = (math.radians(8), math.radians(75)) if degree == "slight" else (SIDE_LOW, SIDE_HIGH)
    return low < angle * side < high


class Reader:
    """Evaluates atoms on trails of one house."""

    def __init__(self, topology: Topology) -> None:
        self.topology = topology
        self._matching: dict[Thing, tuple[Item, ...]] = {}

    def matching(self, thing: Thing) -> tuple[Item, ...]:
        """Every item that a noun phrase fits."""
        if thing not in self._matching:
            self._matching[thing] = tuple(item for item in self.topology.house.items if thing.matches(item))
        return self._matching[thing]

    def walk(self, trail: Trail, atoms: Sequence[Atom]) -> float | None:
        """Arc position after all atoms held in order along the trail, or None when one does not."""
        s, moved, heading = 0.0, False, trail.start_yaw
        for atom in atoms:
            nxt = self._turn(trail, atom, s, moved, heading) if isinstance(atom, Turn) else self._step(trail, atom, s, moved)
            if nxt is None:
                return None
            moved = moved or not isinstance(atom, (Turn, See))
            s = max(s, nxt)
        return s

    def _turn(self, trail: Trail, turn: Turn, s: float, moved: bool, heading: float) -> float | None:
        del heading
        for at, angle in trail.turns():
            if at < s - SLACK_M or not side_fits(turn.side, angle, turn.degree):
                continue
            if turn.at is not None:
                if self._near(trail, turn.at, at):
                    return at
                continue
            if not moved and at > SOON_M + s:
                return None
            return at + 1e-3
        return None

    def _step(self, trail: Trail, atom: Atom, s: float, moved: bool) -> float | None:
        match atom:
            case Straight():
                return self._straight(trail, s, moved)
            case Along():
                return self._along(trail, atom, s)
            case Pass():
                return self._pass(trail, atom, s)
            case Between():
                one, two = self._pass(trail, Pass(atom.one), s), self._pass(trail, Pass(atom.two), s)
                return None if one is None or two is None else min(one, two)
            case Toward():
                return self._toward(trail, atom.thing, s)
            case See():
                return self._see(trail, atom, s)
            case _:
                return s

    def _near(self, trail: Trail, thing: Thing, s: float) -> bool:
        leg, k = trail.at(s)
        floor = self.topology.house.rooms[leg.room].floor
        point = leg.points[k : k + 1]
        return any(i.floor == floor and surface_distance(i, point)[0] < PASS_M + 0.4 for i in self.matching(thing))

    def _straight(self, trail: Trail, s: float, moved: bool) -> float | None:
        for at, angle in trail.turns():
            if (at == 0.0 and not moved and s == 0.0 and abs(angle) > STRAIGHT_RAD) or (
                s + 0.05 < at < s + 0.8 and abs(angle) > STRAIGHT_RAD
            ):
                return None
        return s + 0.5

    def _along(self, trail: Trail, along: Along, s: float) -> float | None:
        house = self.topology.house
        for offset, leg in zip(trail.offsets, trail.legs, strict=True):
            if (
                offset + leg.length_m < s - SLACK_M
                or not space_fits(along.space, house.rooms[leg.room].type)
                or leg.length_m < 0.8
            ):
                continue
            if not along.end:
                return max(s, offset + 0.8)
            for end, _ in self.topology.hallway_ends(leg.room):
                d = np.hypot(*(leg.points - np.array(end)).T)
                if d.min() < 1.8:
                    return max(s, offset + float(np.argmin(d)) * STEP_M - SLACK_M)
        return None

    def _pass(self, trail: Trail, pas: Pass, s: float) -> float | None:
        for offset, leg in zip(trail.offsets, trail.legs, strict=True):
            for passed in leg.passed:
                at = offset + passed.s_m
                item = self.topology.item[passed.item]
                if at < s - SLACK_M or not passed.seen or not passed.reached or not pas.thing.matches(item):
                    continue
                if pas.side and passed.side == -pas.side:
                    continue
                return at
        return None

    def _toward(self, trail: Trail, thing: Thing, s: float) -> float | None:
        best = None
        for offset, leg in zip(trail.offsets, trail.legs, strict=True):
            floor = self.topology.house.rooms[leg.room].floor
            for item in self.matching(thing):
                if item.floor != floor:
                    continue
                d = surface_distance(item, leg.points)
                k = int(np.argmin(d))
                at = offset + k * STEP_M
                if (
                    d[k] < 2.0
                    and at >= s - SLACK_M
                    and self.topology.seen(item, leg.points[: k + 1])
                    and (best is None or at < best)
                ):
                    best = at
        return best

    def _see(self, trail: Trail, see: See, s: float) -> float | None:
        """An orientation is meant relative to the first steps."""
        leg, k = trail.at(s)
        floor = self.topology.house.rooms[leg.room].floor
        points = leg.points[k : k + 5]
        for item in self.matching(see.thing):
            if item.floor != floor or surface_distance(item, points).min() > SEE_M or not self.topology.seen(item, points):
                continue
            bearing = wrap_angle(math.atan2(item.y - points[0, 1], item.x - points[0, 0]) - float(leg.yaws[k]))
            fits = {0: True, 2: abs(bearing) > AROUND_RAD, 3: abs(bearing) < STRAIGHT_RAD}
            if fits.get(see.side, bearing * see.side > SIDE_LOW):
                return s
        return None


def space_fits(word: str, room_type: str) -> bool:
    """Whether a room may be meant by a type word."""
    return word in ("", ANY_ROOM) or word == room_type.replace("_", " ")


def ordinal_fits(topology: Topology, side: int, ordinal: int, leg: Leg, here: Node) -> bool:
    """Whether a portal lies on the side, and has the ordinal there, for someone who walks the leg."""
    if not side and not ordinal:
        return True
    portal = leg.portal
    if portal is None:
        return False
    travel = travel_yaw(leg, here)
    bearing = wrap_angle(math.atan2(portal.centre[1] - here.xy[1], portal.centre[0] - here.xy[0]) - here.yaw_rad)
    exit_turn = wrap_angle(portal.out_yaw(here.room) - travel)
    sides = {int(math.copysign(1, a)) for a in (bearing, exit_turn) if SIDE_LOW * 0.7 < abs(a) < SIDE_HIGH}
    if side and side not in sides:
        return False
    if not ordinal:
        return True
    counted = topology.ordinals(here, portal, travel)
    if counted is None:  # beside the node, or at the end: it may be the first or the last for someone
        return ordinal in (1, -1)
    last = max(
        (c[1] for p in topology.of_room[here.room] if (c := topology.ordinals(here, p, travel)) and c[0] == counted[0]), default=0
    )
    return counted[1] == (last if ordinal == -1 else ordinal)


def travel_yaw(leg: Leg, here: Node) -> float:
    """Direction of the main run of a leg."""
    if leg.length_m < 1.0:
        return here.yaw_rad
    k = len(leg.points) // 2
    a, b = leg.points[max(0, k - 4)], leg.points[min(len(leg.points) - 1, k + 4)]
    return math.atan2(b[1] - a[1], b[0] - a[0])
