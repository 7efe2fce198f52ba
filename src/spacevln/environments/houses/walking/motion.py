"""How the body moves: a disc among obstacles on the floor, stopped or sliding, as the agents of VLN-CE.

The disc is swept exactly: the obstacles (oriented boxes and discs) are grown by its radius to rounded boxes and discs, and
the centre's ray is intersected with them. Nothing is sampled, so nothing can be tunnelled through.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numba import njit

from spacevln.core.actions import Motion
from spacevln.core.geometry import Float, Pose

# Contact is kept this far from the true surface, so that rounding never puts the disc inside it [m].
SKIN_M = 1e-4
_CONTACT = 1e-8
_MAX_SLIDES = 4


@njit(cache=True)
def _enter_slab(px: float, py: float, dx: float, dy: float, hx: float, hy: float) -> tuple[float, float, float]:
    """Parameter and outward normal at which a ray from outside enters the box [-hx, hx] x [-hy, hy]; inf for never."""
    near, far, nx, ny = -np.inf, np.inf, 0.0, 0.0
    for axis in range(2):
        p, d, h = (px, dx, hx) if axis == 0 else (py, dy, hy)
        if d == 0.0:
            if abs(p) >= h:
                return np.inf, 0.0, 0.0
            continue
        sign = 1.0 if d > 0 else -1.0
        a, b = (-sign * h - p) / d, (sign * h - p) / d
        if a > near:
            near, nx, ny = a, (-sign if axis == 0 else 0.0), (-sign if axis == 1 else 0.0)
        far = min(far, b)
    if near >= far or near < 0.0:
        return np.inf, 0.0, 0.0
    return near, nx, ny


@njit(cache=True)
def _enter_disc(px: float, py: float, dx: float, dy: float, radius: float) -> tuple[float, float, float]:
    """Parameter and outward normal at which a ray from outside enters the disc around the origin; (dx, dy) is a unit vector."""
    b = px * dx + py * dy
    c = px * px + py * py - radius * radius
    discriminant = b * b - c
    if b >= 0.0 or c < 0.0 or discriminant <= 2.0 * _CONTACT * radius:  # grazing is no contact
        return np.inf, 0.0, 0.0
    t = -b - math.sqrt(discriminant)
    return max(t, 0.0), (px + t * dx) / radius, (py + t * dy) / radius


@njit(cache=True)
def _surface(px: float, py: float, hx: float, hy: float) -> tuple[float, float, float]:
    """Signed distance from a point to a box around the origin, and the outward normal there."""
    qx, qy = abs(px) - hx, abs(py) - hy
    sx, sy = (1.0 if px >= 0 else -1.0), (1.0 if py >= 0 else -1.0)
    if qx > 0 and qy > 0:
        distance = math.hypot(qx, qy)
        return distance, sx * qx / distance, sy * qy / distance
    if qx > qy:
        return qx, sx, 0.0
    return qy, 0.0, sy


@njit(cache=True)
def _hit_box(px: float, py: float, dx: float, dy: float, hx: float, hy: float, radius: float) -> tuple[float, float, float]:
    """Where the centre of a disc meets a box around the origin: parameter and normal; inf for never."""
    distance, nx, ny = _surface(px, py, hx, hy)
    if distance <= radius + _CONTACT:  # already touching: only moves that do not go deeper are free
        if dx * nx + dy * ny < -_CONTACT:
            return 0.0, nx, ny
        return np.inf, 0.0, 0.0
    best, bx, by = _enter_slab(px, py, dx, dy, hx + radius, hy)
    t, nx, ny = _enter_slab(px, py, dx, dy, hx, hy + radius)
    if t < best:
        best, bx, by = t, nx, ny
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            t, nx, ny = _enter_disc(px - sx * hx, py - sy * hy, dx, dy, radius)
            if t < best:
                best, bx, by = t, nx, ny
    return best, bx, by


@njit(cache=True)
def _first_hit(
    x: float, y: float, dx: float, dy: float, length: float, radius: float, boxes: Float, discs: Float
) -> tuple[float, float, float]:
    """First contact of a disc that moves along the unit vector (dx, dy): distance and normal; inf for none."""
    best, bx, by = np.inf, 0.0, 0.0
    for k in range(boxes.shape[0]):
        cx, cy, c, s, hx, hy = boxes[k]
        rx, ry = x - cx, y - cy
        reach = length + radius + math.hypot(hx, hy) + SKIN_M
        if rx * rx + ry * ry > reach * reach:
            continue
        t, nx, ny = _hit_box(c * rx + s * ry, -s * rx + c * ry, c * dx + s * dy, -s * dx + c * dy, hx, hy, radius)
        if t < best:
            best, bx, by = t, c * nx - s * ny, s * nx + c * ny
    for k in range(discs.shape[0]):
        rx, ry, grown = x - discs[k, 0], y - discs[k, 1], radius + discs[k, 2]
        distance = math.hypot(rx, ry)
        if distance > length + grown:
            continue
        if distance <= grown + _CONTACT and distance > 0.0:
            t, nx, ny = (0.0, rx / distance, ry / distance) if (rx * dx + ry * dy) / distance < -_CONTACT else (np.inf, 0.0, 0.0)
        else:
            t, nx, ny = _enter_disc(rx, ry, dx, dy, grown)
        if t < best:
            best, bx, by = t, nx, ny
    return best, bx, by


@njit(cache=True)
def _sweep(
    x: float, y: float, vx: float, vy: float, radius: float, boxes: Float, discs: Float, sliding: bool
) -> tuple[float, float, bool]:
    collided = False
    last_x, last_y = 0.0, 0.0
    for _ in range(_MAX_SLIDES):
        length = math.hypot(vx, vy)
        if length < _CONTACT:
            break
        dx, dy = vx / length, vy / length
        t, nx, ny = _first_hit(x, y, dx, dy, length, radius + SKIN_M, boxes, discs)
        if t >= length:
            return x + vx, y + vy, collided
        collided = True
        x, y = x + t * dx, y + t * dy
        if not sliding:
            break
        left = length - t
        along = dx * nx + dy * ny
        vx, vy = left * (dx - along * nx), left * (dy - along * ny)
        if last_x * vx + last_y * vy < -_CONTACT:  # the way along this surface leads back into the last one: a corner
            break
        last_x, last_y = nx, ny
    return x, y, collided


def sweep_disc(
    xy_m: tuple[float, float],
    move_m: tuple[float, float],
    boxes: Float,
    discs: Float,
    *,
    radius_m: float = 0.1,
    sliding: bool = True,
) -> tuple[float, float, bool]:
    """Move a disc among obstacles.

    Args:
        xy_m: its centre [m].
        move_m: the wanted displacement [m].
        boxes: (N, 6) float64: centre x, y, cosine and sine of the box's yaw, half extents along its own axes [m].
        discs: (M, 3) float64: centre x, y, radius [m].
        radius_m: of the moving disc.
        sliding: what is left of the move after a contact goes on along the surface, as in VLN-CE; else the disc stops there.

    Returns:
        Its new centre, and whether anything shortened or deflected the move. The way travelled is never longer than asked.
    """
    x, y, collided = _sweep(
        float(xy_m[0]), float(xy_m[1]), float(move_m[0]), float(move_m[1]), float(radius_m), boxes, discs, sliding
    )
    return float(x), float(y), bool(collided)


class Obstacles(Protocol):
    """What blocks a disc on one storey: ``boxes`` (N, 6) and ``discs`` (M, 3), see :func:`sweep_disc`."""

    @property
    def boxes(self) -> Float:
        """Oriented boxes."""

    @property
    def discs(self) -> Float:
        """Discs."""


class Ground(Protocol):
    """Where a body can stand; :class:`~spacevln.environments.houses.ground.walkable.Walkable` is one."""

    @property
    def floors(self) -> Sequence[Obstacles]:
        """The obstacles of every storey."""

    def floor_index(self, x: float, y: float, floor_hint_z: float) -> int:
        """The storey that a point at about this height belongs to; it changes half-way up a flight of stairs."""

    def floor_height_m(self, x: float, y: float, floor_hint_z: float) -> float:
        """Height of the floor or of the steps under a point, scene frame [m]."""


class Body:
    """A disc that walks and turns; pure geometry, scene frame.

    Args:
        ground: of the house.
        radius_m: of the disc.
        sliding: as in :func:`sweep_disc`.
    """

    def __init__(self, ground: Ground, *, radius_m: float = 0.1, sliding: bool = True) -> None:
        self._ground = ground
        self._radius_m = radius_m
        self._sliding = sliding

    def placed(self, pose: Pose) -> Pose:
        """The pose with its feet on the ground."""
        return Pose(pose.x_m, pose.y_m, self._ground.floor_height_m(pose.x_m, pose.y_m, pose.z_m), pose.yaw_rad)

    def forward(self, pose: Pose, distance_m: float) -> tuple[Pose, Motion]:
        """Move along the heading as far as obstacles allow; the feet follow the ground."""
        space = self._ground.floors[self._ground.floor_index(pose.x_m, pose.y_m, pose.z_m)]
        move = (distance_m * math.cos(pose.yaw_rad), distance_m * math.sin(pose.yaw_rad))
        x, y, collided = sweep_disc(
            (pose.x_m, pose.y_m), move, space.boxes, space.discs, radius_m=self._radius_m, sliding=self._sliding
        )
        moved = math.hypot(x - pose.x_m, y - pose.y_m)
        return self.placed(Pose(x, y, pose.z_m, pose.yaw_rad)), Motion(moved_m=moved, turned_rad=0.0, collided=collided)

    def turn(self, pose: Pose, angle_rad: float) -> tuple[Pose, Motion]:
        """Turn on the spot, left positive."""
        return pose.turned(angle_rad), Motion(moved_m=0.0, turned_rad=angle_rad, collided=False)
