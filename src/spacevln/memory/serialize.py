"""Serialize: the text of the enhanced egocentric spatial representation Psi_k (paper Sec. 3.2).

The same state gives the same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from spacevln.core import ArrangedWaypoint, Frontier, LandmarkCue, Pose, egocentric_label
from spacevln.memory.arrange import HERE_M
from spacevln.memory.regions import Region

if TYPE_CHECKING:
    from spacevln.memory.hierarchical import HierarchicalSpatialMemory

STRAIGHT_DEG = 15.0  # smaller turns are not told [authors' code]
SHOWN_CUES = 4
SHOWN_FRONTIERS = 6
MIN_FRONTIER_M = 0.4
BLIND_M = 0.5  # nearer than depth is measured: the border of a blind spot, not of the building [ours]


def serialize(
    memory: HierarchicalSpatialMemory,
    pose: Pose,
    floor: int,
    arranged: Sequence[ArrangedWaypoint],
    frontiers: Sequence[Frontier],
) -> str:
    """The agent-centred adjacency list, the regions, the borders of the unknown and the executed chain, one fact a line."""
    region = memory.region_at(pose, floor)
    floors = memory.floors
    several = len(floors) > 1 or (bool(floors) and floors[0] != floor)
    lines = [f"Here: {region.label if region else 'a space not named yet'}" + (f", floor {floor}" if several else "")]
    if arranged:
        lines.append("Waypoints around you (direction, way):")
        lines.extend(_waypoint_line(memory, item, floor) for item in arranged)
    if len(memory.regions.all) > 1:
        lines.append("Spaces: " + "; ".join(_region_entry(memory, entry, several) for entry in memory.regions.all))
    borders: dict[str, str] = {}  # the nearest in each direction
    for frontier in frontiers:
        if frontier.width_m >= MIN_FRONTIER_M and BLIND_M <= frontier.geodesic_m < math.inf:
            label = egocentric_label(frontier.bearing_rad)
            borders.setdefault(label, f"{label} {frontier.geodesic_m:.1f} m")
    if borders:
        lines.append("Unexplored beyond: " + "; ".join(list(borders.values())[:SHOWN_FRONTIERS]))
    if memory.chain:
        lines.append("Walked so far: " + _chain(memory, pose, floor))
    return "\n".join(lines)


def _waypoint_line(memory: HierarchicalSpatialMemory, item: ArrangedWaypoint, floor: int) -> str:
    waypoint = item.waypoint
    marks = list(item.marks)
    if item.visits > 1:
        marks[-1] = f"visited {item.visits} times"
    tags = f" [{', '.join(marks)}]" if marks else ""
    cues = cue_words(waypoint.cues)
    name = f"w{waypoint.index} {memory.regions.of(waypoint.index).label}{tags}{': ' + cues if cues else ''}"
    if waypoint.floor != floor:
        return f"{name} | floor {waypoint.floor} | {_way(item)}"
    if item.geodesic_m < HERE_M:
        return f"{name} | here"
    return f"{name} | {egocentric_label(item.bearing_rad)} | {_way(item)}"


def _way(item: ArrangedWaypoint) -> str:
    if not math.isfinite(item.geodesic_m):
        return "no known way"
    via = f" via {', '.join(f'w{index}' for index in item.path[:-1])}" if len(item.path) > 1 else ""
    return f"{item.geodesic_m:.1f} m{via}"


def cue_words(cues: Sequence[LandmarkCue], shown: int = SHOWN_CUES) -> str:
    """The first few cues, each category once: ``"white sofa, fireplace"``."""
    words: dict[str, str] = {}
    for cue in cues:
        words.setdefault(cue.category, " ".join((*cue.attributes[:1], cue.category)))
    return ", ".join(list(words.values())[:shown])


def _region_entry(memory: HierarchicalSpatialMemory, region: Region, several: bool) -> str:
    members = " ".join(f"w{index}" for index in region.waypoints)
    floor = f" floor {region.floor}" if several else ""
    joined = ", ".join(other.label for other in memory.region_neighbours(region))
    return f"{region.label}{floor} ({members})" + (f" next to {joined}" if joined else "")


def _chain(memory: HierarchicalSpatialMemory, pose: Pose, floor: int) -> str:
    """Every visit in order, with the turn and the distance of each leg, to the live pose; a space is named when it changes."""
    waypoints = memory.waypoints
    text = told = ""
    for index in memory.chain:
        waypoint = waypoints[index]
        if text:
            text += _leg(waypoints[index - 1].pose, waypoint.pose, waypoints[index - 1].floor, waypoint.floor)
        region = memory.regions.of(index).label
        text += f"w{index}" if region == told else f"w{index} {region}"
        told = region
    last = waypoints[memory.chain[-1]]
    if last.pose.distance_m(pose.x_m, pose.y_m) >= HERE_M or last.floor != floor:
        text += _leg(last.pose, pose, last.floor, floor) + "here"
    return text


def _leg(before: Pose, after: Pose, floor_before: int, floor_after: int) -> str:
    if floor_after != floor_before:
        return f" > stairs {'up' if floor_after > floor_before else 'down'} > "
    distance = before.distance_m(after.x_m, after.y_m)
    turn_deg = math.degrees(before.bearing_rad(after.x_m, after.y_m)) if distance > 1e-6 else 0.0
    label = egocentric_label(math.radians(turn_deg)) if abs(turn_deg) >= STRAIGHT_DEG else ""
    return f" > {label + ', ' if label not in ('', 'front') else ''}{distance:.1f} m > "
