"""The meaning of an instruction: every place at which a person who follows its clauses in a house may end.

Interpretation is lenient on purpose: a side is doubtful up to 20 degrees, a landmark is any item that the words fit, an
unmentioned doorway may be walked through when nothing nearer fits. What survives is kept, so that the set of places is rather too
large than too small. Walking back through the doorway just used is the only thing nobody does unasked.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from spacevln.core.geometry import Pose
from spacevln.environments.houses.episodes.clauses import ANY_ROOM, Atom, Clause, Cross, Stop
from spacevln.environments.houses.episodes.reading import Reader, Trail, ordinal_fits, side_fits, space_fits
from spacevln.environments.houses.episodes.stops import Place, stop_places
from spacevln.environments.houses.episodes.topology import Leg, Node, Topology
from spacevln.environments.houses.plan import House

MAX_STATES = 60


def consistent_places(house: House | Topology, start: Pose, clauses: Sequence[Clause]) -> tuple[Place, ...]:
    """Every place at which someone who follows the meaning of the clauses from the start may end.

    Args:
        house: the house, or its topology when many instructions of it are read.
        start: pose in the scene frame.
        clauses: the instruction's clauses in order.

    Returns:
        places (x, y, floor), without near duplicates; empty when the instruction cannot be followed.
    """
    topology = house if isinstance(house, Topology) else Topology(house)
    floor = floor_of(topology.house, start.z_m)
    room = topology.house.room_at(start.x_m, start.y_m, floor)
    if room is None:
        return ()
    reader = Reader(topology)
    states: dict[tuple[int, int], Node] = {(-1, room.id): Node(-1, room.id, (start.x_m, start.y_m), start.yaw_rad)}
    groups = grouped(clauses)
    for group in groups[:-1]:
        states = {(n.portal, n.room): n for node in states.values() for n in crossings(reader, node, group)}
        if not states or len(states) > MAX_STATES:
            return ()
    places: dict[tuple[int, int, int], Place] = {}
    for node in states.values():
        for place in stop_places(reader, node, groups[-1], after_cross=len(groups) > 1):
            places.setdefault((round(place[0] / 0.3), round(place[1] / 0.3), place[2]), place)
    return tuple(places.values())


def floor_of(house: House, z_m: float) -> int:
    """The storey whose floor is nearest to a height."""
    return min(house.floors, key=lambda f: abs(f.z_m - z_m)).index


def grouped(clauses: Iterable[Clause]) -> list[list[Atom]]:
    """Atoms cut after every crossing; the last group ends the walk (and has a stop added where none is said)."""
    groups: list[list[Atom]] = [[]]
    for clause in clauses:
        for atom in clause.atoms:
            groups[-1].append(atom)
            if isinstance(atom, Cross):
                groups.append([])
    if not any(isinstance(atom, Stop) for atom in groups[-1]):
        groups[-1].append(Stop("here"))
    return groups


def crossings(reader: Reader, node: Node, group: Sequence[Atom]) -> list[Node]:
    """The nodes that a person may reach by a group of atoms that ends in a crossing: the nearest that fit."""
    topology = reader.topology
    cross = group[-1]
    if not isinstance(cross, Cross):
        raise TypeError("a group of crossings ends in a Cross")
    frontier: list[tuple[tuple[Leg, ...], Node]] = [((), node)]
    for depth in range(2):
        found, onward = [], []
        for legs, here in frontier:
            for portal in topology.of_room[here.room]:
                if portal.id == here.portal:
                    continue
                leg = topology.leg_to_portal(here, portal)
                if leg is None:
                    continue
                trail = Trail((*legs, leg), node.yaw_rad)
                after = topology.node(portal, portal.other(here.room))
                if cross_fits(topology, cross, trail, here) and reader.walk(trail, group[:-1]) is not None:
                    found.append(after)
                elif portal.kind != "stairs":
                    onward.append((trail.legs, after))
        if found or depth == 1:
            return found
        frontier = onward
    return []


def cross_fits(topology: Topology, cross: Cross, trail: Trail, here: Node) -> bool:
    """Whether the last portal of a trail is one that the crossing may mean."""
    leg = trail.legs[-1]
    portal = leg.portal
    if portal is None or (portal.kind == "stairs") != (cross.climb != 0):
        return False
    rooms = topology.house.rooms
    if cross.climb:
        return (cross.climb > 0) == (portal.rooms[0] == here.room)
    if not space_fits(cross.source, rooms[here.room].type) or not space_fits(cross.target, rooms[portal.other(here.room)].type):
        return False
    if cross.target == ANY_ROOM and rooms[portal.other(here.room)].type in ("hallway", "balcony"):
        return False
    if cross.kind and portal.kind != cross.kind:
        return False
    if not set(cross.attributes) <= set(portal.attributes):
        return False
    if cross.turn and not side_fits(cross.turn, leg.exit_turn_rad or leg.first_turn_rad):
        return False
    return ordinal_fits(topology, cross.side, cross.ordinal, leg, here)
