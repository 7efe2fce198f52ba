"""Arrange: all waypoints around the agent, overlapping ones merged, with the known ways to them (paper Sec. 3.2)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from spacevln.core import ArrangedWaypoint, Mark, Pose, SpatialWaypoint
from spacevln.core.geometry import Float
from spacevln.memory.graph import REACH_M
from spacevln.memory.metric import MemoryMap

if TYPE_CHECKING:
    from spacevln.memory.hierarchical import HierarchicalSpatialMemory

OVERLAP_M = 1.0  # waypoints of one region this near are shown as one [authors' code]
HERE_M = 0.5  # nearer than this one stands at a waypoint
DETOUR = 1.3  # a way over the graph may be this much longer than the map's
_SECTORS = 12


def arrange(memory: HierarchicalSpatialMemory, pose: Pose, metric_map: MemoryMap) -> tuple[ArrangedWaypoint, ...]:
    """Arrange_G(w_k; w_0, w_{k-1}) around the live pose.

    Order: the current floor first, then by direction (front, then counter-clockwise in steps of 30 degrees), then by
    distance. ``geodesic_m`` is the way on the map, or, where the map does not join the two (another floor), along the graph.
    """
    waypoints = memory.waypoints
    if not waypoints:
        return ()
    on_map = _map_distances(pose, waypoints, metric_map)
    along_graph, previous = memory.graph.shortest(_entrances(memory, pose, on_map, metric_map.floor))
    chain, arranged = memory.chain, []
    for group in _overlapping(memory, waypoints):
        newest = waypoints[group[-1]]
        way_m = float(on_map[newest.index])
        arranged.append(
            ArrangedWaypoint(
                waypoint=newest,
                merged=tuple(group[:-1]),
                bearing_rad=pose.bearing_rad(newest.pose.x_m, newest.pose.y_m),
                geodesic_m=way_m if math.isfinite(way_m) else along_graph.get(newest.index, math.inf),
                path=_path(newest.index, on_map, along_graph, previous),
                marks=_marks(group, chain),
                visits=sum(index in chain for index in group),
            )
        )
    return tuple(sorted(arranged, key=lambda item: _order(item, pose, metric_map.floor)))


def _map_distances(pose: Pose, waypoints: Sequence[SpatialWaypoint], metric_map: MemoryMap) -> Float:
    """Geodesic distance from the pose to every waypoint of the current floor; inf for the others."""
    xy = np.array([[waypoint.pose.x_m, waypoint.pose.y_m] for waypoint in waypoints])
    distances = np.asarray(metric_map.geodesic_field(pose.xy_m).at(xy), np.float64)
    return np.where([waypoint.floor == metric_map.floor for waypoint in waypoints], distances, np.inf)


def _entrances(memory: HierarchicalSpatialMemory, pose: Pose, on_map: Float, floor: int) -> dict[int, float]:
    """Where a way over the graph may begin: the waypoints within local reach, or else the nearest one."""
    within = {index: float(way) for index, way in enumerate(on_map) if way <= REACH_M}
    if within:
        return within
    if np.isfinite(on_map).any():
        nearest = int(np.argmin(on_map))
        return {nearest: float(on_map[nearest])}
    came_by = [memory.waypoints[index] for index in memory.chain]
    if not came_by:
        return {}  # set down in a known building, out of reach of what is known
    last = next((waypoint for waypoint in reversed(came_by) if waypoint.floor == floor), came_by[-1])
    return {last.index: pose.distance_m(last.pose.x_m, last.pose.y_m)}  # the map does not join them: the way it came


def _path(index: int, on_map: Float, reached: dict[int, float], previous: dict[int, int]) -> tuple[int, ...]:
    """The way over the graph, without the waypoint one stands at; the target alone where the map knows a much shorter way."""
    way_m = float(on_map[index])
    if index not in reached:
        return (index,) if math.isfinite(way_m) else ()
    if reached[index] > DETOUR * way_m + REACH_M / 2:
        return (index,)
    path = [index]
    while path[-1] in previous:
        path.append(previous[path[-1]])
    if len(path) > 1 and on_map[path[-1]] < HERE_M:
        path.pop()
    return tuple(reversed(path))


def _overlapping(memory: HierarchicalSpatialMemory, waypoints: Sequence[SpatialWaypoint]) -> list[list[int]]:
    """Groups of waypoints of one region within 1 m of the newest of them, ascending inside a group."""
    groups: list[list[int]] = []
    for waypoint in reversed(waypoints):
        region = memory.regions.of(waypoint.index)
        for group in groups:
            newest = waypoints[group[0]]
            near = newest.pose.distance_m(waypoint.pose.x_m, waypoint.pose.y_m) <= OVERLAP_M
            if near and newest.floor == waypoint.floor and memory.regions.of(newest.index) is region:
                group.append(waypoint.index)
                break
        else:
            groups.append([waypoint.index])
    return [group[::-1] for group in groups]


def _marks(group: Sequence[int], chain: Sequence[int]) -> tuple[str, ...]:
    own = [index for index in group if index in chain]
    if not own:
        return (Mark.EARLIER,)
    marks = []
    if chain[0] in own:
        marks.append(Mark.FIRST)
    if chain[-1] in own:
        marks.append(Mark.PREVIOUS)
    if len(own) > 1:
        marks.append(Mark.VISITED)
    return tuple(marks)


def _order(item: ArrangedWaypoint, pose: Pose, floor: int) -> tuple[int, int, float, int]:
    at = item.waypoint.pose
    sector = round(math.degrees(item.bearing_rad) / (360 / _SECTORS)) % _SECTORS
    distance = item.geodesic_m if math.isfinite(item.geodesic_m) else 1e6 + pose.distance_m(at.x_m, at.y_m)
    return (abs(item.waypoint.floor - floor), sector, round(distance, 3), item.waypoint.index)
