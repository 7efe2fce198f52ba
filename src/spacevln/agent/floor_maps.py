"""The final map as plain arrays, for records and viewers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.core import FloorMap
from spacevln.mapping import MetricMap
from spacevln.memory import HierarchicalSpatialMemory
from spacevln.memory.regions import CELL_M
from spacevln.memory.rendering import region_raster

_MARGIN_M = 6.0  # beyond the way that was walked; depth reaches 5 m


def floor_maps(metric_map: MetricMap, memory: HierarchicalSpatialMemory) -> tuple[FloorMap, ...]:
    """One picture per floor that was walked on, cut to what is known of it."""
    names = tuple(region.label for region in memory.regions.all)
    pictures = (_picture(floor, metric_map, memory, names) for floor in metric_map.floors)
    return tuple(picture for picture in pictures if picture is not None)


def _picture(floor: int, metric_map: MetricMap, memory: HierarchicalSpatialMemory, names: tuple[str, ...]) -> FloorMap | None:
    way = metric_map.travelled
    way = way[way[:, 2] == floor, :2]
    if not len(way):
        return None
    cell = metric_map.resolution_m
    centre = np.round((way.min(axis=0) + way.max(axis=0)) / 2 / cell) * cell
    half = math.ceil((float((way.max(axis=0) - way.min(axis=0)).max()) / 2 + _MARGIN_M) / cell)
    crop = metric_map.crop(centre, 2 * half * cell, floor=floor)
    cells = np.where(crop.obstacle, 2, np.where(crop.free, 1, 0)).astype(np.uint8)[::-1]  # rows go up along +y
    known = np.argwhere(cells)
    if not len(known):
        return None
    (i0, j0), (i1, j1) = known.min(axis=0), known.max(axis=0) + 1
    origin = centre + (np.array([j0, i0]) - half) * cell
    cut = np.ascontiguousarray(cells[i0:i1, j0:j1])
    regions = np.where(cut == 1, _regions(memory, floor, origin, cut.shape, cell), 0).astype(np.uint8)
    return FloorMap(floor, cell, (float(origin[0]), float(origin[1])), cut, regions, names)


def _regions(
    memory: HierarchicalSpatialMemory, floor: int, origin: NDArray[np.float64], shape: tuple[int, ...], cell: float
) -> NDArray[np.uint8]:
    """1 + index of the region at every cell, rows along +y; 0 where there is none."""
    raster = region_raster(memory, floor)
    if raster is None:
        return np.zeros(shape, np.uint8)
    owner, i0, j0 = raster  # i along x, j along y, coarser cells
    i = np.floor((origin[0] + (np.arange(shape[1]) + 0.5) * cell) / CELL_M).astype(int) - i0
    j = np.floor((origin[1] + (np.arange(shape[0]) + 0.5) * cell) / CELL_M).astype(int) - j0
    inside = ((j >= 0) & (j < owner.shape[1]))[:, None] & ((i >= 0) & (i < owner.shape[0]))[None]
    picked = owner[np.clip(i, 0, owner.shape[0] - 1)[None], np.clip(j, 0, owner.shape[1] - 1)[:, None]]
    return np.where(inside, picked, 0).astype(np.uint8)
