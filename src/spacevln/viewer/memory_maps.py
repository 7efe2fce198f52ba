"""Pictures of the memory that an episode left, from its record alone: metric map, regions with the graph, rendered map."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image

from spacevln.core import Pose, RecordError, UsageError
from spacevln.memory import BuildingMemory, EdgeKind, SavedMemory, SpatialCognitiveMemory, load_memory
from spacevln.memory.map_marks import AGENT, FREE, INK, OBSTACLE, REGIONS, THRESHOLD, UNKNOWN, WALKED, Colour
from spacevln.memory.region_raster import region_raster
from spacevln.memory.regions import CELL_M
from spacevln.recording import read_events, read_result
from spacevln.recording.schema import EpisodeEndedLine
from spacevln.viewer.plan_sheet import FINE, Float, Sheet, finish, floor_sheet, font

WAY: Colour = (196, 150, 214)
MAP_EDGE: Colour = (20, 110, 120)
_RING_PX = 11
_KNOWN = (("unknown", UNKNOWN, "box"), ("free floor", FREE, "box"), ("obstacle", OBSTACLE, "box"))


def draw_memory(directory: Path, out: Path) -> tuple[Path, ...]:
    """Draw what an episode left in memory, and write the planner's text beside it.

    Args:
        directory: of the episode's record.
        out: where the pictures go; created.

    Returns:
        The files: for every floor ``metric_map*.png`` and ``spatial_memory*.png``, then ``rendered_map.png`` and
        ``memory.txt``, which are what a planner would be told at the last pose.

    Raises:
        RecordError: the record holds no memory, or it is damaged.
    """
    saved, pose = _read(directory)
    out.mkdir(parents=True, exist_ok=True)
    building, up_rad = saved.building, math.pi / 2 - saved.T_scene_episode.yaw_rad
    files = []
    for floor in building.metric_map.floors:
        where = saved.scene + (f", floor {floor}" if len(building.metric_map.floors) > 1 else "")
        suffix = f"_floor_{floor}" if len(building.metric_map.floors) > 1 else ""
        for name, picture in _pictures(building, floor, up_rad, where, pose):
            files.append(out / f"{name}{suffix}.png")
            picture.save(files[-1])
    told = SpatialCognitiveMemory(building.hierarchical).egocentric(pose, building.metric_map)
    files += [out / "rendered_map.png", out / "memory.txt"]
    Image.fromarray(np.asarray(told.map_image, np.uint8)).save(files[-2])
    files[-1].write_text(told.text + "\n", encoding="utf-8")
    return tuple(files)


def _read(directory: Path) -> tuple[SavedMemory, Pose]:
    """The final memory of an episode and its last pose."""
    result = read_result(directory)
    if result is None or result.memory is None:
        raise RecordError(f"{str(directory)!r} holds no final memory: give the record of an agent's episode that has ended.")
    try:
        saved = load_memory(directory / result.memory)
    except UsageError as error:
        raise RecordError(str(error)) from error
    pose = next((line.pose for line in read_events(directory) if isinstance(line, EpisodeEndedLine)), Pose(0.0, 0.0))
    return saved, pose


def _pictures(building: BuildingMemory, floor: int, up_rad: float, where: str, pose: Pose) -> Iterator[tuple[str, Image.Image]]:
    plain = floor_sheet(building, floor, up_rad)
    if plain is None:
        return
    metric_map, hierarchical = building.metric_map, building.hierarchical
    cell_m2 = plain.crop.resolution_m**2
    way = _on_floor(metric_map.travelled, floor)
    for piece in way:
        plain.draw.line(plain.pixels(piece), WALKED, plain.fine(3), joint="curve")
    _ends(plain, way, pose, here=floor == metric_map.floor)
    area = f"{plain.crop.free.sum() * cell_m2:.0f} m2 of free floor, cells of {100 * plain.crop.resolution_m:.0f} cm"
    walked: tuple[tuple[str, Colour, str], ...] = (
        ("walked way", WALKED, "line"),
        ("its start", WALKED, "ring"),
        ("its end", AGENT, "arrow"),
    )
    yield "metric_map", finish(plain, f"Metric map of {where}: {area}", (*_KNOWN, *walked))
    raster = region_raster(hierarchical, floor)
    sheet = floor_sheet(building, floor, up_rad, raster)
    if raster is None or sheet is None:
        return
    for piece in way:
        sheet.draw.line(sheet.pixels(piece), WAY, sheet.fine(3), joint="curve")
    for threshold in hierarchical.thresholds.on(floor):
        sheet.draw.line(sheet.pixels(np.array([threshold.a_m, threshold.b_m])), THRESHOLD, sheet.fine(6))
    counts = _graph(sheet, building, floor)
    _names(sheet, building, floor)
    title = f"Spatial memory of {where}: {counts[0]} waypoints, {counts[1]} + {counts[2]} edges"
    entries = (
        ("space", REGIONS[0], "box"),
        ("doorway", THRESHOLD, "line"),
        ("walked way", WAY, "line"),
        ("E_map, with its length in m", MAP_EDGE, "line"),
        ("E_chain", WALKED, "dash"),
        ("Spatial Waypoint", WALKED, "ring"),
    )
    yield "spatial_memory", finish(sheet, title, entries)


def _on_floor(travelled: Float, floor: int) -> list[Float]:
    """The pieces of the walked way that lie on a floor."""
    here = travelled[:, 2] == floor
    cuts = np.flatnonzero(np.diff(here)) + 1
    pieces = zip(np.split(travelled[:, :2], cuts), np.split(here, cuts), strict=True)
    return [piece for piece, inside in pieces if len(piece) > 1 and inside[0]]


def _ends(sheet: Sheet, way: list[Float], pose: Pose, *, here: bool) -> None:
    """A dot where the way begins and an arrow where it ends."""
    radius = sheet.fine(6)
    if way:
        u, v = sheet.pixels(way[0][:1])[0]
        sheet.draw.ellipse((u - radius, v - radius, u + radius, v + radius), "white", WALKED, sheet.fine(3))
    if here:
        c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        shape = np.array([[0.28, 0.0], [-0.2, 0.19], [-0.1, 0.0], [-0.2, -0.19]])
        sheet.draw.polygon(sheet.pixels(pose.xy_m + shape @ np.array([[c, s], [-s, c]])), AGENT, "white", sheet.fine(1))


def _graph(sheet: Sheet, building: BuildingMemory, floor: int) -> tuple[int, int, int]:
    """Waypoints of a floor and the edges between them; how many of each, E_map before E_chain."""
    hierarchical = building.hierarchical
    members = {waypoint.index: waypoint for waypoint in hierarchical.waypoints if waypoint.floor == floor}
    edges = [edge for edge in hierarchical.graph.edges if edge.a in members and edge.b in members]
    for edge in edges:
        points = sheet.pixels(hierarchical.graph.path_of(edge))
        if edge.kind is EdgeKind.CHAIN:
            _dashed(sheet, points)
        else:
            sheet.draw.line(points, MAP_EDGE, sheet.fine(2), joint="curve")
    for edge in edges:
        if edge.kind is EdgeKind.MAP and edge.length_m >= 1.5:
            u, v = _middle(sheet.pixels(hierarchical.graph.path_of(edge)))
            _text(sheet, u, v, f"{edge.length_m:.1f}", 11, MAP_EDGE)
    radius = sheet.fine(_RING_PX)
    for index, waypoint in members.items():
        u, v = sheet.pixels(waypoint.pose.xy_m)[0]
        sheet.draw.ellipse((u - radius, v - radius, u + radius, v + radius), "white", WALKED, sheet.fine(2.5))
        sheet.draw.text((u, v), str(index), INK, font(sheet.fine(12)), anchor="mm")
    kinds = [edge.kind for edge in edges]
    return len(members), kinds.count(EdgeKind.MAP), kinds.count(EdgeKind.CHAIN)


def _names(sheet: Sheet, building: BuildingMemory, floor: int) -> None:
    """A name on every region, beside its waypoints."""
    hierarchical = building.hierarchical
    taken = [sheet.pixels(waypoint.pose.xy_m)[0] for waypoint in hierarchical.waypoints if waypoint.floor == floor]
    raster = region_raster(hierarchical, floor)
    if raster is None:
        return
    for number, region in enumerate(hierarchical.regions.all, start=1):
        cells = np.argwhere(raster.owner == number)[::5]
        if region.floor != floor or len(cells) == 0:
            continue
        first = np.array([raster.i0 + 0.5, raster.j0 + 0.5])
        spots: Float = np.array(sheet.pixels((cells + first) * CELL_M), np.float64)
        gaps = np.hypot(*(spots[:, None] - np.array(taken)[None]).transpose(2, 0, 1)).min(axis=1)
        middle = np.hypot(*(spots - np.median(spots, axis=0)).T)
        u, v = spots[int(np.argmin(middle + 3.0 * np.maximum(0, sheet.fine(34) - gaps)))]
        taken.append((float(u), float(v)))
        _text(sheet, float(u), float(v), region.label, 15, INK)


def _text(sheet: Sheet, u: float, v: float, text: str, size: int, colour: Colour) -> None:
    sheet.draw.text(
        (u, v), text, colour, font(sheet.fine(size)), anchor="mm", stroke_width=sheet.fine(2), stroke_fill=(255, 255, 255)
    )


def _middle(points: list[tuple[float, float]]) -> tuple[float, float]:
    """The point halfway along a polyline."""
    at = np.concatenate([[0.0], np.cumsum([math.dist(a, b) for a, b in pairwise(points)])])
    line = np.array(points)
    return float(np.interp(at[-1] / 2, at, line[:, 0])), float(np.interp(at[-1] / 2, at, line[:, 1]))


def _dashed(sheet: Sheet, points: list[tuple[float, float]]) -> None:
    done, dash = 0.0, 14.0 * FINE
    for a, b in pairwise(points):
        length = math.dist(a, b)
        at = 0.0
        while at < length:
            left = dash - (done + at) % dash
            end = min(length, at + left)
            if (done + at) % (2 * dash) < dash:
                (u0, v0), (u1, v1) = (tuple(p + (q - p) * t / length for p, q in zip(a, b, strict=True)) for t in (at, end))
                sheet.draw.line((u0, v0, u1, v1), WALKED, sheet.fine(2.5))
            at = end + 1e-6
        done += length
