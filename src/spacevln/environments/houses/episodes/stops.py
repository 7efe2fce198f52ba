"""Where a person may end: the places of a stop condition, seen from the room in which the last words are followed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from spacevln.environments.houses.episodes.bends import STEP_M
from spacevln.environments.houses.episodes.clauses import Along, Atom, Cross, Pass, Stop, Thing, Toward, Turn
from spacevln.environments.houses.episodes.item_geometry import surface_distance
from spacevln.environments.houses.episodes.reading import Reader, Trail, ordinal_fits
from spacevln.environments.houses.episodes.space import XY, Space
from spacevln.environments.houses.episodes.topology import Leg, Node, Portal, Topology
from spacevln.environments.houses.plan import Item

Place = tuple[float, float, int]
NEAR_M = 0.7
ENTRY_M = 1.4


def ring(space: Space, item: Item, floor: int, distance_m: float = NEAR_M) -> list[XY]:
    """Walkable points around an item at a distance of its surface, every 45 degrees, with nothing opaque between."""
    half = (item.size[0] / 2, item.size[1] / 2)
    corners = [(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)]
    c, s = math.cos(item.yaw_rad), math.sin(item.yaw_rad)
    out = []
    for u, v in corners:
        scale = distance_m / math.hypot(u, v)
        lx, ly = u * (half[0] + scale), v * (half[1] + scale)
        if u and v:
            lx, ly = u * half[0] + u * scale, v * half[1] + v * scale
        xy = (item.x + c * lx - s * ly, item.y + s * lx + c * ly)
        near = (item.x + c * u * half[0] - s * v * half[1], item.y + s * u * half[0] + c * v * half[1])
        if space.snap(xy, -1, floor, 0.3) >= 0 and space.sees(floor, np.array([xy]), np.array([near]), 0.2)[0]:
            out.append(xy)
    return out


def in_front(item: Item, distance_m: float = NEAR_M) -> XY:
    """The point before the front of an item."""
    yaw = item.front_yaw_rad
    reach = item.size[1] / 2 + distance_m
    return item.x + math.cos(yaw) * reach, item.y + math.sin(yaw) * reach


def stop_places(reader: Reader, node: Node, group: Sequence[Atom], after_cross: bool) -> Iterator[Place]:
    """The places of a last group of atoms, for someone who stands at a node."""
    topology = reader.topology
    stop = next(atom for atom in group if isinstance(atom, Stop))
    before = [atom for atom in group if not isinstance(atom, Stop)]
    moves = [atom for atom in before if not isinstance(atom, Turn)]
    if stop.relation == "here" and (not moves):
        yield from entry(topology, node)
        return
    if stop.relation in ("inside", "outside", "doorway") and after_cross and not before and node.portal >= 0:
        portal = topology.portals[node.portal]
        fits = not stop.space or stop.space in (kind(topology, portal.rooms[0]), kind(topology, portal.rooms[1]), "room")
        if fits and not stop.side:
            yield from entry(topology, node) if stop.relation == "inside" else threshold(topology, portal)
            return
    for legs, here in rooms_in_reach(topology, node):
        found = False
        for target, places in targets(reader, here, stop, moves):
            leg = topology.leg_to_place(here, target)
            if leg is None:
                continue
            trail = Trail((*legs, leg), node.yaw_rad)
            end = reader.walk(trail, before)
            if end is None:
                continue
            found = True
            yield from places if stop.relation != "here" else here_places(topology, trail, end, places)
        if found and here.room == node.room:
            return


def kind(topology: Topology, room: int) -> str:
    """A room's type in words."""
    return topology.house.rooms[room].type.replace("_", " ")


def rooms_in_reach(topology: Topology, node: Node) -> Iterator[tuple[tuple[Leg, ...], Node]]:
    """The room of a node, then those behind its portals (not stairs, not the way back)."""
    yield (), node
    for portal in topology.of_room[node.room]:
        if portal.id == node.portal or portal.kind == "stairs":
            continue
        leg = topology.leg_to_portal(node, portal)
        if leg is not None:
            yield (leg,), topology.node(portal, portal.other(node.room))


def entry(topology: Topology, node: Node) -> Iterator[Place]:
    """Just inside a room: up to 1.4 m after the doorway."""
    floor = topology.house.rooms[node.room].floor
    yield (*node.xy, floor)
    for angle in (-0.8, 0.0, 0.8):
        yaw = node.yaw_rad + angle
        xy = (node.xy[0] + ENTRY_M * 0.7 * math.cos(yaw), node.xy[1] + ENTRY_M * 0.7 * math.sin(yaw))
        if topology.house.rooms[node.room].contains(*xy) and topology.space.snap(xy, node.room, floor, 0.2) >= 0:
            yield (*xy, floor)


def threshold(topology: Topology, portal: Portal) -> Iterator[Place]:
    """In a doorway: its middle and half a metre to both sides."""
    floor = topology.house.rooms[portal.rooms[0]].floor
    yield (*portal.centre, floor)
    for xy in portal.points:
        yield (*xy, floor)


def targets(reader: Reader, here: Node, stop: Stop, moves: Sequence[Atom]) -> Iterator[tuple[XY, list[Place]]]:
    """(where to walk, places that count) of a stop condition in one room."""
    topology = reader.topology
    floor = topology.house.rooms[here.room].floor
    match stop.relation:
        case "near" | "front" | "on" | "between":
            yield from thing_targets(reader, here, stop, floor)
        case "doorway" | "door" | "outside":
            yield from portal_targets(topology, here, stop)
        case "top" | "bottom":
            yield from stair_targets(topology, here, stop)
        case "end":
            for end, _ in topology.hallway_ends(here.room):
                yield end, [(*end, floor)]
        case "in" | "inside":
            if not stop.space or stop.space in (kind(topology, here.room), "room"):
                yield here.xy, room_samples(topology, here.room)
        case _:
            yield from last_move_targets(reader, here, moves, floor)


def thing_targets(reader: Reader, here: Node, stop: Stop, floor: int) -> Iterator[tuple[XY, list[Place]]]:
    """Places by, in front of or on the things that a stop names."""
    topology = reader.topology
    assert stop.thing is not None  # noqa: S101 - relations of things carry one
    for item in reader.matching(stop.thing):
        if item.floor != floor or item.room != here.room:
            continue
        if stop.other is not None and not near_other(reader, item, stop.other):
            continue
        spots = ring(topology.space, item, floor)
        if stop.relation == "front":
            front = in_front(item)
            spots = [xy for xy in [front, *spots] if math.dist(xy, front) < max(1.0, item.size[0] / 2)]
        if stop.relation == "on":
            spots.append((item.x, item.y))
        spots = [xy for xy in spots if topology.space.snap(xy, here.room, floor, 0.3) >= 0]
        if spots:
            yield min(spots, key=lambda xy: math.dist(xy, here.xy)), [(*xy, floor) for xy in spots]


def near_other(reader: Reader, item: Item, other: Thing) -> bool:
    """Whether something that the second noun phrase fits stands within 2.5 m of the item."""
    centre = np.array([[item.x, item.y]])
    return any(o.id != item.id and o.floor == item.floor and surface_distance(o, centre)[0] < 2.5 for o in reader.matching(other))


def portal_targets(topology: Topology, here: Node, stop: Stop) -> Iterator[tuple[XY, list[Place]]]:
    """Places at the doorways that a stop may mean."""
    floor = topology.house.rooms[here.room].floor
    for portal in topology.of_room[here.room]:
        back = portal.id == here.portal
        if back and not (stop.space or stop.side):
            yield here.xy, list(threshold(topology, portal))  # the door one came through is a door, too
        if portal.kind == "stairs" or back:
            continue
        if stop.space and stop.space not in (kind(topology, portal.other(here.room)), "room"):
            continue
        leg = topology.leg_to_portal(here, portal)
        if leg is not None and ordinal_fits(topology, stop.side, stop.ordinal, leg, here):
            near = portal.side(here.room)
            yield (
                near,
                list(threshold(topology, portal)) if stop.relation == "doorway" else [(*near, floor), (*portal.centre, floor)],
            )


def stair_targets(topology: Topology, here: Node, stop: Stop) -> Iterator[tuple[XY, list[Place]]]:
    """The foot or the top of the stairs of a room, also of those just climbed."""
    floor = topology.house.rooms[here.room].floor
    for portal in topology.of_room[here.room]:
        if portal.kind == "stairs" and (portal.rooms[0] == here.room) == (stop.relation == "bottom"):
            xy = portal.side(here.room)
            yield xy, [(*xy, floor)]


def room_samples(topology: Topology, room: int) -> list[Place]:
    """Points all over a room, every metre."""
    floor = topology.house.rooms[room].floor
    cells, _, _ = topology.space.graph(room, floor)
    keep = cells[(cells[:, 0] % 8 == 0) & (cells[:, 1] % 8 == 0)]
    return [(float(x), float(y), floor) for x, y in topology.space.xy(keep) if topology.house.rooms[room].contains(x, y)]


def last_move_targets(reader: Reader, here: Node, moves: Sequence[Atom], floor: int) -> Iterator[tuple[XY, list[Place]]]:
    """Where "stop there" means after the last move."""
    topology = reader.topology
    last = moves[-1]
    if isinstance(last, (Toward, Pass)):
        yield from thing_targets(reader, here, Stop("near", last.thing), floor)
    elif isinstance(last, Along) and last.end:
        for end, _ in topology.hallway_ends(here.room):
            yield end, [(*end, floor)]
    elif not isinstance(last, Cross):
        for x, y, level in room_samples(topology, here.room):
            yield (x, y), [(x, y, level)]


def here_places(topology: Topology, trail: Trail, end_m: float, places: list[Place]) -> list[Place]:
    """Places of a bare stop: those of the last move, and the trail's point where it was done."""
    leg, k = trail.at(min(end_m, trail.length_m))
    x, y = leg.points[min(k + round(0.5 / STEP_M), len(leg.points) - 1)]
    return [*places, (float(x), float(y), topology.house.rooms[leg.room].floor)]
