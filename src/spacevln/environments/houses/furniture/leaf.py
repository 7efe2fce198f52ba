"""Where open door leaves stand, and on which side of its wall an opening's room lies."""

from __future__ import annotations

from dataclasses import dataclass

from spacevln.environments.houses.plan import House, Opening, Room

CASING_M = 0.07
"""Width of the boards around an opening, on both faces of the wall."""


@dataclass(frozen=True, slots=True)
class LeafPlace:
    """Where an open door leaf stands.

    Args:
        room: id of the room in which it stands against the wall.
        side: +1 or -1: beside the hole towards greater or smaller coordinates along the wall.
        face: +1 or -1: the side of the wall towards greater or smaller coordinates across it.
    """

    room: int
    side: int
    face: int


def face_of(opening: Opening, room: Room) -> int:
    """On which side of the wall a room lies: +1 towards greater coordinates across the wall."""
    for face in (1, -1):
        x, y = (opening.x, opening.y + face * 0.15) if opening.along == "x" else (opening.x + face * 0.15, opening.y)
        if room.contains(x, y):
            return face
    raise ValueError(f"Opening {opening.id} is not in a wall of room {room.id}.")


def leaf_place(house: House, opening: Opening) -> LeafPlace | None:
    """The first stretch of wall beside a doorway that is long enough for its leaf; None: no leaf, or no such stretch."""
    if not opening.leaf or opening.rooms[1] is None:
        return None
    along = opening.x if opening.along == "x" else opening.y
    for room_id in opening.rooms:
        room = house.rooms[room_id] if room_id is not None else None
        if room is None:
            continue
        face = face_of(opening, room)
        for side in (1, -1):
            near, far = along + side * opening.width_m / 2, along + side * (1.5 * opening.width_m + 0.08)
            if _is_wall(house, opening, room, face, near, far):
                return LeafPlace(room.id, side, face)
    return None


def _is_wall(house: House, opening: Opening, room: Room, face: int, near: float, far: float) -> bool:
    """Whether the stretch of wall has no other hole, and the room's floor beside it reaches 0.2 m from the wall."""
    across = (opening.y if opening.along == "x" else opening.x) + face * 0.26
    for share in (0.5, 0.75, 1.0):
        t = near + (far - near) * share
        x, y = (t, across) if opening.along == "x" else (across, t)
        if not room.contains(x, y):
            return False
        if any(s.rect.contains(x, y, -0.3) for s in house.stairs if s.lower_floor in (room.floor, room.floor - 1)):
            return False
    low, high = min(near, far), max(near, far)
    for other in house.openings:
        if other.id == opening.id or other.floor != opening.floor:
            continue
        if other.along == opening.along:
            offset = abs((other.y - opening.y) if opening.along == "x" else (other.x - opening.x))
            t = other.x if opening.along == "x" else other.y
            if offset < 0.3 and t + other.width_m / 2 + 0.1 > low and t - other.width_m / 2 - 0.1 < high:
                return False
    return True
