"""Square pictures of the map, axis-aligned or heading-up: what renderers draw from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.mapping.cells import FREE_EVIDENCE
from spacevln.mapping.floors import Floor
from spacevln.mapping.tiles import TiledLayer
from spacevln.mapping.traces import Trace

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class MapCrop:
    """A square of the map as an image: row 0 lies farthest along ``up_rad``, columns run to its right.

    Args:
        centre_xy_m: point in the middle.
        size_m: side length.
        up_rad: direction of the image's upper edge; pi/2 when axis-aligned (x to the right, y up).
        resolution_m: side of a pixel.
        explored, obstacle, free: (n, n) bool.
        trajectory, stage_trajectory: (n, n) bool, the episode's and the stage's way on this floor, one pixel wide.
        semantic: per landmark term, (n, n) bool.
    """

    centre_xy_m: tuple[float, float]
    size_m: float
    up_rad: float
    resolution_m: float
    explored: Mask
    obstacle: Mask
    free: Mask
    trajectory: Mask
    stage_trajectory: Mask
    semantic: dict[str, Mask]

    def to_px(self, xy_m: ArrayLike) -> Float:
        """Points (N, 2) [m] as (column, row), the first pixel's centre at (0, 0)."""
        return points_to_px(
            np.asarray(xy_m, np.float64).reshape(-1, 2), self.centre_xy_m, self.up_rad, self.resolution_m, len(self.free)
        )

    def to_xy(self, px: ArrayLike) -> Float:
        """(column, row) as points [m]; inverse of :meth:`to_px`."""
        pixels = np.asarray(px, np.float64).reshape(-1, 2)
        half = (len(self.free) - 1) / 2
        right, ahead = (pixels[:, 0] - half) * self.resolution_m, (half - pixels[:, 1]) * self.resolution_m
        c, s = math.cos(self.up_rad), math.sin(self.up_rad)
        x, y = self.centre_xy_m
        return np.column_stack([x + ahead * c + right * s, y + ahead * s - right * c])


def points_to_px(points: Float, centre: tuple[float, float], up_rad: float, resolution_m: float, n: int) -> Float:
    """See :meth:`MapCrop.to_px`."""
    c, s = math.cos(up_rad), math.sin(up_rad)
    dx, dy = points[:, 0] - centre[0], points[:, 1] - centre[1]
    half = (n - 1) / 2
    return np.column_stack([half + (dx * s - dy * c) / resolution_m, half - (dx * c + dy * s) / resolution_m])


def crop_floor(
    floor: Floor, trace: Trace, centre: tuple[float, float], size_m: float, heading_rad: float | None, resolution_m: float
) -> MapCrop:
    """Compose a crop of one floor."""
    n = max(1, round(size_m / resolution_m))
    up_rad = math.pi / 2 if heading_rad is None else heading_rad
    c, s = math.cos(up_rad), math.sin(up_rad)
    reach = math.ceil(n / 2 * (abs(c) + abs(s))) + 2
    i0, j0 = math.floor(centre[0] / resolution_m) - reach, math.floor(centre[1] / resolution_m) - reach
    offset = centre[0] / resolution_m - i0, centre[1] / resolution_m - j0

    def window(layer: TiledLayer) -> NDArray[np.uint8]:
        return layer.window(i0, j0, 2 * reach, 2 * reach)

    def turned(window: NDArray[np.uint8]) -> NDArray[np.uint8]:
        return np.asarray(_turn(window, n, offset[0], offset[1], c, s))

    # Three masks share the bits of one image: turning costs more than all else.
    explored, obstacle, free = _split(turned(_packed(window(floor.seen), window(floor.solid))))
    return MapCrop(
        centre_xy_m=centre,
        size_m=size_m,
        up_rad=up_rad,
        resolution_m=resolution_m,
        explored=explored,
        obstacle=obstacle,
        free=free,
        trajectory=_draw(trace.episode, floor.id, centre, up_rad, resolution_m, n),
        stage_trajectory=_draw(trace.stage, floor.id, centre, up_rad, resolution_m, n),
        semantic={term: turned(window(layer)) != 0 for term, layer in sorted(floor.semantic.items())},
    )


def _draw(trace: Float, floor: int, centre: tuple[float, float], up_rad: float, resolution_m: float, n: int) -> Mask:
    """The parts of a trace on one floor as lines."""
    image = np.zeros((n, n), np.uint8)
    px = points_to_px(trace[:, :2], centre, up_rad, resolution_m, n)
    here = (trace[:, 2] == floor) & (np.abs(px - n / 2) < 2 * n).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], here, [False]])))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        cv2.polylines(image, [np.rint(px[first:end]).astype(np.int32)], False, 1)
    return np.asarray(image != 0)


@numba.njit(cache=True)
def _packed(seen: NDArray[np.uint8], solid: NDArray[np.uint8]) -> Any:  # pragma: no cover - compiled
    """Bits of every cell: 1 explored, 2 obstacle, 4 free floor."""
    out = np.empty(seen.shape, np.uint8)
    flags, bins, bits = seen.ravel(), solid.ravel(), out.ravel()
    for k in range(len(bits)):
        free = (flags[k] & FREE_EVIDENCE != 0) & (bins[k] == 0)
        bits[k] = np.uint8(flags[k] != 0) | np.uint8(bins[k] != 0) << 1 | np.uint8(free) << 2
    return out


@numba.njit(cache=True)
def _split(image: NDArray[np.uint8]) -> Any:  # pragma: no cover - compiled
    """One mask per bit of :func:`_packed`."""
    masks = np.empty(image.shape, np.bool_), np.empty(image.shape, np.bool_), np.empty(image.shape, np.bool_)
    bits, explored, obstacle, free = image.ravel(), masks[0].ravel(), masks[1].ravel(), masks[2].ravel()
    for k in range(len(bits)):
        explored[k] = bits[k] & 1 != 0
        obstacle[k] = bits[k] & 2 != 0
        free[k] = bits[k] & 4 != 0
    return masks


@numba.njit(cache=True)
def _turn(
    window: NDArray[np.uint8], n: int, centre_i: float, centre_j: float, c: float, s: float
) -> Any:  # pragma: no cover - compiled
    """Nearest-neighbour image (n, n) of a window, rows against the direction (c, s), columns to its right."""
    out = np.empty((n, n), np.uint8)
    cells = window.ravel()
    width = np.int64(window.shape[1])
    half = (n - 1) / 2
    # Fixed point with 32 fractional bits: a pixel costs two additions and two shifts.
    unit = 4294967296.0
    step_i, step_j = np.int64(s * unit), np.int64(-c * unit)
    for row in range(n):
        ahead = half - row
        i = np.int64((centre_i + ahead * c - half * s) * unit)
        j = np.int64((centre_j + ahead * s + half * c) * unit)
        for column in range(n):
            out[row, column] = cells[(i >> 32) * width + (j >> 32)]
            i += step_i
            j += step_j
    return out
