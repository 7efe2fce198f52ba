"""Lift detections to the episode frame with depth (paper, "Local Landmark Memory": detections are projected with depth).

A solid's place comes from the inside of its mask, away from the border where depth bleeds. An opening has no surface of its
own: its place is the threshold between its jambs, and it is a way through when depth goes on beyond them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core import CueKind, Detection, Observation, Sighting
from spacevln.core.geometry import Float
from spacevln.language import cue_kind as read_cue_kind
from spacevln.language.names import plain_name

MIN_PIXELS = 6  # with depth, inside the mask
MIN_VALID_SHARE = 0.1  # of the mask's pixels that must have depth
LOOKED_AT = 12000  # pixels of a box, at most
SAMPLES = 300  # of them used for a place
INSET_SHARE = 0.08  # of the box's smaller side, between 1 and 8 px
NEAREST_PERCENTILE = 5.0
SURFACE_POINTS = 8
RELIEF_TRIED, RELIEF_POINTS = 2000, 150  # of stairs
RELIEF_PX = 2  # normals are taken over this many pixels to each side
SMOOTH_M = 0.01  # a surface that bends more within them is an edge
PASSAGE_DEPTH_M = 0.4  # depth beyond the jambs that makes an opening a passage [ours]
HOLLOW_SHARE = 0.3  # of the middle of the box that the mask of a frame may cover

SPECK = np.ones((3, 3), np.uint8)  # holes that it covers do not count as an edge of the mask
cue_kind = lru_cache(maxsize=4096)(read_cue_kind)
_SHARES = np.linspace(0.0, 1.0, SURFACE_POINTS)
_DIRECTIONS = np.array([[math.cos(angle), math.sin(angle)] for angle in np.arange(8) * math.pi / 8])


def lift(observation: Observation, detections: Sequence[Detection]) -> tuple[Sighting, ...]:
    """Sightings of the detections whose mask holds depth, in the same order; the others are dropped.

    Args:
        observation: image the detections were found in; depth 0, NaN and inf count as no measurement.
        detections: with or without masks.
    """
    lifted = []
    for detection in detections:
        opening = cue_kind(detection.category) is CueKind.OPENING
        sighting = _lift_opening(observation, detection) if opening else None
        sighting = sighting or _lift_solid(observation, detection)
        if sighting is not None:
            lifted.append(sighting)
    return tuple(lifted)


def _lift_solid(observation: Observation, detection: Detection) -> Sighting | None:
    sampled = _sample(observation.depth_m, detection)
    if sampled is None:
        return None
    u, v, depth, pixels = sampled
    spread = np.abs(depth - _median(depth))
    (kept,) = np.nonzero(spread <= 3 * _median(spread) + 0.15)
    points = _to_world(observation, u[kept], v[kept], depth[kept])
    middle = len(points) // 2
    sighting = _sighting(observation, detection, np.partition(points, middle, axis=0)[middle], points, pixels)
    if cue_kind(detection.category) is not CueKind.STAIRS:
        return sighting
    return replace(sighting, relief=_relief(observation, detection))


def _relief(observation: Observation, detection: Detection) -> tuple[tuple[float, float, float, float, float, float], ...]:
    """Points and normals where the surface is smooth: steps, but neither their edges nor the posts of a railing."""
    depth = observation.depth_m
    height, width = depth.shape
    x0, y0, x1, y1 = detection.box_px
    mask = detection.mask if detection.mask is not None else _centre((y1 - y0, x1 - x0))
    row, column = np.nonzero(mask & (depth[y0:y1, x0:x1] > 0) & (depth[y0:y1, x0:x1] < np.inf))
    stride = max(1, len(row) // RELIEF_TRIED)
    row, column = row[::stride] + y0, column[::stride] + x0
    inside = (column >= RELIEF_PX) & (column < width - RELIEF_PX) & (row >= RELIEF_PX) & (row < height - RELIEF_PX)
    row, column = row[inside], column[inside]

    def at(i: int, j: int) -> Float:
        return _to_world(observation, column + i, row + j, depth[row + j, column + i].astype(np.float64))

    middle = at(0, 0)
    left, right, above, below = at(-RELIEF_PX, 0), at(RELIEF_PX, 0), at(0, -RELIEF_PX), at(0, RELIEF_PX)
    bend = np.maximum(np.abs(left + right - 2 * middle).max(axis=1), np.abs(above + below - 2 * middle).max(axis=1))
    normals = np.cross(above - below, right - left)
    length = np.sqrt((normals**2).sum(axis=1))
    smooth = (bend < SMOOTH_M) & (length > 0)
    points, normals = middle[smooth], normals[smooth] / length[smooth, None]
    away = ((points - observation.T_world_camera[:3, 3]) * normals).sum(axis=1) > 0
    normals[away] *= -1.0  # out of the surface, towards the eye
    kept = np.hstack([points, normals])[:: max(1, len(points) // RELIEF_POINTS)]
    return tuple(map(tuple, kept.tolist()))


def _lift_opening(observation: Observation, detection: Detection) -> Sighting | None:
    """Threshold from jamb to jamb; None when no jamb has depth."""
    profile, u0 = _profile(observation.depth_m, detection.box_px)
    side = max(2, len(profile) // 5)
    if len(profile) < 3 * side:
        return None
    frame = profile
    if detection.mask is not None and _is_hollow(detection.mask):  # the mask is the frame itself: trust no other pixels
        frame, _ = _profile(observation.depth_m, detection.box_px, detection.mask)
    ends = [_jamb(frame[:side], u0), _jamb(frame[-side:], u0 + len(frame) - side)]
    nearest = min(depth for depth, _ in ends)
    cut = (u0 <= 0, u0 + len(profile) >= observation.camera.width_px)  # there the image ends, not the opening
    ends = [end for end, is_cut in zip(ends, cut, strict=True) if end[0] < (nearest + 1.0 if is_cut else math.inf)]
    if not ends:
        return None
    depths, columns = np.array(ends).T
    row = (detection.box_px[1] + detection.box_px[3]) / 2
    jambs = _to_world(observation, columns, np.full(len(ends), row), depths)
    inner = profile[side:-side]
    beyond = float(np.median(np.where(np.isfinite(inner), inner, np.inf)))
    is_passage = len(ends) == 2 and beyond > depths.max() + PASSAGE_DEPTH_M
    pixels = int(np.count_nonzero(detection.mask if detection.mask is not None else np.isfinite(profile)))
    threshold = jambs[:1] + _SHARES[:, None] * (jambs[-1:] - jambs[:1])
    return _sighting(observation, detection, jambs.mean(axis=0), threshold, pixels, is_passage)


def _sighting(
    observation: Observation, detection: Detection, centre: Float, points: Float, pixels: int, is_passage: bool = False
) -> Sighting:
    eye = observation.T_world_camera[:2, 3]
    xy = points[:, :2]
    ranges = np.hypot(xy[:, 0] - eye[0], xy[:, 1] - eye[1])
    low, high = len(xy) // 40, len(xy) - 1 - len(xy) // 40
    spans = np.partition(_DIRECTIONS @ xy.T, (low, high), axis=1)
    extent = float((spans[:, high] - spans[:, low]).max())
    near = int(len(ranges) * NEAREST_PERCENTILE / 100)
    nearest = float(np.partition(ranges, near)[near])
    surface = xy if len(xy) <= SURFACE_POINTS else _nearest_by_direction(xy, eye, ranges)
    return Sighting(
        category=plain_name(detection.category),
        confidence=detection.confidence,
        box_px=detection.box_px,
        position_m=(float(centre[0]), float(centre[1]), float(centre[2])),
        distance_m=nearest,
        bearing_rad=observation.pose.bearing_rad(float(centre[0]), float(centre[1])),
        extent_m=extent,
        attributes=tuple(map(plain_name, detection.attributes)),
        is_passage=is_passage,
        pixels=pixels,
        surface_m=tuple(map(tuple, surface.tolist())),
    )


def _nearest_by_direction(xy: Float, eye: Float, ranges: Float) -> Float:
    """For each of a few directions from the eye, a near (not the very nearest: noise) surface point; left to right."""
    beyond = xy - eye
    ahead = xy.sum(axis=0) / len(xy) - eye
    across, along = beyond @ (-ahead[1], ahead[0]), beyond @ ahead
    order = np.argsort(-across / np.maximum(along, 1e-6), kind="stable")
    per_part = len(order) // SURFACE_POINTS
    parts = order[: per_part * SURFACE_POINTS].reshape(SURFACE_POINTS, per_part)
    by_range = np.argsort(ranges[parts], axis=1, kind="stable")[:, per_part // 20]
    return xy[parts[np.arange(SURFACE_POINTS), by_range]]


def _sample(depth_m: NDArray[np.float32], detection: Detection) -> tuple[Float, Float, Float, int] | None:
    """Columns, rows and depths of up to ``SAMPLES`` pixels well inside the mask, and how many mask pixels have depth."""
    x0, y0, x1, y1 = detection.box_px
    area = (x1 - x0) * (y1 - y0)
    if area <= 0:
        return None
    stride = math.ceil(math.sqrt(area / LOOKED_AT))  # of a large box not every pixel is needed
    window = depth_m[y0:y1:stride, x0:x1:stride]
    mask = (detection.mask if detection.mask is not None else _centre((y1 - y0, x1 - x0)))[::stride, ::stride]
    valid = mask & (window > 0) & (window < np.inf)
    pixels = int(np.count_nonzero(valid)) * stride * stride
    if pixels < MIN_PIXELS or pixels < MIN_VALID_SHARE * stride * stride * np.count_nonzero(mask):
        return None
    inset = int(min(max(round(INSET_SHARE * min(window.shape)), 1), 8))
    kernel = np.ones((2 * inset + 1, 2 * inset + 1), np.uint8)
    solid = valid.view(np.uint8)
    if np.count_nonzero(valid) < np.count_nonzero(mask):  # single pixels without depth are no rim
        solid = cv2.morphologyEx(solid, cv2.MORPH_CLOSE, SPECK) & mask.view(np.uint8)
    inner = cv2.erode(solid, kernel, borderType=cv2.BORDER_CONSTANT, borderValue=0).view(np.bool_) & valid
    chosen = inner if np.count_nonzero(inner) >= MIN_PIXELS else valid  # of a thin or small thing nothing lies that deep inside
    flat = np.flatnonzero(chosen)
    flat = flat[:: _stride(len(flat), int(np.count_nonzero(chosen.any(axis=0))))]
    rows, columns = np.divmod(flat, window.shape[1])
    depth = window[rows, columns].astype(np.float64)
    return columns * float(stride) + x0, rows * float(stride) + y0, depth, pixels


def _stride(count: int, columns: int) -> int:
    """A step that leaves about ``SAMPLES`` of so many pixels, and is never in time with rows of so many columns."""
    stride = max(1, count // SAMPLES)
    while math.gcd(stride, columns) > 1:
        stride -= 1
    return stride


def _median(values: Float) -> float:
    """Middle value; faster than numpy's for a few hundred."""
    return float(np.partition(values, len(values) // 2)[len(values) // 2])


def _centre(shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """The middle half of a box that has no mask."""
    mask = np.zeros(shape, np.bool_)
    height, width = shape
    mask[height // 4 : height - height // 4, width // 4 : width - width // 4] = True
    return mask


def _profile(
    depth_m: NDArray[np.float32], box_px: tuple[int, int, int, int], mask: NDArray[np.bool_] | None = None
) -> tuple[Float, int]:
    """Median depth of each column across the box and a little beyond (NaN = none), and the first column.

    The middle third of the height is read, neither lintel nor floor; of the box only the mask, where one is given.
    """
    x0, y0, x1, y1 = box_px
    beside = max(2, (x1 - x0) // 12)
    first, last = max(x0 - beside, 0), min(x1 + beside, depth_m.shape[1])
    third = (y1 - y0) // 3
    rows = np.arange(y0 + third, max(y1 - third, y0 + third + 1))
    rows = rows[:: max(1, len(rows) // 9)]
    band = depth_m[rows, first:last].astype(np.float64)
    band = np.where((band > 0) & (band < np.inf), band, np.nan)
    if mask is not None:
        band[:, : x0 - first] = band[:, x1 - first :] = np.nan
        band[:, x0 - first : x1 - first][~mask[rows - y0]] = np.nan
    ordered = np.sort(band, axis=0)  # NaN sorts last
    middle = np.maximum(np.isfinite(band).sum(axis=0) - 1, 0) // 2
    return ordered[middle, np.arange(band.shape[1])], first


def _is_hollow(mask: NDArray[np.bool_]) -> bool:
    """Whether a mask leaves out the middle of its box, as the mask of a door's frame does."""
    height, width = mask.shape
    middle = mask[height // 3 : height - height // 3, width // 4 : width - width // 4]
    return middle.size > 0 and int(np.count_nonzero(middle)) < HOLLOW_SHARE * middle.size


def _jamb(columns: Float, offset: int) -> tuple[float, float]:
    """Depth of the nearest surface at one side of the profile and its column; inf when nothing was measured there."""
    measured = columns[np.isfinite(columns)]
    if not len(measured):
        return math.inf, float(offset)
    nearest = float(measured.min())
    near = np.flatnonzero(columns <= nearest + 0.1)
    return nearest, offset + float(near.mean())


def _to_world(observation: Observation, u: Float, v: Float, depth: Float) -> Float:
    """Pixels (u, v: column and row) with depth as points (N, 3) of the episode frame."""
    camera = observation.camera
    points = np.empty((len(depth), 3))  # forward, left, up
    points[:, 0] = depth
    points[:, 1] = -(u + 0.5 - camera.cx_px) / camera.fx_px * depth
    points[:, 2] = -(v + 0.5 - camera.cy_px) / camera.fy_px * depth
    T = observation.T_world_camera
    return points @ T[:3, :3].T + T[:3, 3]
