"""Which geoms a camera can see: rooms through the openings in view, and of their geoms those inside the field of view.

Seen from above, a line of sight from one room to the next passes through an opening's middle line. So the angular interval in
which a room is visible is the interval of the way there cut with that of the opening. Heights are ignored: nothing visible is
ever dropped, and the few things too many cost little.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float, wrap_angle
from spacevln.core.sensing import Camera
from spacevln.environments.houses.plan import House, Opening, Rect, Room, Stairs
from spacevln.environments.houses.rendering.protocol import Drawable

_MARGIN_M = 0.05
_MAX_DEPTH = 12
_TURNS = (0.0, math.tau, -math.tau)
Interval = tuple[float, float]


@dataclass(frozen=True, slots=True)
class _Portal:
    """A way to see from one space into another: a segment (two corners) or a well (four)."""

    to: int
    corners: tuple[tuple[float, float], ...]
    box: Rect  # inside it, the portal is all around the camera


def geom_bounds(model: mujoco.MjModel) -> tuple[Float, Float]:
    """Axis-aligned bounds (lower, upper), each (ngeom, 3), of the geoms of a model that does not move [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rotation = data.geom_xmat.reshape(-1, 3, 3)
    centre = data.geom_xpos + np.einsum("nij,nj->ni", rotation, model.geom_aabb[:, :3])
    half = np.einsum("nij,nj->ni", np.abs(rotation), model.geom_aabb[:, 3:])
    half[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = np.inf
    return centre - half, centre + half


def _grown(rect: Rect, margin: float) -> Rect:
    return Rect(rect.x0 - margin, rect.y0 - margin, rect.x1 + margin, rect.y1 + margin)


def _overlap(a: Rect, b: Rect) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


class Visibility:
    """Portal and frustum culling of one house.

    Args:
        house: rooms, openings and stairs.
        lower, upper: (n, 3) bounds of the geoms [m].
    """

    def __init__(self, house: House, lower: Float, upper: Float) -> None:
        self._house = house
        self._spaces: list[Room | Stairs] = [*house.rooms, *house.stairs]
        self._index = {room.id: k for k, room in enumerate(house.rooms)}
        self._portals: list[list[_Portal]] = [[] for _ in self._spaces]
        for opening in house.openings:
            self._add_opening(opening)
        for k, stairs in enumerate(house.stairs, start=len(house.rooms)):
            self._add_well(k, stairs)
        self._lower, self._upper = lower, upper
        self._centre = (lower + upper) / 2
        self._member = np.stack([self._overlapping(space) for space in self._spaces], axis=1)
        self._everywhere = ~self._member.any(axis=1)

    @classmethod
    def of(cls, drawable: Drawable) -> Visibility:
        """Of a compiled house."""
        return cls(drawable.house, *geom_bounds(drawable.model))

    def near_first(self, T_world_camera: Float, camera: Camera) -> NDArray[np.int64]:
        """The geoms that may be in the image, near ones first."""
        x, y, z = (float(v) for v in T_world_camera[:3, 3])
        forward = T_world_camera[:3, 0]
        half_fov = math.atan(max(camera.cx_px, camera.width_px - camera.cx_px) / camera.fx_px)
        if abs(float(forward[2])) > 1e-6:  # a tilted camera sees to all sides of its feet
            half_fov = math.pi
        shown = np.flatnonzero(self.visible(x, y, z, math.atan2(forward[1], forward[0]), half_fov))
        distance = np.linalg.norm(self._centre[shown] - (x, y, z), axis=1)
        return shown[np.argsort(distance, kind="stable")]

    def _add_opening(self, opening: Opening) -> None:
        if opening.rooms[1] is None:
            return
        half, across = opening.width_m / 2, self._house.wall_thickness_m / 2
        ex, ey = (half, 0.0) if opening.along == "x" else (0.0, half)
        corners = ((opening.x - ex, opening.y - ey), (opening.x + ex, opening.y + ey))
        ax, ay = (half, across) if opening.along == "x" else (across, half)
        box = _grown(Rect(opening.x - ax, opening.y - ay, opening.x + ax, opening.y + ay), _MARGIN_M)
        a, b = (self._index[room] for room in (opening.rooms[0], opening.rooms[1]))
        self._portals[a].append(_Portal(b, corners, box))
        self._portals[b].append(_Portal(a, corners, box))

    def _add_well(self, well: int, stairs: Stairs) -> None:
        rect = stairs.rect
        corners = ((rect.x0, rect.y0), (rect.x1, rect.y0), (rect.x1, rect.y1), (rect.x0, rect.y1))
        near = _grown(rect, self._house.wall_thickness_m + _MARGIN_M)
        for k, room in enumerate(self._house.rooms):
            if room.floor in (stairs.lower_floor, stairs.lower_floor + 1) and any(_overlap(near, r) for r in room.rects):
                self._portals[k].append(_Portal(well, corners, near))
                self._portals[well].append(_Portal(k, corners, near))

    def _overlapping(self, space: Room | Stairs) -> NDArray[np.bool_]:
        """Which geoms reach into a space, walls around it included."""
        if isinstance(space, Room) and space.type == "balcony":  # over its low walls one sees the house from outside
            return np.ones(len(self._lower), dtype=np.bool_)
        if isinstance(space, Room):
            rects, floors = space.rects, (space.floor, space.floor)
        else:
            rects, floors = (space.rect,), (space.lower_floor, space.lower_floor + 1)
        grow = self._house.wall_thickness_m + _MARGIN_M
        z0 = self._house.floors[floors[0]].z_m - 0.4
        top = self._house.floors[floors[1]]
        z1 = top.z_m + top.ceiling_m + 0.4
        inside = np.zeros(len(self._lower), dtype=np.bool_)
        for rect in (_grown(rect, grow) for rect in rects):
            inside |= (
                (self._lower[:, 0] < rect.x1)
                & (self._upper[:, 0] > rect.x0)
                & (self._lower[:, 1] < rect.y1)
                & (self._upper[:, 1] > rect.y0)
            )
        return inside & (self._upper[:, 2] > z0 + 0.05) & (self._lower[:, 2] < z1 - 0.05)

    def _start(self, x: float, y: float, z: float) -> list[int]:
        """The spaces that the camera is in: one room, or both sides of a doorway, or a flight of stairs."""
        found = [
            k
            for k, room in enumerate(self._house.rooms)
            if room.contains(x, y) and -_MARGIN_M <= z - self._house.floors[room.floor].z_m <= self._height(room.floor)
        ]
        for k in range(len(self._spaces)):
            for portal in self._portals[k]:
                if portal.box.contains(x, y) and self._spans(k, z):
                    found.append(k)
                    break
        return list(dict.fromkeys(found))

    def _height(self, floor: int) -> float:
        return self._house.floors[floor].ceiling_m + 0.4

    def _spans(self, k: int, z: float) -> bool:
        space = self._spaces[k]
        lowest, highest = (space.floor, space.floor) if isinstance(space, Room) else (space.lower_floor, space.lower_floor + 1)
        z0 = self._house.floors[lowest].z_m
        z1 = self._house.floors[highest].z_m + self._height(highest)
        return z0 - _MARGIN_M <= z <= z1

    def rooms_in_view(self, x: float, y: float, z: float, yaw: float, half_fov: float) -> dict[int, Interval]:
        """Spaces in view with the interval of bearings (right, left) [rad] in which each can be seen; empty: not in the house."""
        views: dict[int, Interval] = {}
        stack = [(k, -half_fov, half_fov, 0) for k in self._start(x, y, z)]
        while stack:
            k, right, left, depth = stack.pop()
            old = views.get(k)
            if old is not None and old[0] <= right and left <= old[1]:
                continue
            views[k] = (right, left) if old is None else (min(right, old[0]), max(left, old[1]))
            if depth == _MAX_DEPTH:
                continue
            for portal in self._portals[k]:
                low, high = _bearings(portal, x, y, yaw)
                for turn in _TURNS:  # what straddles the direction straight back appears at both ends
                    cut = (max(low + turn, right), min(high + turn, left))
                    if cut[0] < cut[1]:
                        stack.append((portal.to, *cut, depth + 1))
        return views

    def visible(self, x: float, y: float, z: float, yaw: float, half_fov: float) -> NDArray[np.bool_]:
        """(n,) which geoms may be in the image of a level camera; all of them when the camera is outside the house."""
        views = self.rooms_in_view(x, y, z, yaw, half_fov)
        if not views:
            return np.ones(len(self._lower), dtype=np.bool_)
        right, left = self._geom_bearings(x, y, yaw)
        seen = self._everywhere & _meets(right, left, -half_fov, half_fov)
        for k, (low, high) in views.items():
            seen |= self._member[:, k] & _meets(right, left, low, high)
        return seen

    def _geom_bearings(self, x: float, y: float, yaw: float) -> tuple[Float, Float]:
        """Bearings [rad] of the right and left ends of the geoms' bounds; those around the camera have (-pi, pi)."""
        lower, upper = self._lower[:, :2] - (x, y), self._upper[:, :2] - (x, y)
        corners_x = np.stack([lower[:, 0], upper[:, 0], upper[:, 0], lower[:, 0]])
        corners_y = np.stack([lower[:, 1], lower[:, 1], upper[:, 1], upper[:, 1]])
        around = (lower < _MARGIN_M).all(axis=1) & (upper > -_MARGIN_M).all(axis=1)
        with np.errstate(invalid="ignore"):
            centre = np.arctan2(lower[:, 1] + upper[:, 1], lower[:, 0] + upper[:, 0])
            spread = np.arctan2(corners_y, corners_x) - centre
        spread = (spread + math.pi) % math.tau - math.pi
        middle = (centre - yaw + math.pi) % math.tau - math.pi
        right, left = middle + spread.min(axis=0), middle + spread.max(axis=0)
        around |= ~np.isfinite(right)
        right[around], left[around] = -math.pi, math.pi
        return right, left


def _meets(right: Float, left: Float, low: float, high: float) -> NDArray[np.bool_]:
    """Which intervals (right, left) of bearings overlap (low, high), full turns aside."""
    found = np.zeros(len(right), dtype=np.bool_)
    for turn in _TURNS:
        found |= (left + turn > low) & (right + turn < high)
    return found


def _bearings(portal: _Portal, x: float, y: float, yaw: float) -> Interval:
    """Interval of bearings that a portal covers."""
    if portal.box.contains(x, y):
        return -math.pi, math.pi
    centre_x = sum(corner[0] for corner in portal.corners) / len(portal.corners)
    centre_y = sum(corner[1] for corner in portal.corners) / len(portal.corners)
    towards = math.atan2(centre_y - y, centre_x - x)
    spread = [wrap_angle(math.atan2(cy - y, cx - x) - towards) for cx, cy in portal.corners]
    middle = wrap_angle(towards - yaw)
    return middle + min(spread), middle + max(spread)
