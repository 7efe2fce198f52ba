"""Local Landmark Memory: the ranked pool of candidates for the landmark of the active stage (paper Sec. 3.2 and appendix).

One :class:`LocalLandmarkMemory` lives for one stage; a new stage starts a new one, so nothing stale survives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from spacevln.core import CueKind, LandmarkCandidate, LandmarkPool, Pose, Sighting, SpatialMap, egocentric_label
from spacevln.language import cue_kind
from spacevln.memory.arrival import ARRIVAL_RADIUS_M, blocked_by_wall
from spacevln.perception.attributes import Agreement
from spacevln.perception.matching import fit

TOP_K = 2  # [authors' code]
FUSION_DISTANCE_M = 0.6  # [authors' code]
FUSION_EXTENT_SHARE = 0.25  # a large thing seen from elsewhere shows another centre [ours]
FUSION_HEIGHT_M = 1.0  # the image cuts a thing in height more than in width: table legs from nearby, the top from afar [ours]
MIN_CONFIDENCE = 0.25  # [authors' code: box threshold]
MIN_PIXELS = 12  # with depth; smaller masks are noise [ours; the authors' code has no real filter]
DUPLICATE_IOU = 0.65  # [authors' code]
DUPLICATE_IOU_NEAR = 0.25  # with nearly the same range [authors' code]
DUPLICATE_RANGE_M = 0.35  # [authors' code]
MIN_ARRIVAL_CONFIDENCE = 0.4  # above what contradicted attributes allow [ours]
FLOOR_CHANGE_M = 1.0  # of height that makes another floor [authors' code]
SURFACE_CELL_M = 0.1
HIGH_M = 1.3  # over the floor; from nearby such a thing is above the image [ours]
LAST_SEEN_M = 3.0  # from where it was last in view [ours]


@dataclass(slots=True)
class _Instance:
    """A landmark instance of this stage."""

    number: int
    category: str
    attributes: tuple[str, ...]
    position: tuple[float, float, float]
    weight: float
    confidence: float
    extent_m: float
    best_view: tuple[bool, float]  # of an opening: seen with both jambs, nearness
    seen_in: int
    last_image: int
    seen_from: Pose
    last_sighting: Sighting
    looks: int = 1  # pictures that differ; the same one again says nothing new
    surface: dict[tuple[int, int], tuple[float, float]] = field(default_factory=dict)

    def nearest(self, pose: Pose) -> tuple[float, tuple[float, float]]:
        """Horizontal distance to the nearest surface point seen so far, and that point."""
        return min((pose.distance_m(x, y), (x, y)) for x, y in self.surface.values())


class LocalLandmarkMemory:
    """The landmark pool B^(k)_t of one stage.

    Args:
        landmark: the phrase ell_k; ``""`` tracks nothing.
        start: pose at the beginning of the stage.
        kind: of cue, decides the arrival rule; by default what the phrase says.
        traverse: the stage goes along the stairs to another floor instead of ending at them; arrival is the change of floor.
        arrival_sightings: temporal verification: how many different pictures must show a landmark before it counts as reached;
            1, the paper's rule, believes the first. [ours]
    """

    def __init__(
        self,
        landmark: str,
        start: Pose,
        *,
        kind: CueKind | None = None,
        traverse: bool = False,
        arrival_sightings: int = 1,
    ) -> None:
        self.landmark = landmark
        self.kind = cue_kind(landmark) if kind is None else kind
        self._start = start
        self._traverse = traverse and self.kind is CueKind.STAIRS
        self._arrival_sightings = arrival_sightings
        self._instances: list[_Instance] = []
        self._images = 0
        self._candidates: LandmarkPool = ()
        self._changed_floor = False

    def update(self, sightings: Sequence[Sighting], pose: Pose, metric_map: SpatialMap) -> None:
        """Fuse the sightings of one image and judge every candidate from ``pose``."""
        self._images += 1
        fitting = [(sighting, capped) for sighting in sightings if (capped := self._confidence(sighting)) >= MIN_CONFIDENCE]
        fitting.sort(key=lambda item: (-item[1], item[0].distance_m, item[0].box_px))
        kept: list[tuple[Sighting, float]] = []
        for sighting, confidence in fitting:
            if not any(_duplicate(sighting, other) for other, _ in kept):
                kept.append((sighting, confidence))
        self._fuse(kept, pose)
        self._changed_floor = self._changed_floor or abs(pose.z_m - self._start.z_m) > FLOOR_CHANGE_M
        self._candidates = tuple(sorted((self._judge(instance, pose, metric_map) for instance in self._instances), key=_rank))

    def pool(self, k: int = TOP_K) -> LandmarkPool:
        """Top-K: confidence descending, then distance ascending."""
        return self._candidates[:k]

    @property
    def candidates(self) -> LandmarkPool:
        """Every candidate of the stage, in the same order."""
        return self._candidates

    @property
    def arrived(self) -> bool:
        """Whether one of the top candidates is reached, or the floor that the stairs lead to."""
        return any(candidate.arrived for candidate in self.pool()) or (self._traverse and self._changed_floor)

    def _confidence(self, sighting: Sighting) -> float:
        """Confidence that this is ell_k; 0 for what is no candidate."""
        if not self.landmark or sighting.pixels < MIN_PIXELS:
            return 0.0
        agreement = fit(self.landmark, sighting.category, sighting.attributes)
        return 0.0 if agreement is None else min(sighting.confidence, agreement.value)

    def _fuse(self, sightings: list[tuple[Sighting, float]], pose: Pose) -> None:
        """One-to-one, nearest pairs first: two things seen in one image stay two."""
        pairs = []
        for s, (sighting, _) in enumerate(sightings):
            for instance in self._instances:
                apart = self._apart(sighting, instance)
                compatible = fit(instance.category, sighting.category) or fit(sighting.category, instance.category)
                if apart <= 1 and compatible:
                    pairs.append((apart, s, instance.number))
        free_sightings, free_instances = set(range(len(sightings))), {instance.number for instance in self._instances}
        for _, s, number in sorted(pairs):
            if s in free_sightings and number in free_instances:
                free_sightings.discard(s)
                free_instances.discard(number)
                self._absorb(self._instances[number], *sightings[s])
                self._instances[number].seen_from = pose
        for s in sorted(free_sightings):
            self._instances.append(self._born(*sightings[s], pose))

    def _apart(self, sighting: Sighting, instance: _Instance) -> float:
        """Distance in three dimensions, 1 on the ellipsoid within which two places are one thing.

        A way through reaches from floor to lintel, and the image decides at which height it is seen: of openings, only what
        lies on another storey is apart in height.
        """
        gate_m = FUSION_DISTANCE_M + FUSION_EXTENT_SHARE * max(instance.extent_m, sighting.extent_m)
        across = math.dist(sighting.position_m[:2], instance.position[:2]) / gate_m
        upward = abs(sighting.position_m[2] - instance.position[2]) / FUSION_HEIGHT_M
        if self.kind is CueKind.OPENING:
            return across if upward <= 1 else math.inf
        return math.hypot(across, upward)

    def _born(self, sighting: Sighting, confidence: float, pose: Pose) -> _Instance:
        instance = _Instance(
            number=len(self._instances),
            category=sighting.category,
            attributes=sighting.attributes,
            position=sighting.position_m,
            weight=confidence,
            confidence=confidence,
            extent_m=sighting.extent_m,
            best_view=_view_quality(sighting),
            seen_in=1,
            last_image=self._images,
            seen_from=pose,
            last_sighting=sighting,
        )
        _add_surface(instance, sighting)
        return instance

    def _absorb(self, instance: _Instance, sighting: Sighting, confidence: float) -> None:
        """Position weighted by confidence, confidence the best so far (authors' code); an opening lies as in its best view."""
        if self.kind is CueKind.OPENING:
            if _view_quality(sighting) >= instance.best_view:
                instance.position, instance.best_view = sighting.position_m, _view_quality(sighting)
                instance.surface.clear()
                _add_surface(instance, sighting)
        else:
            total = instance.weight + confidence
            x, y, z = (
                (old * instance.weight + new * confidence) / total
                for old, new in zip(instance.position, sighting.position_m, strict=True)
            )
            instance.position, instance.weight = (x, y, z), total
            _add_surface(instance, sighting)
        if confidence > instance.confidence:
            instance.confidence, instance.category = confidence, sighting.category
            instance.attributes = sighting.attributes or instance.attributes
        instance.extent_m = max(instance.extent_m, sighting.extent_m)
        instance.seen_in += 1
        instance.looks += not _same_picture(sighting, instance.last_sighting)
        instance.last_sighting = sighting
        instance.last_image = self._images

    def _judge(self, instance: _Instance, pose: Pose, metric_map: SpatialMap) -> LandmarkCandidate:
        distance, point = instance.nearest(pose)
        return LandmarkCandidate(
            instance=instance.number,
            category=instance.category,
            position_m=instance.position,
            distance_m=distance,
            bearing_rad=pose.bearing_rad(*instance.position[:2]),
            confidence=instance.confidence,
            visible=instance.last_image == self._images,
            arrived=self._has_arrived(instance, distance, point, pose, metric_map),
            kind=self._kind(instance),
            attributes=instance.attributes,
            observations=instance.seen_in,
        )

    def _kind(self, instance: _Instance) -> CueKind:
        """An opening is one by its category and by its depth profile: without a way through, as a shut door, it is solid."""
        seen_through, _ = instance.best_view
        return CueKind.SOLID if self.kind is CueKind.OPENING and not seen_through else self.kind

    def _has_arrived(
        self, instance: _Instance, distance: float, point: tuple[float, float], pose: Pose, metric_map: SpatialMap
    ) -> bool:
        if instance.confidence < MIN_ARRIVAL_CONFIDENCE or instance.confidence <= Agreement.CONTRADICTED.value:
            return False
        if self._traverse:
            return self._changed_floor
        if instance.looks < self._arrival_sightings:
            return False
        if distance > ARRIVAL_RADIUS_M[self.kind]:  # of what is sought: a door may turn out to be open from nearby
            return False
        in_view = instance.last_image == self._images  # then a chair before the table is no wall
        return in_view or not blocked_by_wall(pose, point, metric_map) or _is_overhead(instance, pose, metric_map)


def summarise(pool: LandmarkPool, landmark: str) -> str:
    """The stage-end summary in one line, for the planner: what became of the landmark."""
    if not landmark:
        return "no landmark was tracked"
    if not pool:
        return f"{landmark}: never seen"
    return "; ".join(
        f"{candidate.category}{' (arrived)' if candidate.arrived else ''} {candidate.distance_m:.1f} m "
        f"{egocentric_label(candidate.bearing_rad)}{'' if candidate.visible else ', remembered'}"
        for candidate in pool
    )


def _is_overhead(instance: _Instance, pose: Pose, metric_map: SpatialMap) -> bool:
    """Whether it hangs too high to be in view from here, over furniture, and one came straight from where it was in view."""
    seen_from = instance.seen_from
    return (
        instance.position[2] - pose.z_m > HIGH_M
        and pose.distance_m(seen_from.x_m, seen_from.y_m) <= LAST_SEEN_M
        and metric_map.line_of_sight(pose.xy_m, seen_from.xy_m)
    )


def _rank(candidate: LandmarkCandidate) -> tuple[float, float, int]:
    return (-round(candidate.confidence, 2), round(candidate.distance_m, 3), candidate.instance)


def _add_surface(instance: _Instance, sighting: Sighting) -> None:
    for x, y in sighting.surface_m or (sighting.position_m[:2],):
        instance.surface.setdefault((math.floor(x / SURFACE_CELL_M), math.floor(y / SURFACE_CELL_M)), (x, y))


def _view_quality(sighting: Sighting) -> tuple[bool, float]:
    """With both jambs in view the threshold is known; from nearby it is known better."""
    return (sighting.is_passage, -sighting.distance_m)


def _same_picture(a: Sighting, b: Sighting) -> bool:
    """Whether two sightings of a thing come from the same picture, as when the body stood still."""
    return a.box_px == b.box_px and a.position_m == b.position_m


def _duplicate(a: Sighting, b: Sighting) -> bool:
    """Two masks of one thing in one image."""
    ax0, ay0, ax1, ay1 = a.box_px
    bx0, by0, bx1, by1 = b.box_px
    overlap = max(0, min(ax1, bx1) - max(ax0, bx0)) * max(0, min(ay1, by1) - max(ay0, by0))
    union = (ax1 - ax0) * (ay1 - ay0) + (bx1 - bx0) * (by1 - by0) - overlap
    iou = overlap / union if union > 0 else 0.0
    return iou >= DUPLICATE_IOU or (iou >= DUPLICATE_IOU_NEAR and abs(a.distance_m - b.distance_m) <= DUPLICATE_RANGE_M)
