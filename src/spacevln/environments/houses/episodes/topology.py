"""Portals, legs and trails: what a walk through a house looks like to someone who gives directions.

A *portal* is a doorway, an open-plan opening or a flight of stairs. A *node* is the start or the moment after walking through
a portal into a room. A *leg* is the walk inside one room from a node to a portal or to a place. A *trail* joins legs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacevln.core.geometry import wrap_angle
from spacevln.environments.houses.episodes.bends import STEP_M, directions, resampled, turns_of
from spacevln.environments.houses.episodes.item_geometry import Footprints, nearest_surface_point
from spacevln.environments.houses.episodes.space import XY, Bool, Float, Ints, Space, stairs_ends
from spacevln.environments.houses.episodes.unnamed import NEVER_LANDMARKS
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.plan import House, Item, Room

PASS_M = 2.4
SEE_M = 7.0
_INSIDE_M = 0.45


@dataclass(frozen=True, slots=True)
class Portal:
    """A way from one room to another.

    Args:
        id: of the opening or the stairs.
        kind: ``"doorway"``, ``"opening"`` or ``"stairs"``.
        rooms: the two rooms; of stairs, the lower one first.
        points: just before the portal in each of the rooms.
        yaw_rad: direction of walking from the first to the second room.
        centre: middle of the hole.
        length_m: from one point to the other.
        attributes: of the frame.
        leaf: whether a door leaf hangs in it.
    """

    id: int
    kind: str
    rooms: tuple[int, int]
    points: tuple[XY, XY]
    yaw_rad: float
    centre: XY
    length_m: float
    attributes: tuple[str, ...] = ()
    leaf: bool = False

    def other(self, room: int) -> int:
        """The room on the other side."""
        return self.rooms[1] if room == self.rooms[0] else self.rooms[0]

    def side(self, room: int) -> XY:
        """The point before the portal on a room's side."""
        return self.points[0] if room == self.rooms[0] else self.points[1]

    def out_yaw(self, room: int) -> float:
        """Direction of walking out of a room."""
        return self.yaw_rad if room == self.rooms[0] else wrap_angle(self.yaw_rad + math.pi)


@dataclass(frozen=True, slots=True)
class Node:
    """Where a leg begins: the start (``portal`` = -1) or just inside ``room`` after walking through ``portal``."""

    portal: int
    room: int
    xy: XY
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class Passed:
    """An item beside a leg.

    Args:
        item: its id.
        s_m: arc position of the nearest point.
        distance_m: from there to its surface.
        side: +1 left, -1 right, 0 neither clearly.
        seen: whether it is in line of sight shortly before or there.
        inner: the nearest point is neither at the very start nor the end.
        reached: the leg does not end clearly before it.
    """

    item: int
    s_m: float
    distance_m: float
    side: int
    seen: bool
    inner: bool
    reached: bool


@dataclass(frozen=True, slots=True)
class Leg:
    """A walk inside one room.

    Args:
        room: where.
        points: (N, 2) every 0.2 m.
        yaws: (N,) direction of walking.
        turns: (arc position, angle) of the bends, left positive; the first relative to the heading at the node,
            the last into the portal.
        passed: items beside it.
        length_m: length.
        portal: walked through at the end, or None.
    """

    room: int
    points: Float
    yaws: Float
    turns: tuple[tuple[float, float], ...]
    passed: tuple[Passed, ...]
    length_m: float
    portal: Portal | None

    @property
    def first_turn_rad(self) -> float:
        """Bearing of the first metre relative to the heading at the node."""
        return self.turns[0][1] if self.turns and self.turns[0][0] == 0.0 else 0.0

    @property
    def exit_turn_rad(self) -> float:
        """Turn into the portal."""
        return self.turns[-1][1] if self.portal is not None and self.turns and self.turns[-1][0] == self.length_m else 0.0


def make_portals(house: House) -> dict[int, Portal]:
    """Every portal of a house by id."""
    portals: dict[int, Portal] = {}
    for opening in house.openings:
        a, b = opening.rooms
        if opening.kind == "window" or b is None:
            continue
        normal = (0.0, 1.0) if opening.along == "x" else (1.0, 0.0)
        reach = _INSIDE_M + house.wall_thickness_m / 2
        ahead = (opening.x + normal[0] * reach, opening.y + normal[1] * reach)
        behind = (opening.x - normal[0] * reach, opening.y - normal[1] * reach)
        if house.rooms[b].contains(*ahead) or house.rooms[a].contains(*behind):
            points, yaw = (behind, ahead), math.atan2(normal[1], normal[0])
        else:
            points, yaw = (ahead, behind), math.atan2(-normal[1], -normal[0])
        portals[opening.id] = Portal(
            opening.id, opening.kind, (a, b), points, yaw, (opening.x, opening.y), 2 * reach, opening.attributes, opening.leaf
        )
    for stairs in house.stairs:
        foot, top = stairs_ends(stairs.rect, stairs.up_yaw_rad)
        lower, upper = house.room_at(*foot, stairs.lower_floor), house.room_at(*top, stairs.lower_floor + 1)
        if lower is None or upper is None:
            continue
        rise = house.floors[stairs.lower_floor + 1].z_m - house.floors[stairs.lower_floor].z_m
        length = math.hypot(math.dist(foot, top), rise)
        portals[stairs.id] = Portal(
            stairs.id, "stairs", (lower.id, upper.id), (foot, top), stairs.up_yaw_rad, stairs.rect.centre, length
        )
    return portals


def is_hallway(room: Room) -> bool:
    """Whether people would call the room a hallway."""
    return room.type.replace("_", " ") in ("hallway", "corridor", "landing")


class Topology:
    """Portals, nodes and cached legs of one house.

    Args:
        house: the house.
        walkable: its walkable space, when that exists already.
    """

    def __init__(self, house: House, walkable: Walkable | None = None) -> None:
        self.house = house
        self.space = Space(walkable or Walkable(house))
        self.portals = make_portals(house)
        self.of_room: dict[int, tuple[Portal, ...]] = {
            room.id: tuple(p for p in self.portals.values() if room.id in p.rooms) for room in house.rooms
        }
        self.prints = {f.index: Footprints(_mentionable(house, f.index)) for f in house.floors}
        self.item = {item.id: item for item in house.items}
        self._legs: dict[tuple[object, ...], Leg | None] = {}

    def node(self, portal: Portal, room: int) -> Node:
        """Just inside ``room`` after walking through the portal."""
        return Node(portal.id, room, portal.side(room), portal.out_yaw(portal.other(room)))

    def leg_to_portal(self, node: Node, portal: Portal) -> Leg | None:
        """The leg from a node through a portal of its room."""
        key = (node.portal, node.room, node.xy, portal.id)
        if key not in self._legs:
            path = self.space.path(node.room, node.xy, portal.side(node.room))
            self._legs[key] = None if path is None else self._leg(node, path, portal)
        return self._legs[key]

    def leg_to_place(self, node: Node, xy: XY) -> Leg | None:
        """The leg from a node to a place in its room."""
        key = (node.portal, node.room, node.xy, round(xy[0], 2), round(xy[1], 2))
        if key not in self._legs:
            path = self.space.path(node.room, node.xy, xy)
            self._legs[key] = None if path is None else self._leg(node, path, None)
        return self._legs[key]

    def _leg(self, node: Node, path: Float, portal: Portal | None) -> Leg:
        points, length = resampled(path)
        yaws = directions(points)
        turns = turns_of(points, length, node.yaw_rad, None if portal is None else portal.out_yaw(node.room))
        floor = self.house.rooms[node.room].floor
        passed = self._passed(points, yaws, floor)
        return Leg(node.room, points, yaws, turns, passed, length, portal)

    def _passed(self, points: Float, yaws: Float, floor: int) -> tuple[Passed, ...]:
        prints = self.prints[floor]
        index = prints.near(points, PASS_M)
        if not len(index):
            return ()
        distance, _ = prints.nearest(index, points)
        closest = distance.argmin(axis=1)
        keep = distance[np.arange(len(index)), closest] <= PASS_M
        index, distance, closest = index[keep], distance[keep], closest[keep]
        if not len(index):
            return ()
        seen = self._seen_each(index, closest, points, floor)
        out = []
        for row, k in enumerate(closest):
            item = prints.items[index[row]]
            dx, dy = item.x - points[k, 0], item.y - points[k, 1]
            ahead = math.cos(yaws[k]) * dx + math.sin(yaws[k]) * dy
            across = -math.sin(yaws[k]) * dx + math.cos(yaws[k]) * dy
            side = 0 if abs(across) < 0.3 or abs(ahead) > 1.5 * abs(across) + 0.3 else int(math.copysign(1, across))
            inner = bool(0 < k < len(points) - 1 and k * STEP_M > 0.3)
            reached = bool(k < len(points) - 1 or ahead < 0.9)
            out.append(Passed(item.id, float(k * STEP_M), float(distance[row, k]), side, bool(seen[row]), inner, reached))
        return tuple(sorted(out, key=lambda p: (p.s_m, p.item)))

    def _seen_each(self, index: Ints, closest: Ints, points: Float, floor: int) -> Bool:
        """Which footprints are in line of sight from one of seven points up to two steps after the nearest one."""
        back = np.linspace(-16, 2, 7).round().astype(np.int64)
        eyes = points[np.clip(closest[:, None] + back[None], 0, len(points) - 1)]
        _, spots = self.prints[floor].nearest(index, eyes)
        clear = self.space.sees(floor, eyes.reshape(-1, 2), spots.reshape(-1, 2), 0.25)
        return np.asarray(clear.reshape(eyes.shape[:2]).any(axis=1))

    def seen(self, item: Item, points: Float) -> bool:
        """Whether an item is in line of sight from one of some points on its floor."""
        eyes = points[:: max(1, len(points) // 6)]
        return bool(self.space.sees(item.floor, eyes, nearest_surface_point(item, eyes), 0.25).any())

    def hallway_ends(self, room: int) -> tuple[tuple[XY, float], ...]:
        """The ends of a long room: (point 0.5 m before the end wall, direction of walking towards it)."""
        rect = max(self.house.rooms[room].rects, key=lambda r: max(r.width, r.depth))
        cx, cy = rect.centre
        if max(rect.width, rect.depth) < 1.6 * min(rect.width, rect.depth) or max(rect.width, rect.depth) < 3.0:
            return ()
        if rect.width > rect.depth:
            return ((rect.x0 + 0.5, cy), math.pi), ((rect.x1 - 0.5, cy), 0.0)
        return ((cx, rect.y0 + 0.5), -math.pi / 2), ((cx, rect.y1 - 0.5), math.pi / 2)

    def ordinals(self, node: Node, portal: Portal, travel_yaw: float) -> tuple[int, int] | None:
        """(side, ordinal) of a portal among those on its side of a straight walk through a room; None when it is not beside.

        Ordinals are counted along the walk from the node; side is +1 left, -1 right.
        """
        ux, uy = math.cos(travel_yaw), math.sin(travel_yaw)
        ranked = []
        for other in self.of_room[node.room]:
            if other.kind == "stairs" or other.id == node.portal:
                continue
            out = other.out_yaw(node.room)
            turn = wrap_angle(out - travel_yaw)
            if not math.radians(50) < abs(turn) < math.radians(130):
                continue
            along = (other.centre[0] - node.xy[0]) * ux + (other.centre[1] - node.xy[1]) * uy
            ranked.append((along, other.id, 1 if turn > 0 else -1))
        mine = next((r for r in ranked if r[1] == portal.id), None)
        if mine is None or mine[0] < 0.3:
            return None
        same = sorted(r for r in ranked if r[2] == mine[2] and r[0] > -0.3)
        if any(r[0] < 0.3 for r in same):
            return None  # a door beside the node: whether it counts as the first is a matter of taste
        return mine[2], [r[1] for r in same].index(portal.id) + 1


def _mentionable(house: House, floor: int) -> tuple[Item, ...]:
    """The items of a storey that some instruction may name."""
    return tuple(i for i in house.items if i.floor == floor and i.category not in NEVER_LANDMARKS)
