"""Whether nothing but air lies between a person and a thing: segments against the solid boxes of a house."""

from __future__ import annotations

import math

import numpy as np

from spacevln.environments.houses.episodes.item_geometry import item_local, nearest_surface_point
from spacevln.environments.houses.episodes.space import EYE_M, Bool, Float
from spacevln.environments.houses.furniture.mesh import rotation
from spacevln.environments.houses.layout import walls
from spacevln.environments.houses.plan import House, Item, Part

_LEVELS = (0.15, 0.5, 0.9)  # shares of an item's height at which its surface is looked at


class Sight:
    """Sight lines in one house.

    Args:
        house: its walls and the parts of its items block sight.
    """

    def __init__(self, house: House) -> None:
        self.house = house
        self._walls = {
            floor.index: np.array(
                [[b.rect.x0, b.rect.y0, b.z0_m, b.rect.x1, b.rect.y1, b.z1_m] for b in walls(house)[floor.index]]
            )
            for floor in house.floors
        }

    def clear(self, eyes: Float, targets: Float, target: Item) -> Bool:
        """For each pair of points (N, 3): whether the segment between them meets neither a wall nor another item.

        What stands on the target, or what it stands on, is not in the way.
        """
        low, high = np.minimum(eyes, targets).min(axis=0), np.maximum(eyes, targets).max(axis=0)
        boxes = self._walls[target.floor]
        boxes = boxes[np.all((boxes[:, 3:] >= low) & (boxes[:, :3] <= high), axis=1)]
        free = ~hits(eyes, targets, boxes)
        for item in self.house.items:
            if item.floor != target.floor or item.id in (target.id, target.support) or item.support == target.id:
                continue
            reach = math.hypot(item.size[0], item.size[1]) / 2
            if not (low[0] - reach <= item.x <= high[0] + reach and low[1] - reach <= item.y <= high[1] + reach):
                continue
            boxes = np.array([_part_box(item, part) for part in item.parts])
            if len(boxes):
                free &= ~hits(_local(item, eyes), _local(item, targets), boxes)
        return free

    def reached(self, points: Float, item: Item, radius_m: float) -> Bool:
        """For each point (N, 3; z at the feet): whether some surface of an item is within a horizontal radius in clear sight."""
        eyes = points + np.array([0.0, 0.0, EYE_M])
        near = nearest_surface_point(item, points[:, :2])
        done = np.zeros(len(points), dtype=np.bool_)
        open_ = np.hypot(*(near - points[:, :2]).T) <= radius_m
        for spot in [near, *_rim(item, len(points))]:
            for share in _LEVELS:
                ask = np.flatnonzero(open_ & ~done & (np.hypot(*(spot - points[:, :2]).T) <= radius_m))
                if not len(ask):
                    continue
                # a hair before the surface, so that the surface itself does not count
                z = np.full(len(ask), item.z + share * item.size[2])
                targets = np.column_stack([spot[ask], z])
                targets = targets + 0.02 * (eyes[ask] - targets)
                done[ask] = self.clear(eyes[ask], targets, item)
        return done


def hits(starts: Float, ends: Float, boxes: Float) -> Bool:
    """Whether each segment (N, 3) meets any axis-aligned box (M, 6: lower and upper corner)."""
    if not len(boxes):
        return np.zeros(len(starts), dtype=np.bool_)
    d = (ends - starts)[:, None]
    d = np.where(np.abs(d) < 1e-9, 1e-9, d)
    a, b = (boxes[None, :, :3] - starts[:, None]) / d, (boxes[None, :, 3:] - starts[:, None]) / d
    enter, leave = np.minimum(a, b).max(axis=2), np.maximum(a, b).min(axis=2)
    return np.asarray(((enter < leave) & (enter < 1.0) & (leave > 0.0)).any(axis=1))


def _rim(item: Item, count: int) -> list[Float]:
    """Points around an item's footprint, each repeated for ``count`` viewers."""
    c, s = math.cos(item.yaw_rad), math.sin(item.yaw_rad)
    out = []
    for u, v in ((0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1)):
        x, y = u * item.size[0] / 2, v * item.size[1] / 2
        out.append(np.tile([item.x + c * x - s * y, item.y + s * x + c * y], (count, 1)))
    return out


def _local(item: Item, points: Float) -> Float:
    return np.column_stack([item_local(item, points[:, :2]), points[:, 2] - item.z])


def _part_box(item: Item, part: Part) -> tuple[float, ...]:
    """Bounds of a part in its item's frame, a little shrunk; a mesh counts as the whole item."""
    x, y, z = part.position
    if part.shape == "mesh":
        w, d, h = item.size
        return -w / 2, -d / 2, 0.0, w / 2, d / 2, h
    a, b, c = part.size
    half = {"cylinder": (a, a, b), "capsule": (a, a, a + b)}.get(part.shape, (a, b, c))
    if part.euler_rad != (0.0, 0.0, 0.0):
        half = tuple(np.abs(rotation(part.euler_rad)) @ np.array(half))
    return x - half[0], y - half[1], z - half[2], x + half[0], y + half[1], z + half[2]
