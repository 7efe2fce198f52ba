"""Choosing where a route starts and ends, and what lies along it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from spacevln.environments.houses.episodes.nouns import FLAT, category_of, is_landmark, salience
from spacevln.environments.houses.episodes.space import XY, Float
from spacevln.environments.houses.episodes.stops import ring
from spacevln.environments.houses.episodes.topology import Leg, Node, Portal, Topology, is_hallway
from spacevln.environments.houses.plan import Item

EndKind = Literal["item", "entry", "doorway", "before", "landing", "stairs", "end", "room"]
_END_WEIGHTS: dict[EndKind, float] = {
    "item": 2.4,
    "entry": 1.6,
    "doorway": 0.9,
    "before": 3.0,
    "landing": 2.0,
    "stairs": 1.2,
    "end": 0.6,
    "room": 0.9,
}


@dataclass(frozen=True, slots=True)
class End:
    """A place where a route may end: kind, room, point, and what it is near."""

    kind: EndKind
    room: int
    xy: XY
    portal: Portal | None = None
    item: Item | None = None


@dataclass(frozen=True)
class Route:
    """A walk: nodes and legs (the last one to the end), its length and its dense path (N, 3)."""

    start: Node
    end: End
    nodes: tuple[Node, ...]
    legs: tuple[Leg, ...]
    length_m: float
    path: Float


def sample_end(topology: Topology, rng: np.random.Generator) -> End | None:
    """A random end, or None when the drawn kind does not exist in the drawn room."""
    kinds = list(_END_WEIGHTS)
    weights = np.array([_END_WEIGHTS[k] for k in kinds])
    kind = kinds[int(rng.choice(len(kinds), p=weights / weights.sum()))]
    house = topology.house
    room = house.rooms[int(rng.integers(len(house.rooms)))]
    portals = topology.of_room[room.id]
    doors = [p for p in portals if p.kind != "stairs"]
    if kind in ("landing", "stairs"):
        stairs = [p for p in topology.portals.values() if p.kind == "stairs"]
        if not stairs:
            return None
        portal = stairs[int(rng.integers(len(stairs)))]
        side = portal.rooms[int(rng.integers(2))]
        return End(kind, side, portal.side(side), portal)
    if kind == "item":
        return _item_end(topology, room.id, rng)
    if kind == "end":
        ends = topology.hallway_ends(room.id)
        return End(kind, room.id, ends[int(rng.integers(len(ends)))][0]) if ends and is_hallway(room) else None
    if not doors or (kind != "before" and room.type == "hallway" and rng.random() < 0.6):
        return None
    portal = doors[int(rng.integers(len(doors)))]
    if kind == "room":
        return End(kind, room.id, room.centre, portal) if room.area < 16 else None
    inside = topology.node(portal, room.id)
    if kind == "entry":
        reach = rng.uniform(0.2, 0.7)
        return End(
            kind,
            room.id,
            (inside.xy[0] + reach * math.cos(inside.yaw_rad), inside.xy[1] + reach * math.sin(inside.yaw_rad)),
            portal,
        )
    return End(kind, room.id, portal.centre if kind == "doorway" else inside.xy, portal)


def _item_end(topology: Topology, room: int, rng: np.random.Generator) -> End | None:
    house = topology.house
    floor = house.rooms[room].floor
    items = [i for i in house.items if i.room == room and is_landmark(i, house.floors[floor].z_m) and category_of(i) not in FLAT]
    if not items:
        return None
    weights = np.array([salience(item) for item in items])
    item = items[int(rng.choice(len(items), p=weights / weights.sum()))]
    spots = [s for s in ring(topology.space, item, floor, float(rng.uniform(0.4, 0.7))) if house.rooms[room].contains(*s)]
    return End("item", room, spots[int(rng.integers(len(spots)))], None, item) if spots else None


def sample_start(
    topology: Topology, field: Float, goal_floor: int, target_m: float, rng: np.random.Generator
) -> tuple[XY, int] | None:
    """A walkable point about ``target_m`` from the goal in a random room; mostly on another storey if there is one."""
    house = topology.house
    good = topology.space.walkable & (np.abs(field - target_m) < 0.6) & (topology.space.room >= 0)
    if len(house.floors) > 1 and rng.random() < 0.9:
        other = good.copy()
        other[goal_floor] = False
        good = other if other.any() else good
    rooms = np.unique(topology.space.room[good])
    if not len(rooms):
        return None
    weights = np.array([0.5 if is_hallway(house.rooms[r]) else 1.0 for r in rooms])
    room = int(rooms[int(rng.choice(len(rooms), p=weights / weights.sum()))])
    cells = np.argwhere(good & (topology.space.room == room))
    f, i, j = cells[int(rng.integers(len(cells)))]
    x, y = topology.space.xy(np.array([[i, j]]))[0]
    return (float(x), float(y)), int(f)


def portals_along(topology: Topology, path: Float) -> list[Portal] | None:
    """The portals that a path (N, 3) walks through, in order; None when it leaves the rooms elsewhere."""
    house, space = topology.house, topology.space
    dense = _dense(path)
    heights = np.array([f.z_m for f in house.floors])
    floors = np.argmin(np.abs(dense[:, 2:3] - heights[None]), axis=1)
    ij = space.ij(dense[:, :2])
    rooms = space.room[floors, ij[:, 0], ij[:, 1]]
    sequence: list[Portal] = []
    here = -1
    for k, room in enumerate(rooms):
        if room < 0 or room == here or _on_stairs(topology, dense[k], int(floors[k])):
            continue
        if here >= 0:
            between = [p for p in topology.of_room[here] if p.other(here) == room]
            if not between:
                return None
            x, y = dense[k, :2]
            sequence.append(min(between, key=lambda p: math.hypot(p.side(int(room))[0] - x, p.side(int(room))[1] - y)))
        here = int(room)
    return sequence


def _on_stairs(topology: Topology, point: Float, floor: int) -> bool:
    return any(floor in (s.lower_floor, s.lower_floor + 1) and s.rect.contains(point[0], point[1]) for s in topology.house.stairs)


def _dense(path: Float, step_m: float = 0.05) -> Float:
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    s = np.append(np.arange(0.0, arc[-1], step_m), arc[-1])
    return np.stack([np.interp(s, arc, path[:, i]) for i in range(3)], axis=1)


def make_route(topology: Topology, start: XY, room: int, yaw_rad: float, end: End, path: Float, length_m: float) -> Route | None:
    """The route along a shortest path, or None when its rooms cannot be told apart or it takes an odd detour."""
    # a route that ends in a doorway is described up to the first step behind it
    beyond = path if end.kind != "doorway" else np.vstack([path, [*_inner(topology, end), path[-1, 2]]])
    portals = portals_along(topology, beyond)
    if portals is None or not _arrives(portals, end) or len({p.id for p in portals}) != len(portals):
        return None
    nodes = [Node(-1, room, start, yaw_rad)]
    legs: list[Leg] = []
    for portal in portals:
        leg = topology.leg_to_portal(nodes[-1], portal)
        if leg is None:
            return None
        legs.append(leg)
        nodes.append(topology.node(portal, portal.other(nodes[-1].room)))
    if nodes[-1].room != end.room:
        return None
    final = topology.leg_to_place(nodes[-1], _inner(topology, end) if end.kind == "doorway" else end.xy)
    if final is None:
        return None
    total = sum(leg.length_m + (leg.portal.length_m if leg.portal else 0.0) for leg in [*legs, final])
    if abs(total - length_m) > 0.15 * length_m + 0.8:
        return None
    return Route(nodes[0], end, tuple(nodes), (*legs, final), length_m, path)


def _inner(topology: Topology, end: End) -> XY:
    return end.xy if end.portal is None else topology.node(end.portal, end.room).xy


def _arrives(portals: list[Portal], end: End) -> bool:
    """Whether the last portal is the one that the end is about, or is not, as its kind wants."""
    if end.kind in ("entry", "doorway", "landing"):
        return bool(portals) and end.portal is not None and portals[-1].id == end.portal.id
    if end.kind in ("before", "stairs"):
        return end.portal is None or all(p.id != end.portal.id for p in portals)
    return True
