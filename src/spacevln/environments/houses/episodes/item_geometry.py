"""Distances to the footprints of items."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.environments.houses.plan import Item

Float = NDArray[np.float64]


def item_local(item: Item, xy: Float) -> Float:
    """Points (N, 2) in the item's frame (width along x, depth along y)."""
    c, s = math.cos(item.yaw_rad), math.sin(item.yaw_rad)
    d = xy - np.array([item.x, item.y])
    return np.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1]], axis=1)


def surface_distance(item: Item, xy: Float) -> Float:
    """Horizontal distance of points (N, 2) to the item's footprint (N,), 0 inside."""
    local = np.abs(item_local(item, xy)) - np.array([item.size[0] / 2, item.size[1] / 2])
    return np.asarray(np.hypot(np.maximum(local[:, 0], 0.0), np.maximum(local[:, 1], 0.0)))


def nearest_surface_point(item: Item, xy: Float) -> Float:
    """The footprint's points (N, 2) nearest to given points (N, 2)."""
    half = np.array([item.size[0] / 2, item.size[1] / 2])
    local = np.clip(item_local(item, xy), -half, half)
    c, s = math.cos(item.yaw_rad), math.sin(item.yaw_rad)
    return np.stack([item.x + c * local[:, 0] - s * local[:, 1], item.y + s * local[:, 0] + c * local[:, 1]], axis=1)


class Footprints:
    """The footprints of some items as arrays, for distances to many of them at once.

    Args:
        items: of one storey.
    """

    def __init__(self, items: tuple[Item, ...]) -> None:
        self.items = items
        self.centre = np.array([[i.x, i.y] for i in items]).reshape(-1, 1, 2)
        self.half = np.array([[i.size[0] / 2, i.size[1] / 2] for i in items]).reshape(-1, 1, 2)
        self._c = np.array([math.cos(i.yaw_rad) for i in items]).reshape(-1, 1)
        self._s = np.array([math.sin(i.yaw_rad) for i in items]).reshape(-1, 1)

    def near(self, points: Float, within_m: float) -> NDArray[np.int64]:
        """Indices of the footprints that may lie within a distance of some of the points (N, 2)."""
        low, high = points.min(axis=0) - within_m, points.max(axis=0) + within_m
        reach = np.hypot(self.half[..., 0], self.half[..., 1])
        inside = np.all((self.centre[:, 0] + reach >= low) & (self.centre[:, 0] - reach <= high), axis=1)
        return np.flatnonzero(inside)

    def nearest(self, index: NDArray[np.int64], points: Float) -> tuple[Float, Float]:
        """Distances of points to footprints, 0 inside, and the nearest points of these.

        Args:
            index: (I,) footprints.
            points: (N, 2) for all of them, or (I, N, 2).

        Returns:
            (I, N) and (I, N, 2).
        """
        c, s, centre, half = self._c[index], self._s[index], self.centre[index], self.half[index]
        dx, dy = points[..., 0] - centre[..., 0], points[..., 1] - centre[..., 1]
        u, v = c * dx + s * dy, c * dy - s * dx
        x, y = (np.minimum(np.maximum(w, -half[..., i]), half[..., i]) for i, w in ((0, u), (1, v)))
        spot = np.stack([c * x - s * y + centre[..., 0], s * x + c * y + centre[..., 1]], axis=-1)
        return np.hypot(u - x, v - y), spot
