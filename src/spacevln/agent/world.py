"""What the agent knows of the world: perception, the metric map and Spatial Cognitive Memory, behind the component switches."""

from __future__ import annotations

from collections.abc import Sequence

from spacevln.agent.floor_maps import floor_maps
from spacevln.agent.settings import Components
from spacevln.core import (
    Anchor,
    Detector,
    EgocentricMemory,
    FloorMap,
    LandmarkCandidate,
    LandmarkPool,
    Observation,
    ObstacleDistances,
    Pose,
    Sighting,
    SpaceKind,
    SpatialMap,
    SpatialWaypoint,
    Subtask,
)
from spacevln.language import grounding_terms
from spacevln.mapping import Incline, MetricMap
from spacevln.memory import BuildingMemory, HierarchicalSpatialMemory, LocalLandmarkMemory, SpatialCognitiveMemory
from spacevln.perception import lift


class World:
    """Knowledge of one episode.

    Args:
        detector: grounds phrases.
        components: what is switched off is never built.
        known: the memory of earlier episodes in this building, grown in place; the agent's poses are in its frame.
        body_radius_m: of the agent's disc; a known map keeps its own.
        arrival_sightings: see :class:`~spacevln.memory.LocalLandmarkMemory`.
    """

    def __init__(
        self,
        detector: Detector,
        components: Components,
        known: BuildingMemory | None = None,
        body_radius_m: float = 0.1,
        arrival_sightings: int = 1,
    ) -> None:
        self._detector = detector
        self._components = components
        self._arrival_sightings = arrival_sightings
        building = known or BuildingMemory(MetricMap(agent_radius_m=body_radius_m), HierarchicalSpatialMemory())
        building.start_episode()
        self.map = building.metric_map
        self.memory = SpatialCognitiveMemory(building.hierarchical, arrival_sightings)  # M_0 = {W_0, L_0}, W_0 = {G_0, P_0}
        self.stage_terms: tuple[str, ...] = ()  # of the last stage: its landmark as written, and Norm(ell_k)
        self._taken_flights = -1  # of the chain, verified; none is known before the first stage
        self._departure_floor = self.map.floor  # where the flight that is ahead begins

    @property
    def space(self) -> SpatialMap:
        """Queries on the metric map."""
        return self.map

    def integrate(self, observation: Observation, sightings: Sequence[Sighting] = ()) -> None:
        """Update the metric map by one posed image and what was sighted in it."""
        self.map.integrate(observation, sightings)

    def perceive(self, observations: Sequence[Observation], terms: Sequence[str]) -> list[tuple[Sighting, ...]]:
        """Sightings of ``terms``, one tuple per image; the detector is not asked for nothing."""
        if not terms:
            return [()] * len(observations)
        found = self._detector.detect(observations, terms)
        return [lift(observation, detections) for observation, detections in zip(observations, found, strict=True)]

    def obstacles(self, observation: Observation, incline: Incline | None = None) -> ObstacleDistances:
        """Omega_t, map and depth fused; what lies on the flight of stairs that is being taken is none."""
        return self.map.obstacle_distances(observation, incline)

    def clearance_m(self, observation: Observation, bearing_rad: float = 0.0) -> float:
        """Distance to the nearest obstacle in the direction of an image, or in another one from where it was taken [m]."""
        return self.map.sector_distance_m(observation, bearing_rad)

    def serialise(self, pose: Pose) -> EgocentricMemory | None:
        """Psi_k; None when Hierarchical Spatial Memory is switched off."""
        return self.memory.egocentric(pose, self.map) if self._components.hsm else None

    def remember(self, pose: Pose, anchor: Anchor, sightings: Sequence[Sighting]) -> SpatialWaypoint | None:
        """Update_HSM: w_k joins graph and chain; None when Hierarchical Spatial Memory is switched off."""
        if not self._components.hsm:
            return None
        return self.memory.add_waypoint(pose, anchor, sightings, self.map)

    def locate(self, pose: Pose) -> tuple[int, str]:
        """Current floor, and region type of the map region that holds the pose; ``""`` when none is known."""
        memory = self.memory.hierarchical
        region = memory.region_at(pose, self.map.floor) if self._components.hsm else None
        return self.map.floor, memory.waypoints[region.waypoints[0]].region if region else ""

    @property
    def changed_floor(self) -> bool:
        """Whether another floor was reached since the last flight of the chain that is verified, or since the start.

        Believed after a few steady steps, often only in the look-around at the top. However many stages a flight takes, and
        whenever the anchors before it are verified, it begins where the flight before it ended.
        """
        return self.map.floor != self._departure_floor

    def begin_stage(self, subtask: Subtask, pose: Pose) -> tuple[str, ...]:
        """L^(k)_0 and B^(k)_0 are empty; the terms that the detector grounds in this stage."""
        anchor = subtask.next_anchor
        kind = anchor.cue_kind if anchor is not None and anchor.cue and anchor.cue == subtask.landmark else None
        traverse = anchor is not None and anchor.space_kind is SpaceKind.FLOOR_TRANSITION
        landmark = subtask.landmark if self._components.landmark_memory else ""
        taken = sum(each.space_kind is SpaceKind.FLOOR_TRANSITION for each in subtask.chain[: subtask.current_index + 1])
        if taken != self._taken_flights:
            self._taken_flights, self._departure_floor = taken, self.map.floor
        self.map.start_stage()
        self.memory.begin_stage(landmark, pose, kind=kind, traverse=traverse)
        self.stage_terms = grounding_terms(landmark)
        return self.stage_terms

    def update_landmarks(self, sightings: Sequence[Sighting], pose: Pose) -> None:
        """Update_landmark (Algorithm 1 line 11): fuse the sightings of one image."""
        self.memory.update(sightings, pose, self.map)

    def pool(self) -> LandmarkPool:
        """Compress_landmark (line 12): B^(k)_t, the top K."""
        return self.memory.landmarks.pool()

    def evidence(self, anchor: Anchor, observations: Sequence[Observation]) -> LandmarkPool:
        """Candidates of an anchor's cue in the images of a look-around, judged from the place they were taken at."""
        if not self._components.landmark_memory:
            return ()
        pose = observations[0].pose
        landmarks = LocalLandmarkMemory(anchor.cue, pose, kind=anchor.cue_kind, arrival_sightings=self._arrival_sightings)
        in_view: list[LandmarkCandidate] = []
        for sightings in self.perceive(observations, grounding_terms(anchor.cue)):
            landmarks.update(sightings, pose, self.map)
            in_view += [candidate for candidate in landmarks.candidates if candidate.visible and candidate.arrived]
        return (*in_view, *landmarks.pool())  # what one image shows in reach is no farther when the next looks away

    def floor_maps(self) -> tuple[FloorMap, ...]:
        """The map as it stands, one picture per floor."""
        return floor_maps(self.map, self.memory.hierarchical)
