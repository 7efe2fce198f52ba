"""The rendered map mu_k: heading-up, agent-centred, regions coloured and labelled (paper appendix, "map rendering")."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from spacevln.core import Pose, SpatialWaypoint
from spacevln.core.geometry import Float
from spacevln.memory import map_marks as marks
from spacevln.memory.map_marks import (
    AGENT,
    FRAME,
    FREE,
    INK,
    LEGEND_PX,
    OBSTACLE,
    REGIONS,
    SIZE_PX,
    THRESHOLD,
    UNKNOWN,
    WALKED,
    Box,
)
from spacevln.memory.metric import MemoryMap
from spacevln.memory.region_raster import region_raster as region_raster  # also for those who draw other maps
from spacevln.memory.regions import CELL_M

if TYPE_CHECKING:
    from spacevln.memory.hierarchical import HierarchicalSpatialMemory

WINDOW_M = (8.0, 24.0)  # side of the drawn square: what is known, within these bounds
MARGIN_M = 0.6

_AGENT_BOX: Box = (SIZE_PX / 2 - 14, SIZE_PX / 2 - 18, SIZE_PX / 2 + 14, SIZE_PX / 2 + 14)


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where world points lie in the picture."""

    pose: Pose
    window_m: float

    @property
    def scale(self) -> float:
        """Pixels per metre."""
        return SIZE_PX / self.window_m

    def pixels(self, xy_m: Float) -> Float:
        """(N, 2) world points as (u, v)."""
        c, s = math.cos(self.pose.yaw_rad), math.sin(self.pose.yaw_rad)
        d = np.asarray(xy_m, np.float64).reshape(-1, 2) - self.pose.xy_m
        ahead, left = d @ (c, s), d @ (-s, c)
        return np.stack([SIZE_PX / 2 - left * self.scale, SIZE_PX / 2 - ahead * self.scale], axis=1)


def render_map(
    memory: HierarchicalSpatialMemory, pose: Pose, metric_map: MemoryMap, shown: Sequence[SpatialWaypoint]
) -> NDArray[np.uint8]:
    """Draw mu_k for the current floor, shape (480, 440, 3) RGB; the lowest 40 rows are the legend.

    Args:
        memory: regions and thresholds.
        pose: in the middle, looking up.
        metric_map: what is explored, free, an obstacle, and the walked way.
        shown: the waypoints that get a mark with their number (overlapping ones already merged).
    """
    crop = metric_map.crop(pose.xy_m, WINDOW_M[1], pose.yaw_rad)
    frame = _Frame(pose, _window(crop.explored))
    floor = metric_map.floor
    labels = _region_labels(memory, frame, floor)
    canvas = _paint(
        _zoomed(crop.free, frame.window_m),
        _zoomed(crop.obstacle, frame.window_m),
        labels,
        _palette(len(memory.regions.all)),
        np.array(UNKNOWN, np.float32),
        np.array(OBSTACLE, np.float32),
    )
    _draw_ways(canvas, memory, metric_map.travelled, frame, floor)
    picture = Image.new("RGB", (SIZE_PX, SIZE_PX + LEGEND_PX))
    picture.paste(Image.fromarray(canvas))
    picture.paste(marks.legend(), (0, SIZE_PX))
    taken = _draw_waypoints(picture, [waypoint for waypoint in shown if waypoint.floor == floor], frame)
    _draw_region_names(picture, memory, labels, taken)
    _draw_border(picture, frame)
    return np.array(picture)


def _window(explored: NDArray[np.bool_]) -> float:
    """Side of the square that holds all that is known."""
    side = len(explored)
    rows, columns = np.flatnonzero(explored.any(axis=1)), np.flatnonzero(explored.any(axis=0))
    if len(rows) == 0:
        return WINDOW_M[0]
    middle = (side - 1) / 2
    reach = max(middle - rows[0], rows[-1] - middle, middle - columns[0], columns[-1] - middle) / side * WINDOW_M[1]
    return float(min(max(2 * (reach + MARGIN_M), WINDOW_M[0]), WINDOW_M[1]))


def _zoomed(mask: NDArray[np.bool_], window_m: float) -> NDArray[np.float32]:
    """The middle ``window_m`` of a 24 m mask as opacity (0 to 1) with smooth borders."""
    side = len(mask)
    kept = max(2, round(side * window_m / WINDOW_M[1]))
    first = (side - kept) // 2
    part = np.ascontiguousarray(mask[first : first + kept, first : first + kept], np.uint8).astype(np.float32)
    soft = cv2.resize(part, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_LINEAR)
    sharpness = max(1.0, SIZE_PX / kept)
    return np.asarray(np.clip((soft - 0.5) * sharpness + 0.5, 0.0, 1.0), np.float32)


@njit(cache=True)
def _paint(
    free: NDArray[np.float32],
    obstacle: NDArray[np.float32],
    labels: NDArray[np.uint8],
    palette: NDArray[np.float32],
    unknown: NDArray[np.float32],
    solid: NDArray[np.float32],
) -> NDArray[np.uint8]:  # pragma: no cover - compiled
    """Lay floor, in the colour of its region, and obstacles over the unknown; opacities from 0 to 1."""
    height, width = free.shape
    canvas = np.empty((height, width, 3), np.uint8)
    for v in range(height):
        for u in range(width):
            a, o = free[v, u], obstacle[v, u]
            if a + o == 0:
                canvas[v, u, 0], canvas[v, u, 1], canvas[v, u, 2] = unknown[0], unknown[1], unknown[2]
                continue
            for channel in range(3):
                value = unknown[channel] * (1 - a) + palette[labels[v, u], channel] * a
                canvas[v, u, channel] = np.uint8(value * (1 - o) + solid[channel] * o + np.float32(0.5))
    return canvas


def _palette(count: int) -> NDArray[np.float32]:
    """Colour of every label; label 0 is no region."""
    return np.array([FREE, *(REGIONS[index % len(REGIONS)] for index in range(count))], np.float32)


def _region_labels(memory: HierarchicalSpatialMemory, frame: _Frame, floor: int) -> NDArray[np.uint8]:
    """1 + index of the region at every pixel, 0 where there is none; a floor cell belongs to its nearest waypoint's region."""
    raster = region_raster(memory, floor)
    if raster is None:
        return np.zeros((SIZE_PX, SIZE_PX), np.uint8)
    owner, i0, j0 = raster
    c, s = math.cos(frame.pose.yaw_rad), math.sin(frame.pose.yaw_rad)
    k, half = 1 / (frame.scale * CELL_M), (SIZE_PX - 1) / 2
    along_x, along_y = (s * k, -c * k), (-c * k, -s * k)  # change of (x, y) cells per pixel of u and of v
    x0 = frame.pose.x_m / CELL_M - i0 - 0.5 - half * (along_x[0] + along_x[1])
    y0 = frame.pose.y_m / CELL_M - j0 - 0.5 - half * (along_y[0] + along_y[1])
    to_source = np.array([[along_y[0], along_y[1], y0], [along_x[0], along_x[1], x0]])
    flags = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    labels = cv2.warpAffine(owner, to_source, (SIZE_PX, SIZE_PX), flags=flags, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    return np.asarray(cv2.medianBlur(labels, 5), np.uint8)


def _draw_ways(canvas: NDArray[np.uint8], memory: HierarchicalSpatialMemory, travelled: Float, frame: _Frame, floor: int) -> None:
    """Thresholds, the walked way and the agent, with smooth lines."""
    for threshold in memory.thresholds.on(floor):
        ends = np.round(frame.pixels(np.array([threshold.a_m, threshold.b_m])) * 8).astype(np.int32)
        cv2.line(canvas, ends[0].tolist(), ends[1].tolist(), THRESHOLD, 4, cv2.LINE_AA, 3)
    points = np.round(frame.pixels(travelled[:, :2]) * 8).astype(np.int32)
    on_floor = travelled[:, 2] == floor
    breaks = np.flatnonzero(np.diff(on_floor)) + 1
    for part, keep in zip(np.split(points, breaks), np.split(on_floor, breaks), strict=True):
        if len(part) > 1 and keep[0]:
            cv2.polylines(canvas, [part], False, WALKED, 3, cv2.LINE_AA, 3)
    _draw_agent(canvas)


def _draw_agent(canvas: NDArray[np.uint8]) -> None:
    shape = np.array([[0, -15], [10, 11], [0, 5], [-10, 11]]) + SIZE_PX / 2
    for grown, colour in ((1.35, (255, 255, 255)), (1.0, AGENT)):
        corners = np.round(((shape - SIZE_PX / 2) * grown + SIZE_PX / 2) * 8).astype(np.int32)
        cv2.fillPoly(canvas, [corners], colour, cv2.LINE_AA, 3)


def _draw_region_names(
    picture: Image.Image, memory: HierarchicalSpatialMemory, labels: NDArray[np.uint8], taken: list[Box]
) -> None:
    """A name on every region, as near to its middle as the agent, waypoints and other names leave room."""
    coarse = labels[::4, ::4]
    for index, region in enumerate(memory.regions.all):
        rows, columns = np.nonzero(coarse == index + 1)
        if len(rows) < 12:
            continue
        name = marks.tag(region.label, REGIONS[index % len(REGIONS)])
        u, v = _place(np.stack([columns, rows], axis=1).astype(np.float64) * 4, name.width, name.height, np.array(taken))
        taken.append((u, v, u + name.width, v + name.height))
        picture.paste(name, (u, v), name)


def _place(inside: Float, width: int, height: int, taken: Float) -> tuple[int, int]:
    """Upper left corner for a plate whose middle is one of the points ``inside`` (N, 2), the best of them."""
    spots = inside[:: max(1, len(inside) // 150)]
    low = np.clip(np.rint(spots - (width / 2, height / 2)), 2, (SIZE_PX - width - 2, SIZE_PX - height - 2))
    u, v = low[_freest(low, width, height, taken, np.hypot(*(spots - np.median(inside, axis=0)).T))]
    return int(u), int(v)


@njit(cache=True)
def _freest(low: Float, width: int, height: int, taken: Float, away: Float) -> int:  # pragma: no cover - compiled
    """Which of the plates with upper left corners ``low`` (N, 2) covers least of the boxes and is least ``away``."""
    best, cheapest = 0, np.inf
    for k in range(len(low)):
        cost = away[k]
        for b in range(len(taken)):
            across = min(low[k, 0] + width, taken[b, 2]) - max(low[k, 0], taken[b, 0])
            down = min(low[k, 1] + height, taken[b, 3]) - max(low[k, 1], taken[b, 1])
            if across > 0 and down > 0:
                cost += across * down * (10 if b == 0 else 1)  # the agent above all
        if cost < cheapest:
            best, cheapest = k, cost
    return best


def _draw_waypoints(picture: Image.Image, shown: Sequence[SpatialWaypoint], frame: _Frame) -> list[Box]:
    """Numbered rings; returns the boxes they and the agent cover."""
    middle = SIZE_PX / 2
    taken: list[Box] = [_AGENT_BOX, *marks.DIRECTION_BOXES]
    if not shown:
        return taken
    at = frame.pixels(np.array([[waypoint.pose.x_m, waypoint.pose.y_m] for waypoint in shown]))
    for waypoint, (u, v) in zip(shown, at.tolist(), strict=True):
        inside = 8 < u < SIZE_PX - 8 and 8 < v < SIZE_PX - 8
        if not inside or math.hypot(u - middle, v - middle) < 14:
            continue  # outside, or under the agent
        ring = marks.ring(waypoint.index)
        corner = (round(u - ring.width / 2), round(v - ring.height / 2))
        picture.paste(ring, corner, ring)
        taken.append((*corner, corner[0] + ring.width, corner[1] + ring.height))
    return taken


def _draw_border(picture: Image.Image, frame: _Frame) -> None:
    """Directions, scale and frame."""
    for word, corner in marks.directions():
        picture.paste(word, corner, word)
    draw = ImageDraw.Draw(picture)
    y = SIZE_PX - 10
    draw.line((SIZE_PX - 10 - 2 * frame.scale, y, SIZE_PX - 10, y), fill=INK, width=2)
    scale = marks.outlined("2 m")
    picture.paste(scale, (round(SIZE_PX - 10 - frame.scale - scale.width / 2), y - 3 - scale.height), scale)
    draw.rectangle((0, 0, SIZE_PX - 1, SIZE_PX + LEGEND_PX - 1), outline=FRAME)
