"""Hierarchical Spatial Memory W_t = {G_t, P_t}: floors, regions, Spatial Waypoints, their graph and the executed chain.

Paper Sec. 3.2 and appendix "Spatial Cognitive Memory Construction".
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from spacevln.core import Anchor, CueKind, EgocentricMemory, LandmarkCue, Pose, Sighting, SpatialWaypoint
from spacevln.language import cue_kind, parse_region
from spacevln.memory.arrange import arrange
from spacevln.memory.graph import Edge, WaypointGraph
from spacevln.memory.metric import MemoryMap
from spacevln.memory.region_raster import region_raster
from spacevln.memory.regions import UNKNOWN_PLACE, Region, Regions
from spacevln.memory.rendering import render_map
from spacevln.memory.serialize import serialize
from spacevln.memory.thresholds import Thresholds
from spacevln.perception.matching import names

CUE_RANGE_M = 6.0  # farther things describe another place [ours]
MAX_CUES = 32  # what a room shows [ours]
SAME_CUE_M = 0.6


class HierarchicalSpatialMemory:
    """Grows by one Spatial Waypoint at every planning boundary.

    Nothing that was added is ever merged away: regions group waypoints, :func:`~spacevln.memory.arrange.arrange` merges
    overlapping ones for display only, the chain keeps every visit.
    """

    def __init__(self) -> None:
        self.graph = WaypointGraph()
        self.regions = Regions()
        self.thresholds = Thresholds()
        self._waypoints: list[SpatialWaypoint] = []
        self._chains = [0]  # index of the first waypoint of every episode's chain
        self._adjacent: set[frozenset[str]] = set()
        self._adjacent_at = 0  # version of the regions that it was found for
        self._walked_until = 0  # length of the map's trajectory when the last waypoint was added

    @classmethod
    def restored(
        cls,
        waypoints: Sequence[SpatialWaypoint],
        chain_starts: Sequence[int],
        graph: WaypointGraph,
        regions: Regions,
        thresholds: Thresholds,
    ) -> HierarchicalSpatialMemory:
        """What was saved (``memory.persistence``), ready for :meth:`start_episode`."""
        memory = cls()
        memory.graph, memory.regions, memory.thresholds = graph, regions, thresholds
        memory._waypoints, memory._chains = list(waypoints), list(chain_starts)
        return memory

    @property
    def waypoints(self) -> tuple[SpatialWaypoint, ...]:
        """Every waypoint, by index."""
        return tuple(self._waypoints)

    @property
    def chain(self) -> tuple[int, ...]:
        """P: waypoint indices, every visit of this episode in order."""
        return tuple(range(self._chains[-1], len(self._waypoints)))

    @property
    def chains(self) -> tuple[tuple[int, ...], ...]:
        """The chain of every episode in this building, the present one last; mostly there is one."""
        ends = (*self._chains[1:], len(self._waypoints))
        return tuple(tuple(range(first, end)) for first, end in zip(self._chains, ends, strict=True))

    @property
    def chain_starts(self) -> tuple[int, ...]:
        """Index of the first waypoint of every chain."""
        return tuple(self._chains)

    def start_episode(self) -> None:
        """Keep what is known and begin a new chain: nothing joins the last waypoint to the next one."""
        if self.chain:
            self._chains.append(len(self._waypoints))
        self._walked_until = 0

    @property
    def floors(self) -> tuple[int, ...]:
        """Floors with waypoints, ascending."""
        return tuple(sorted({waypoint.floor for waypoint in self._waypoints}))

    @property
    def floor_transitions(self) -> tuple[Edge, ...]:
        """Edges whose ends lie on different floors."""
        return tuple(edge for edge in self.graph.edges if edge.floor_transition)

    def add(
        self, pose: Pose, floor: int, anchor: Anchor | str, sightings: Sequence[Sighting], metric_map: MemoryMap
    ) -> SpatialWaypoint:
        """Instantiate w_k = (x_k, f_k, r_k, Lambda_k) and join it to graph, chain and regions.

        Args:
            pose: x_k.
            floor: f_k.
            anchor: the planner's current anchor v^{j_k}_k; ParseRegion gives r_k and the cues it names.
            sightings: of the look-around, all views.
            metric_map: m_t.
        """
        region, named = parse_region(anchor)
        self.thresholds.add(sightings, floor)
        waypoint = SpatialWaypoint(
            index=len(self._waypoints),
            pose=pose,
            floor=floor,
            region=region,
            cues=self._cues(pose, floor, named, sightings),
            text=str(anchor),
        )
        earlier = self.waypoints
        self._waypoints.append(waypoint)
        self.graph.connect_map(waypoint, earlier, metric_map)
        if len(self.chain) > 1:
            self._connect_chain(earlier[-1], waypoint, metric_map)
        self._walked_until = len(metric_map.travelled)
        self.regions.update(self._waypoints, metric_map, self.thresholds)
        return waypoint

    def region_at(self, pose: Pose, floor: int) -> Region | None:
        """The region that a pose stands in; None when no waypoint's support holds it."""
        return self.regions.at(pose.xy_m, floor, self._waypoints)

    def region_neighbours(self, region: Region) -> tuple[Region, ...]:
        """Regions that an edge leads to without crossing a third one, stairs included."""
        if self._adjacent_at != self.regions.version:
            self._adjacent, self._adjacent_at = self._adjacent_regions(), self.regions.version
        return tuple(other for other in self.regions.all if frozenset((region.label, other.label)) in self._adjacent)

    def _adjacent_regions(self) -> set[frozenset[str]]:
        owners = {floor: region_raster(self, floor) for floor in self.floors}
        order = {region.label: index for index, region in enumerate(self.regions.all)}
        pairs = set()
        for edge in self.graph.edges:
            a, b = self.regions.of(edge.a), self.regions.of(edge.b)
            owner = owners[a.floor]
            if a is b or owner is None:
                continue
            if edge.floor_transition or owner.crossed(self.graph.path_of(edge)) <= {order[a.label], order[b.label]}:
                pairs.add(frozenset((a.label, b.label)))
        return pairs

    def egocentric(self, pose: Pose, metric_map: MemoryMap) -> EgocentricMemory:
        """Psi_k = Serialize(Arrange_G(w_k; w_0, w_{k-1}), P_k, mu_k), around the live pose."""
        floor = metric_map.floor
        here = self.region_at(pose, floor)
        arranged = arrange(self, pose, metric_map)
        frontiers = tuple(metric_map.frontiers(pose))
        return EgocentricMemory(
            pose=pose,
            floor=floor,
            region=here.type if here and here.type != UNKNOWN_PLACE else "",
            waypoints=arranged,
            chain=self.chain,
            text=serialize(self, pose, floor, arranged, frontiers),
            map_image=render_map(self, pose, metric_map, [item.waypoint for item in arranged]),
            frontiers=frontiers,
        )

    def _connect_chain(self, before: SpatialWaypoint, waypoint: SpatialWaypoint, metric_map: MemoryMap) -> None:
        """The known way between two consecutive waypoints: on the map, or, where that does not join them, as walked."""
        path = np.zeros((0, 2))
        if before.floor == waypoint.floor:
            path = metric_map.path(before.pose.xy_m, waypoint.pose.xy_m)
        if len(path) == 0:
            path = np.vstack([before.pose.xy_m, metric_map.travelled[self._walked_until :, :2], waypoint.pose.xy_m])
        self.graph.connect_chain(before, waypoint, path, float(np.hypot(*np.diff(path, axis=0).T).sum()))

    def _cues(self, pose: Pose, floor: int, named: Sequence[str], sightings: Sequence[Sighting]) -> tuple[LandmarkCue, ...]:
        """Lambda_k: what the anchor names first, then what was seen in this space, each thing once."""
        cues: list[LandmarkCue] = []
        for sighting in sorted(sightings, key=lambda s: (s.is_passage, -s.confidence, s.distance_m, s.category, s.position_m)):
            passage = cue_kind(sighting.category) is CueKind.OPENING
            if sighting.distance_m > CUE_RANGE_M or any(_same_cue(cue, sighting) for cue in cues):
                continue
            if not passage and self.thresholds.between(floor, pose.xy_m, np.array(sighting.position_m[:2])):
                continue  # seen through a doorway: it belongs to the next space
            cues.append(
                LandmarkCue(
                    category=sighting.category,
                    attributes=sighting.attributes,
                    position_m=sighting.position_m,
                    confidence=sighting.confidence,
                    distance_m=sighting.distance_m,
                    extent_m=sighting.extent_m,
                    is_passage=sighting.is_passage,
                )
            )
        for phrase in reversed(named):
            seen = next((cue for cue in sorted(cues, key=lambda cue: cue.distance_m) if names(phrase, cue.category)), None)
            if seen is not None:
                cues.remove(seen)
            cues.insert(0, seen or LandmarkCue(phrase))
        return tuple(cues[:MAX_CUES])


def _same_cue(cue: LandmarkCue, sighting: Sighting) -> bool:
    if cue.position_m is None or not (names(cue.category, sighting.category) or names(sighting.category, cue.category)):
        return False
    return math.dist(cue.position_m, sighting.position_m) <= SAME_CUE_M + 0.25 * max(cue.extent_m, sighting.extent_m)
