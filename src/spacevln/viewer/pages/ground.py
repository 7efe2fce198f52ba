"""The final map as a layer that a page can uncover step by step."""

from __future__ import annotations

import base64
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from spacevln.core import Pose, RecordError
from spacevln.recording.schema import FloorMapLine

SIGHT_M = 5.0
"""How far depth is used (docs/defaults.md)."""
HALF_VIEW_RAD = math.radians(39.5)
RAYS = 61
MARGIN_CELLS = 16
SAME_FLOOR_M = 1.3

Bytes = NDArray[np.uint8]


def layer(directory: Path, line: FloorMapLine, poses: list[Pose], floor_z_m: float) -> dict[str, Any]:
    """One floor for a page: a picture whose red holds the cell (2 bits) and the high bits of the step that uncovers it, whose
    green holds the region and whose blue holds the low bits of that step.

    The record has the final map only; a cell is uncovered by the first pose from which a line of sight on that map reaches it,
    and what no line reaches with its nearest neighbour. Row 0 is the northernmost.

    Args:
        directory: of the episode's record.
        line: the recorded floor.
        poses: after every step, from the start.
        floor_z_m: height of the floor.

    Raises:
        RecordError: the picture cannot be read.
    """
    raw = cv2.imread(str(directory / line.image), cv2.IMREAD_COLOR)
    if raw is None:
        raise RecordError(f"Cannot read the map {line.image!r} of {str(directory)!r}: copy the record whole.")
    channels = np.asarray(raw, np.uint8)
    cells, regions, origin_m = _trim(channels[..., 2], channels[..., 1], line)
    here = [(step, pose) for step, pose in enumerate(poses) if abs(pose.z_m - floor_z_m) < SAME_FLOOR_M]
    seen = first_seen(cells, line.resolution_m, origin_m, here)
    packed = np.dstack([seen & 255, regions, cells + ((seen >> 8) << 2).astype(np.uint8)]).astype(np.uint8)  # B, G, R
    ok, data = cv2.imencode(".png", np.ascontiguousarray(packed[::-1]))
    if not ok:
        raise RecordError(f"Cannot encode the map {line.image!r} of {str(directory)!r}.")
    return {
        "floor": line.floor,
        "resolution": line.resolution_m,
        "origin": [round(value, 3) for value in origin_m],
        "width": cells.shape[1],
        "height": cells.shape[0],
        "focus": _focus(cells, regions, origin_m, line.resolution_m),
        "names": list(line.region_names),
        "picture": "data:image/png;base64," + base64.b64encode(data.tobytes()).decode(),
        "z": round(floor_z_m, 3),
    }


def _trim(cells: Bytes, regions: Bytes, line: FloorMapLine) -> tuple[Bytes, Bytes, tuple[float, float]]:
    """Without the unknown border."""
    known = np.argwhere(cells > 0)
    if not len(known):
        return cells, regions, line.origin_m
    low = np.maximum(known.min(axis=0) - MARGIN_CELLS, 0)
    high = np.minimum(known.max(axis=0) + MARGIN_CELLS + 1, cells.shape)
    part = (slice(int(low[0]), int(high[0])), slice(int(low[1]), int(high[1])))
    x_m, y_m = line.origin_m
    origin_m = (x_m + float(low[1]) * line.resolution_m, y_m + float(low[0]) * line.resolution_m)
    return cells[part], regions[part], origin_m


def _focus(cells: Bytes, regions: Bytes, origin_m: tuple[float, float], resolution_m: float) -> list[float]:
    """The rectangle worth showing large, (x0, y0, x1, y1): the regions, not what was glimpsed beyond windows and far doors."""
    inside = np.argwhere(regions > 0) if (regions > 0).any() else np.argwhere(cells > 0)
    if not len(inside):
        inside = np.array([[0, 0], cells.shape])
    low, high = inside.min(axis=0), inside.max(axis=0) + 1
    corners_m = np.array(origin_m) + np.array([low[::-1], high[::-1]]) * resolution_m
    return [round(float(value), 3) for value in corners_m.ravel()]


def first_seen(
    cells: Bytes, resolution_m: float, origin_m: tuple[float, float], poses: list[tuple[int, Pose]]
) -> NDArray[np.int64]:
    """The step at which each cell (H, W) comes into sight; 0 for every cell where there is no pose."""
    never = np.iinfo(np.int64).max
    seen = np.full(cells.shape, never, np.int64)
    reach_m = np.arange(0.0, SIGHT_M, resolution_m * 0.9)
    offsets_rad = np.linspace(-HALF_VIEW_RAD, HALF_VIEW_RAD, RAYS)
    last: Pose | None = None
    for step, pose in poses:
        if last is not None and pose == last:
            continue
        last = pose
        angles = pose.yaw_rad + offsets_rad
        i = np.floor((pose.y_m + np.sin(angles)[:, None] * reach_m - origin_m[1]) / resolution_m).astype(np.int64)
        j = np.floor((pose.x_m + np.cos(angles)[:, None] * reach_m - origin_m[0]) / resolution_m).astype(np.int64)
        inside = (i >= 0) & (i < cells.shape[0]) & (j >= 0) & (j < cells.shape[1])
        i, j = np.where(inside, i, 0), np.where(inside, j, 0)
        walls = inside & (cells[i, j] == 2)
        behind = np.cumsum(walls, axis=1) - walls > 1  # a wall is seen two cells deep
        free = inside & ~behind
        np.minimum.at(seen, (i[free], j[free]), step)
    reached = (seen < never) & (cells > 0)
    if not reached.any():
        return np.zeros(cells.shape, np.int64)
    nearest = ndimage.distance_transform_edt(~reached, return_distances=False, return_indices=True)
    return np.asarray(seen[tuple(nearest)], np.int64)
