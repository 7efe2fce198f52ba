"""The picture at the end of a run: the agent's own map from above, with where it went and where it should have gone."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from spacevln.core import Pose, RecordError
from spacevln.recording import ResultFile, read_events, read_result
from spacevln.recording.schema import EpisodeStartedLine, FloorMapLine, MapSavedLine, StepTakenLine

SCALE_PX_PER_M = 64
MARGIN_M = 0.6
PANEL_MIN_PX = 760
UNKNOWN, FREE, OBSTACLE = (250, 250, 248), (228, 230, 232), (52, 56, 64)
REGION_COLOURS = (
    (255, 221, 179), (190, 224, 255), (203, 237, 200), (240, 208, 245), (255, 241, 171),
    (255, 205, 205), (200, 240, 238), (222, 214, 255), (230, 225, 205), (214, 228, 214),
)  # fmt: skip
WALKED, SHORTEST, START, GOAL = (106, 27, 154), (0, 137, 83), (25, 90, 200), (200, 30, 45)
INK, SOFT = (30, 32, 36), (110, 114, 120)
SAME_FLOOR_M = 1.3

_ToPixels = Callable[[NDArray[np.float64]], list[tuple[float, float]]]


@dataclass(frozen=True, slots=True)
class _Story:
    """What of the record the picture needs; points in the episode frame."""

    floors: tuple[FloorMapLine, ...]
    walked: NDArray[np.float64]  # (N, 3)
    shortest: NDArray[np.float64]  # (M, 3)
    goals: NDArray[np.float64]  # (G, 3)
    result: ResultFile | None
    task: str


def draw_topdown(directory: Path) -> Path:
    """Draw an episode's map from above.

    Args:
        directory: of the episode's record.

    Returns:
        The PNG, ``topdown.png`` in that directory.

    Raises:
        RecordError: the record is damaged or holds no map.
    """
    story = _read(directory)
    panels = [_panel(directory, story, floor) for floor in story.floors]
    width = max(PANEL_MIN_PX, sum(panel.width for panel in panels) + 24 * (len(panels) + 1))
    header = _header(story, width)
    sheet = Image.new("RGB", (width, header.height + max(panel.height for panel in panels) + 24), "white")
    sheet.paste(header, (0, 0))
    x = (width - sum(panel.width for panel in panels) - 24 * (len(panels) - 1)) // 2
    for panel in panels:
        sheet.paste(panel, (x, header.height))
        x += panel.width + 24
    path = directory / "topdown.png"
    sheet.save(path)
    return path


def _read(directory: Path) -> _Story:
    floors: tuple[FloorMapLine, ...] = ()
    walked: list[Pose] = []
    origin, task = Pose(0, 0), ""
    for line in read_events(directory):
        match line:
            case EpisodeStartedLine():
                origin, task = line.T_scene_episode, line.task_text
                walked.append(line.start.relative_to(origin))
            case StepTakenLine(pose=pose):
                walked.append(pose)
            case MapSavedLine():
                floors = line.floors
            case _:
                pass
    if not floors:
        raise RecordError(f"{str(directory)!r} holds no final map: the episode did not end, so there is nothing to draw.")
    result = read_result(directory)
    truth = result.truth if result else None
    shortest = _to_episode(np.array(truth.shortest_path if truth else []).reshape(-1, 3), origin)
    goals = _to_episode(np.array(truth.goals if truth else []).reshape(-1, 3), origin)
    return _Story(floors, np.array([pose.position_m for pose in walked]), shortest, goals, result, task)


def _to_episode(points: NDArray[np.float64], origin: Pose) -> NDArray[np.float64]:
    c, s = math.cos(origin.yaw_rad), math.sin(origin.yaw_rad)
    moved = points - origin.position_m
    return np.column_stack([c * moved[:, 0] + s * moved[:, 1], -s * moved[:, 0] + c * moved[:, 1], moved[:, 2]])


def _floor_z(story: _Story, index: int) -> float:
    """Height of a floor: where the agent walked on it. Floors are numbered by height, 0 is that of the start."""
    if index == 0:
        return 0.0
    heights = story.walked[:, 2]
    return float(heights.max() if index > 0 else heights.min())


def _panel(directory: Path, story: _Story, floor: FloorMapLine) -> Image.Image:
    raw = cv2.imread(str(directory / floor.image), cv2.IMREAD_COLOR)
    if raw is None:
        raise RecordError(f"Cannot read the map {floor.image!r} of {str(directory)!r}.")
    channels = np.asarray(raw, dtype=np.uint8)
    cells, regions = channels[..., 2], channels[..., 1]
    on_floor = _on_floor(story, floor)
    low, high = _window(cells, floor, on_floor)
    cells, regions = _crop(cells, low, high), _crop(regions, low, high)
    pixels = round(floor.resolution_m * SCALE_PX_PER_M)
    picture = np.repeat(np.repeat(_colour(cells, regions)[::-1], pixels, axis=0), pixels, axis=1)
    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image)
    left = floor.origin_m[0] + low[1] * floor.resolution_m
    top = floor.origin_m[1] + high[0] * floor.resolution_m
    scale = pixels / floor.resolution_m

    def to_px(points: NDArray[np.float64]) -> list[tuple[float, float]]:
        return [((x - left) * scale, (top - y) * scale) for x, y in points[:, :2]]

    _draw_regions(draw, floor, regions[::-1], pixels)
    _draw_paths(draw, to_px, on_floor)
    if len(story.floors) > 1:
        draw.text((8, 6), f"floor {floor.floor + 1}", fill=SOFT, font=_font(16))
    return image


@dataclass(frozen=True, slots=True)
class _OnFloor:
    walked: list[NDArray[np.float64]]
    shortest: list[NDArray[np.float64]]
    goals: NDArray[np.float64]
    start: bool
    end: bool

    @property
    def points(self) -> NDArray[np.float64]:
        return np.vstack([*self.walked, *self.shortest, self.goals, np.empty((0, 3))])


def _on_floor(story: _Story, floor: FloorMapLine) -> _OnFloor:
    z = _floor_z(story, floor.floor)
    return _OnFloor(
        walked=_runs(story.walked, z),
        shortest=_runs(story.shortest, z),
        goals=story.goals[np.abs(story.goals[:, 2] - z) < SAME_FLOOR_M],
        start=abs(story.walked[0, 2] - z) < SAME_FLOOR_M,
        end=abs(story.walked[-1, 2] - z) < SAME_FLOOR_M,
    )


def _runs(points: NDArray[np.float64], z: float) -> list[NDArray[np.float64]]:
    """The pieces of a path that lie on a floor."""
    near = np.abs(points[:, 2] - z) < SAME_FLOOR_M
    cuts = np.flatnonzero(np.diff(near.astype(int))) + 1
    return [piece for piece, flag in zip(np.split(points, cuts), np.split(near, cuts), strict=True) if len(flag) and flag[0]]


def _window(cells: NDArray[np.uint8], floor: FloorMapLine, on_floor: _OnFloor) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The rectangle of cells worth showing, possibly beyond the map: everything known and every path; (low, high) as ij."""
    known = np.argwhere(cells > 0)
    points = on_floor.points
    ij = (points[:, 1::-1] - np.array(floor.origin_m)[::-1]) / floor.resolution_m
    corners = np.vstack([known, ij])
    margin = MARGIN_M / floor.resolution_m
    return np.floor(corners.min(axis=0) - margin).astype(np.int64), np.ceil(corners.max(axis=0) + margin).astype(np.int64)


def _crop(grid: NDArray[np.uint8], low: NDArray[np.int64], high: NDArray[np.int64]) -> NDArray[np.uint8]:
    """A rectangle of a grid, 0 beyond its border."""
    crop = np.zeros(high - low, dtype=np.uint8)
    first, last = np.maximum(low, 0), np.minimum(high, grid.shape)
    (i0, j0), (i1, j1) = first - low, last - low
    crop[i0:i1, j0:j1] = grid[first[0] : last[0], first[1] : last[1]]
    return crop


def _colour(cells: NDArray[np.uint8], regions: NDArray[np.uint8]) -> NDArray[np.uint8]:
    colours = np.array([UNKNOWN, FREE, OBSTACLE], dtype=np.uint8)[np.minimum(cells, 2)]
    palette = np.array(REGION_COLOURS, dtype=np.uint8)
    inside = (regions > 0) & (cells == 1)
    colours[inside] = palette[(regions[inside] - 1) % len(palette)]
    return colours


def _draw_regions(draw: ImageDraw.ImageDraw, floor: FloorMapLine, regions: NDArray[np.uint8], pixels: int) -> None:
    for index, name in enumerate(floor.region_names, start=1):
        cells = np.argwhere(regions == index)
        if len(cells) >= 100:
            i, j = np.median(cells, axis=0)
            draw.text((j * pixels, i * pixels), name, fill=SOFT, font=_font(15), anchor="mm")


def _draw_paths(draw: ImageDraw.ImageDraw, to_px: _ToPixels, on_floor: _OnFloor) -> None:
    for piece in on_floor.shortest:
        dashed(draw, to_px(piece), SHORTEST, 4)
    for piece in on_floor.walked:
        points = to_px(piece)
        draw.line(points, fill=WALKED, width=4, joint="curve")
        for x, y in points[:: max(1, len(points) // 60)]:
            draw.ellipse((x - 2.5, y - 2.5, x + 2.5, y + 2.5), fill=WALKED)
    for x, y in to_px(on_floor.goals):
        _star(draw, x, y, 13, GOAL)
    if on_floor.start:
        x, y = to_px(on_floor.walked[0][:1])[0]
        draw.ellipse((x - 9, y - 9, x + 9, y + 9), fill=START, outline="white", width=2)
    if on_floor.end:
        x, y = to_px(on_floor.walked[-1][-1:])[0]
        draw.rectangle((x - 7, y - 7, x + 7, y + 7), fill=WALKED, outline="white", width=2)


def dashed(draw: ImageDraw.ImageDraw, points: list[tuple[float, float]], colour: tuple[int, int, int], width: int) -> None:
    """Draw a polyline in dashes of 12 pixels and gaps of 8."""
    done = 0.0
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        length = math.hypot(x1 - x0, y1 - y0)
        for k in range(math.ceil(length / 4)):
            if (done + 4 * k) % 20 < 12:
                a, b = 4 * k / length, min(1.0, (4 * k + 4) / length)
                draw.line(
                    (x0 + a * (x1 - x0), y0 + a * (y1 - y0), x0 + b * (x1 - x0), y0 + b * (y1 - y0)), fill=colour, width=width
                )
        done += length


def _star(draw: ImageDraw.ImageDraw, x: float, y: float, radius: float, colour: tuple[int, int, int]) -> None:
    corners = []
    for k in range(10):
        r = radius if k % 2 == 0 else radius * 0.45
        corners.append((x + r * math.sin(k * math.pi / 5), y - r * math.cos(k * math.pi / 5)))
    draw.polygon(corners, fill=colour, outline="white")


def _header(story: _Story, width: int) -> Image.Image:
    lines = textwrap.wrap(story.task, width=max(40, (width - 48) // 9))[:6]
    header = Image.new("RGB", (width, 76 + 24 * len(lines)), "white")
    draw = ImageDraw.Draw(header)
    y = 16
    for line in lines:
        draw.text((24, y), line, fill=INK, font=_font(18))
        y += 24
    draw.text((24, y + 4), _outcome(story.result), fill=SOFT, font=_font(15))
    x, y = 24, y + 38
    keys = [("start", START), ("walked, end", WALKED)]
    if len(story.goals):
        keys += [("shortest path", SHORTEST), ("goal", GOAL)]
    for text, colour in keys:
        draw.rectangle((x, y - 6, x + 14, y + 8), fill=colour)
        draw.text((x + 22, y + 1), text, fill=INK, font=_font(15), anchor="lm")
        x += 46 + round(draw.textlength(text, font=_font(15)))
    return header


def _outcome(result: ResultFile | None) -> str:
    if result is None:
        return "no result: the episode did not end"
    metrics = result.metrics
    parts = [f"status {result.status}", f"{metrics.steps} steps", f"{metrics.stages} stages"]
    if metrics.SR is not None:
        distance = "unreachable" if metrics.NE is None else f"{metrics.NE:.1f} m from the goal"
        parts = ["success" if metrics.SR else "no success", distance, *parts]
    return " · ".join(parts)


def _font(size: int) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    return ImageFont.load_default(size)
