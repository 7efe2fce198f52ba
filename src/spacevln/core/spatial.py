"""What the planner sees of Spatial Cognitive Memory: Psi_k, the enhanced egocentric spatial representation.

Paper Sec. 3.2 and appendix "Planner serialization and map rendering". Built by ``memory``; read by ``reasoning``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Pose


@dataclass(frozen=True, slots=True)
class LandmarkCue:
    """One element of Lambda_i: a landmark seen at a Spatial Waypoint; position (episode frame) where it was lifted."""

    category: str
    attributes: tuple[str, ...] = ()
    position_m: tuple[float, float, float] | None = None
    confidence: float = 1.0
    distance_m: float = 0.0
    extent_m: float = 0.0
    is_passage: bool = False


@dataclass(frozen=True, slots=True)
class SpatialWaypoint:
    """w_i = (x_i, f_i, r_i, Lambda_i).

    Args:
        index: order of creation, from 0.
        pose: x_i in the episode frame.
        floor: f_i, 0 for the floor of the start; upper floors count up, lower ones down.
        region: r_i, normalised region type or free text.
        cues: Lambda_i.
        text: the planner's anchor as it wrote it.
    """

    index: int
    pose: Pose
    floor: int
    region: str
    cues: tuple[LandmarkCue, ...]
    text: str


class Mark:
    """Marks of an arranged waypoint."""

    FIRST = "first"
    PREVIOUS = "previous"
    VISITED = "visited"
    EARLIER = "earlier episode"  # known from a loaded memory, not visited in this episode


@dataclass(frozen=True, slots=True)
class ArrangedWaypoint:
    """A Spatial Waypoint as seen from the agent (Arrange).

    Args:
        waypoint: the waypoint; the newest of those that overlap.
        merged: indices of the overlapping waypoints that it stands for.
        bearing_rad: egocentric, left positive.
        geodesic_m: on known free space; inf when no known way leads there.
        path: connectivity path, indices of the waypoints on the way (multi-hop), this one last.
        marks: of :class:`Mark`.
        visits: how often the chain passed here; 0 for what only an earlier episode in this building visited.
    """

    waypoint: SpatialWaypoint
    merged: tuple[int, ...]
    bearing_rad: float
    geodesic_m: float
    path: tuple[int, ...]
    marks: tuple[str, ...]
    visits: int


@dataclass(frozen=True, slots=True)
class Frontier:
    """A border between known free space and the unknown, on the current floor.

    Args:
        position_m: (x, y) of the frontier cell that is reached first.
        geodesic_m: way there on known free space; inf when cut off.
        bearing_rad: egocentric, left positive.
        width_m: length of the border.
    """

    position_m: tuple[float, float]
    geodesic_m: float
    bearing_rad: float
    width_m: float


@dataclass(frozen=True, slots=True, eq=False)
class FloorMap:
    """A picture of the metric map of one floor, axis-aligned in the episode frame, for records and viewers.

    Args:
        floor: its id.
        resolution_m: edge of a cell.
        origin_m: (x, y) of the outer corner of cell (0, 0); rows go up along +y, columns along +x.
        cells: (H, W) uint8: 0 unknown, 1 free, 2 obstacle.
        regions: (H, W) uint8: 0 none, i = the i-th name of ``region_names``, counted from 1.
        region_names: e.g. ``("hallway", "kitchen")``.
    """

    floor: int
    resolution_m: float
    origin_m: tuple[float, float]
    cells: NDArray[np.uint8]
    regions: NDArray[np.uint8]
    region_names: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class EgocentricMemory:
    """Psi_k = Serialize(Arrange_G(w_k; w_0, w_{k-1}), P_k, mu_k).

    Args:
        pose: live pose.
        floor: current floor.
        region: map region the agent stands in; "" when none is known.
        waypoints: arranged around the agent.
        chain: P_k, waypoint indices, every visit in order.
        text: the serialised text, stable to the byte for the same state.
        map_image: mu_k, (H, W, 3) uint8 RGB, heading-up; None when the memory is switched off.
        frontiers: nearest first.
    """

    pose: Pose
    floor: int
    region: str
    waypoints: tuple[ArrangedWaypoint, ...]
    chain: tuple[int, ...]
    text: str
    map_image: NDArray[np.uint8] | None
    frontiers: tuple[Frontier, ...]
