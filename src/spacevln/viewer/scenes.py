"""What figures and videos share: an episode's pictures, text and map at any of its steps."""

from __future__ import annotations

import base64
import math
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from spacevln.recording import ResultFile, read_events, read_result
from spacevln.viewer.pages.story import Story
from spacevln.viewer.topdown import FREE, GOAL, INK, OBSTACLE, REGION_COLOURS, SHORTEST, SOFT, START, UNKNOWN, WALKED, dashed

Json = dict[str, Any]
SAME_FLOOR_M = 1.3
CHOSEN = (91, 33, 182)
NAMED_CELLS = 150
"""Smaller regions get no name on a map."""


class Scenes:
    """An episode, ready to be drawn.

    Args:
        directory: of its record.

    Raises:
        RecordError: the record is damaged.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self.result: ResultFile | None = read_result(directory)
        story = Story(directory).read(read_events(directory))
        started = story.started
        self.task = "" if started is None else f"{'Find: ' if started.task_kind == 'objectnav' else ''}{started.task_text}"
        self.story: Json = story.json(self.result)
        self._layers = {floor["floor"]: _unpack(floor) for floor in self.story["floors"]}

    @property
    def steps(self) -> list[Json]:
        """All steps, oldest first."""
        steps: list[Json] = self.story["steps"]
        return steps

    @property
    def stages(self) -> list[Json]:
        """All planner stages."""
        stages: list[Json] = self.story["stages"]
        return stages

    def layers(self, floor: Json) -> tuple[Any, Any, Any]:
        """Cells, regions and the step that uncovered each cell of a floor, (H, W) each; row 0 is the southernmost."""
        return self._layers[floor["floor"]]

    def picture(self, name: str | None, size: tuple[int, int], missing: str = "no image") -> Image.Image:
        """A recorded picture, scaled to fit into a size on white; a word in the place of one that there is not."""
        sheet = Image.new("RGB", size, (246, 247, 249))
        path = None if name is None else self._directory / name
        if path is None or not path.exists():
            ImageDraw.Draw(sheet).text((size[0] / 2, size[1] / 2), missing, SOFT, font(15), anchor="mm")
            return sheet
        with Image.open(path) as opened:
            scale = min(size[0] / opened.width, size[1] / opened.height)
            scaled = opened.convert("RGB").resize((max(1, round(opened.width * scale)), max(1, round(opened.height * scale))))
        sheet.paste(scaled, ((size[0] - scaled.width) // 2, (size[1] - scaled.height) // 2))
        return sheet

    def view(self, step: int, size: tuple[int, int]) -> Image.Image:
        """The first-person picture of a step with its boxes."""
        taken = self.steps[step]
        sheet = self.picture(taken["rgb"], size)
        draw = ImageDraw.Draw(sheet)
        scale = min(size[0] / self.story["frame"][0], size[1] / self.story["frame"][1])
        for found in taken["boxes"]:
            x0, y0, x1, y1 = (value * scale for value in found["box"])
            draw.rectangle((x0, y0, max(x0, x1 - 1), max(y0, y1 - 1)), outline=(255, 214, 10), width=2)
            if (x1 - x0) * (y1 - y0) > 0.01 * size[0] * size[1]:
                draw.text((x0 + 4, y0 + 2), found["name"], (255, 214, 10), font(13), stroke_width=2, stroke_fill=(0, 0, 0))
        return sheet

    def map(self, step: int, size: tuple[int, int], *, around_m: float | None = None) -> Image.Image:
        """The map after a step: what is uncovered, way walked, waypoints, landmarks, shortest path and goal.

        Args:
            step: index into ``steps``; -1 for the start.
            size: in pixels.
            around_m: half the width of a window around the agent instead of the whole floor.
        """
        pose = self.story["start"] if step < 0 else self.steps[step]["at"]
        floors = self.story["floors"]
        floor = min(floors, key=lambda each: abs(each["z"] - pose[2])) if floors else None
        window = self._window(floor, pose, around_m)
        scale = min(size[0] / (window[2] - window[0]), size[1] / (window[3] - window[1]))
        left = window[0] - (size[0] / scale - (window[2] - window[0])) / 2
        top = window[3] + (size[1] / scale - (window[3] - window[1])) / 2
        sheet = Image.new("RGB", size, UNKNOWN)
        if floor is not None:
            ground = Image.fromarray(self._ground(floor, step + 1)[::-1])
            cell_px = floor["resolution"] * scale
            ground = ground.resize(
                (max(1, round(ground.width * cell_px)), max(1, round(ground.height * cell_px))), Image.Resampling.NEAREST
            )
            y_top = floor["origin"][1] + floor["height"] * floor["resolution"]
            sheet.paste(ground, (round((floor["origin"][0] - left) * scale), round((top - y_top) * scale)))
        draw = ImageDraw.Draw(sheet)

        def to_px(point: list[float]) -> tuple[float, float]:
            return (point[0] - left) * scale, (top - point[1]) * scale

        if floor is not None:
            self._name_regions(draw, floor, step + 1, to_px, size)
        self._draw_marks(draw, step, pose, to_px)
        return sheet

    def _name_regions(
        self,
        draw: ImageDraw.ImageDraw,
        floor: Json,
        step: int,
        to_px: Callable[[list[float]], tuple[float, float]],
        size: tuple[int, int],
    ) -> None:
        """Names in the middle of what is uncovered of each region."""
        cells, regions, seen = self.layers(floor)
        shown = np.where((cells == 1) & (seen <= step), regions, 0)
        for number in np.unique(shown[shown > 0]):
            places = np.argwhere(shown == number)
            if len(places) < NAMED_CELLS:
                continue
            y_m, x_m = (places.mean(axis=0) + 0.5) * floor["resolution"]
            x, y = to_px([floor["origin"][0] + x_m, floor["origin"][1] + y_m])
            text = floor["names"][number - 1]
            half = draw.textlength(text, font(13)) / 2
            if half < x < size[0] - half and 8 < y < size[1] - 8:
                draw.text((x, y), text, INK, font(13), anchor="mm", stroke_width=2, stroke_fill="white")

    def _window(self, floor: Json | None, pose: list[float], around_m: float | None) -> tuple[float, float, float, float]:
        if around_m is not None:
            return pose[0] - around_m, pose[1] - around_m, pose[0] + around_m, pose[1] + around_m
        points = [self.story["start"], *(step["at"] for step in self.steps), *self.story["shortest"], *self.story["goals"]]
        here = [point for point in points if abs(point[2] - pose[2]) < SAME_FLOOR_M]
        xs, ys = [point[0] for point in here], [point[1] for point in here]
        if floor is not None:
            x0, y0, x1, y1 = floor["focus"]
            xs += [x0, x1]
            ys += [y0, y1]
        return min(xs) - 0.4, min(ys) - 0.4, max(xs) + 0.4, max(ys) + 0.4

    def _ground(self, floor: Json, step: int) -> Any:
        cells, regions, seen = self.layers(floor)
        visible = np.where(seen <= step, cells, 0)
        colours = np.array([UNKNOWN, FREE, OBSTACLE], np.uint8)[visible]
        inside = (visible == 1) & (regions > 0)
        colours[inside] = np.array(REGION_COLOURS, np.uint8)[(regions[inside] - 1) % len(REGION_COLOURS)]
        return colours

    def _draw_marks(self, draw: ImageDraw.ImageDraw, step: int, pose: list[float], to_px: Any) -> None:
        def same(point: list[float]) -> bool:
            return abs(point[2] - pose[2]) < SAME_FLOOR_M

        shortest = [to_px(point) for point in self.story["shortest"] if same(point)]
        if len(shortest) > 1:
            dashed(draw, shortest, SHORTEST, 3)
        walked = [
            to_px(point) for point in [self.story["start"], *(each["at"] for each in self.steps[: step + 1])] if same(point)
        ]
        if len(walked) > 1:
            draw.line(walked, WALKED, 3, joint="curve")
        for waypoint in self.story["waypoints"]:
            if waypoint["step"] <= step + 1 and same(waypoint["at"]):
                x, y = to_px(waypoint["at"])
                draw.ellipse((x - 8, y - 8, x + 8, y + 8), "white", WALKED, 2)
                draw.text((x, y), str(waypoint["index"]), INK, font(11), anchor="mm")
        decision = None if step < 0 else self.steps[step]["decision"]
        for candidate in [] if decision is None else self.story["decisions"][decision]["pool"]:
            x, y = to_px(candidate["at"])
            draw.rectangle((x - 5, y - 5, x + 5, y + 5), (180, 83, 9), "white")
            draw.text((x + 8, y), candidate["name"], (140, 60, 5), font(12), anchor="lm", stroke_width=2, stroke_fill="white")
        if same(self.story["start"]):
            x, y = to_px(self.story["start"])
            draw.ellipse((x - 5, y - 5, x + 5, y + 5), START, "white")
        x, y = to_px(pose)
        c, s = math.cos(pose[3]), math.sin(pose[3])
        arrow = [(14, 0), (-10, -10), (-5, 0), (-10, 10)]
        draw.polygon([(x + c * a - s * b, y - s * a - c * b) for a, b in arrow], WALKED, "white")
        for goal in filter(same, self.story["goals"]):
            x, y = to_px(goal)
            star = [(9 if k % 2 == 0 else 4, k * math.pi / 5) for k in range(10)]
            draw.polygon([(x + r * math.sin(a), y - r * math.cos(a)) for r, a in star], GOAL, "white")


def _unpack(floor: Json) -> tuple[Any, Any, Any]:
    """Cells, regions and first-seen steps of a packed floor; row 0 is the southernmost."""
    data = base64.b64decode(floor["picture"].partition(",")[2])
    bgr = np.asarray(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR), np.int64)[::-1]
    return bgr[..., 2] & 3, bgr[..., 1], ((bgr[..., 2] >> 2) << 8) | bgr[..., 0]


def framed(picture: Image.Image) -> Image.Image:
    """A picture with a thin white border, to lie on another."""
    sheet = Image.new("RGB", (picture.width + 4, picture.height + 4), "white")
    sheet.paste(picture, (2, 2))
    return sheet


def font(size: int) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    """The font of all pictures."""
    return ImageFont.load_default(size)


def paragraph(
    draw: ImageDraw.ImageDraw, xy: tuple[int, int], text: str, width_px: int, size: int, *, lines: int, soft: bool = False
) -> int:
    """Write wrapped text, at most so many lines; returns the y below it."""
    x, y = xy
    wrapped = textwrap.wrap(text, width=max(8, int(width_px / (0.52 * size))))
    if len(wrapped) > lines:
        wrapped = [*wrapped[: lines - 1], wrapped[lines - 1][:-1] + "…"]
    for line in wrapped:
        draw.text((x, y), line, SOFT if soft else INK, font(size))
        y += round(size * 1.35)
    return y
