"""Spatial Cognitive Memory M_t = {W_t, L_t}: the shared planner-executor state, as the agent loop holds it."""

from __future__ import annotations

from collections.abc import Sequence

from spacevln.core import Anchor, CueKind, EgocentricMemory, LandmarkPool, Pose, Sighting, SpatialWaypoint
from spacevln.memory.hierarchical import HierarchicalSpatialMemory
from spacevln.memory.landmarks import LocalLandmarkMemory
from spacevln.memory.metric import MemoryMap


class SpatialCognitiveMemory:
    """Both memories of one episode.

    Args:
        hierarchical: W_t; a loaded one continues in a known building.
        arrival_sightings: see :class:`LocalLandmarkMemory`.
    """

    def __init__(self, hierarchical: HierarchicalSpatialMemory | None = None, arrival_sightings: int = 1) -> None:
        self.hierarchical = hierarchical or HierarchicalSpatialMemory()
        self._arrival_sightings = arrival_sightings
        self.landmarks = LocalLandmarkMemory("", Pose(0.0, 0.0))

    def add_waypoint(
        self, pose: Pose, anchor: Anchor | str, sightings: Sequence[Sighting], metric_map: MemoryMap
    ) -> SpatialWaypoint:
        """w_k, once the planner's reply is validated. ``sightings`` are those of all views of the look-around."""
        return self.hierarchical.add(pose, metric_map.floor, anchor, sightings, metric_map)

    def begin_stage(self, landmark: str, pose: Pose, *, kind: CueKind | None = None, traverse: bool = False) -> None:
        """Drop the last stage's landmarks and track ``landmark``; see :class:`LocalLandmarkMemory`."""
        self.landmarks = LocalLandmarkMemory(
            landmark, pose, kind=kind, traverse=traverse, arrival_sightings=self._arrival_sightings
        )

    def update(self, sightings: Sequence[Sighting], pose: Pose, metric_map: MemoryMap) -> LandmarkPool:
        """Fuse the sightings of one image into the landmark pool; the new pool."""
        self.landmarks.update(sightings, pose, metric_map)
        return self.landmarks.pool()

    def egocentric(self, pose: Pose, metric_map: MemoryMap) -> EgocentricMemory:
        """Psi_k."""
        return self.hierarchical.egocentric(pose, metric_map)
