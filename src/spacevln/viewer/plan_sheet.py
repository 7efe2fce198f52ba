"""A floor of a saved memory as a sheet of paper: walls upright, points to pixels, a title and a legend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from spacevln.mapping import MapCrop, MetricMap
from spacevln.memory import BuildingMemory
from spacevln.memory.map_marks import FRAME, FREE, INK, OBSTACLE, REGIONS, UNKNOWN, Colour
from spacevln.memory.region_raster import RegionRaster

PX_PER_M = 56
FINE = 2  # lines are drawn this much larger and reduced, so that they are smooth
MARGIN_M = 0.6
_REACH_M = 6.0  # what can be known beyond a place one stood at; depth reaches 5 m
_BLUR_CELLS, _SHARPNESS = 0.5, 4.0  # walls at an angle to the cells look straight
_SAMPLE_ROWS = 64

Float = NDArray[np.float64]
Pixels = list[tuple[float, float]]
Entry = tuple[str, Colour, str]  # name, colour, mark: "box", "line", "dash", "ring" or "arrow"


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """A window of one floor and a picture of it.

    Args:
        crop: the floor, its upper edge along the scene's +y.
        low, high: (row, column) of the known part of the crop, end exclusive.
        picture: ``FINE`` times as large as it will be.
    """

    crop: MapCrop
    low: tuple[int, int]
    high: tuple[int, int]
    picture: Image.Image

    @property
    def draw(self) -> ImageDraw.ImageDraw:
        """Draws on the picture."""
        return ImageDraw.Draw(self.picture)

    def pixels(self, xy_m: Float) -> Pixels:
        """Points (N, 2) of the memory's frame as places on the fine picture."""
        scale = PX_PER_M * FINE * self.crop.resolution_m
        column_row = (self.crop.to_px(xy_m) + 0.5 - (self.low[1], self.low[0])) * scale
        return [(float(u), float(v)) for u, v in column_row]

    def fine(self, px: float) -> int:
        """A length of the final picture on the fine one."""
        return round(px * FINE)


def floor_sheet(building: BuildingMemory, floor: int, up_rad: float, raster: RegionRaster | None = None) -> Sheet | None:
    """A floor in its colours; None when nothing of it is known.

    Args:
        building: what is known.
        floor: which storey.
        up_rad: direction of the upper edge, memory's frame.
        raster: owners of the cells, to colour regions; without it the floor is plain.
    """
    crop = _crop(building, floor, up_rad)
    known = np.argwhere(crop.explored)
    if len(known) == 0:
        return None
    margin = round(MARGIN_M / crop.resolution_m)
    row0, column0 = np.maximum(known.min(axis=0) - margin, 0).tolist()
    row1, column1 = np.minimum(known.max(axis=0) + margin + 1, len(crop.free)).tolist()
    part = slice(row0, row1), slice(column0, column1)
    size = tuple(round((end - first) * crop.resolution_m * PX_PER_M * FINE) for first, end in ((column0, column1), (row0, row1)))
    labels = np.zeros(crop.free.shape, np.uint8) if raster is None else _owners(crop, raster)
    colours = np.array([FREE, *REGIONS], np.float32)
    index = np.where(labels > 0, 1 + (labels.astype(np.int64) - 1) % len(REGIONS), 0)[part].astype(np.uint8)
    floor_colour = colours[cv2.resize(cv2.medianBlur(index, 3), size, interpolation=cv2.INTER_NEAREST)]
    painted = np.full((size[1], size[0], 3), UNKNOWN, np.float32)
    for mask, colour in ((crop.explored[part], floor_colour), (crop.obstacle[part], np.array(OBSTACLE, np.float32))):
        opacity = _soft(mask, size)[..., None]
        painted += opacity * (colour - painted)
    return Sheet(crop, (row0, column0), (row1, column1), Image.fromarray(np.rint(painted).astype(np.uint8)))


def finish(sheet: Sheet, title: str, entries: Sequence[Entry]) -> Image.Image:
    """The picture at its final size with a title above, a scale on it and a legend below."""
    plan = sheet.picture.resize((sheet.picture.width // FINE, sheet.picture.height // FINE), Image.Resampling.BOX)
    small, large = font(13), font(16)
    measure = ImageDraw.Draw(plan)
    cells = [round(measure.textlength(name, small)) + 44 for name, _, _ in entries]
    width = max(plan.width, round(measure.textlength(title, large)) + 28, *cells)
    rows: list[list[int]] = [[]]
    for k, cell in enumerate(cells):
        if rows[-1] and sum(cells[j] for j in rows[-1]) + cell > width - 12:
            rows.append([])
        rows[-1].append(k)
    page = Image.new("RGB", (width, 40 + plan.height + 14 + 24 * len(rows)), "white")
    page.paste(plan, ((width - plan.width) // 2, 40))
    draw = ImageDraw.Draw(page)
    draw.text((14, 20), title, INK, large, anchor="lm")
    draw.rectangle(((width - plan.width) // 2, 40, (width + plan.width) // 2 - 1, 39 + plan.height), outline=FRAME)
    right, bottom = (width + plan.width) // 2 - 16, 40 + plan.height - 16
    draw.line((right - 2 * PX_PER_M, bottom, right, bottom), INK, 3)
    draw.text((right - PX_PER_M, bottom - 11), "2 m", INK, small, anchor="mm")
    for number, row in enumerate(rows):
        x, y = 14, 40 + plan.height + 20 + 24 * number
        for k in row:
            _mark(draw, x, y, entries[k][1], entries[k][2])
            draw.text((x + 26, y), entries[k][0], INK, small, anchor="lm")
            x += cells[k]
    return page


def _crop(building: BuildingMemory, floor: int, up_rad: float) -> MapCrop:
    """A square that holds all that can be known of a floor."""
    places = _places(building, building.metric_map, floor)
    low, high = places.min(axis=0), places.max(axis=0)
    size_m = float((high - low).max()) * math.sqrt(2) + 2 * _REACH_M
    return building.metric_map.crop((low + high) / 2, size_m, up_rad, floor)


def _places(building: BuildingMemory, metric_map: MetricMap, floor: int) -> Float:
    """Where the agent stood on a floor, in this episode and in earlier ones (N, 2)."""
    way = metric_map.travelled
    stood = [waypoint.pose.xy_m for waypoint in building.hierarchical.waypoints if waypoint.floor == floor]
    on_stairs = [end.xy_m for stairs in metric_map.connectors for end in (stairs.start, stairs.end)]
    places = np.vstack([way[way[:, 2] == floor, :2], np.array(stood).reshape(-1, 2)])
    return places if len(places) else np.array([*on_stairs, (0.0, 0.0)])


def _owners(crop: MapCrop, raster: RegionRaster) -> NDArray[np.uint8]:
    side = len(crop.free)
    owners = np.zeros((side, side), np.uint8)
    columns = np.arange(side)
    for first in range(0, side, _SAMPLE_ROWS):
        rows = np.arange(first, min(first + _SAMPLE_ROWS, side))
        u, v = np.meshgrid(columns, rows)
        owners[rows] = raster.at(crop.to_xy(np.stack([u.ravel(), v.ravel()], axis=1))).reshape(u.shape)
    return np.where(crop.free, owners, 0).astype(np.uint8)


def _soft(mask: NDArray[np.bool_], size: tuple[int, ...]) -> NDArray[np.float32]:
    """A mask as opacity at another size, with smooth borders."""
    grown = cv2.resize(mask.astype(np.float32), (size[0], size[1]), interpolation=cv2.INTER_LINEAR)
    blurred = cv2.GaussianBlur(grown, (0, 0), _BLUR_CELLS * size[0] / mask.shape[1])
    return np.asarray(np.clip((blurred - 0.5) * _SHARPNESS + 0.5, 0, 1), np.float32)


def _mark(draw: ImageDraw.ImageDraw, x: int, y: int, colour: Colour, mark: str) -> None:
    if mark == "box":
        draw.rectangle((x, y - 6, x + 18, y + 6), colour, FRAME)
    elif mark == "ring":
        draw.ellipse((x + 2, y - 7, x + 16, y + 7), "white", colour, 3)
    elif mark == "arrow":
        draw.polygon(((x + 18, y), (x + 2, y - 7), (x + 6, y), (x + 2, y + 7)), colour)
    elif mark == "dash":
        for k in range(3):
            draw.line((x + 7 * k, y, x + 7 * k + 4, y), colour, 3)
    else:
        draw.line((x, y, x + 18, y), colour, 4)


@lru_cache(maxsize=16)
def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """The built-in font."""
    return ImageFont.load_default(size)
