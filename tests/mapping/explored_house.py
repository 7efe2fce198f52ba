"""A furnished house explored by the scripted walk, mapped and remembered, with the true room types as the planner's words."""

from __future__ import annotations

import itertools
from dataclasses import astuple, dataclass, field

import numpy as np
from house_scores import Witness
from house_walks import CAMERA, WalkedHouse, look, to_episode, walk
from numpy.typing import NDArray

from spacevln.core import Camera
from spacevln.environments.houses.plan import House, Room
from spacevln.language import known_categories
from spacevln.mapping import MetricMap
from spacevln.memory import SpatialCognitiveMemory
from spacevln.memory.region_raster import RegionRaster, region_raster
from spacevln.perception import LabelDetector, lift


@dataclass
class Explored:
    """What the map and the memory know after a walk; poses of the memory are relative to the first one.

    Args:
        walked: the house and the walk.
        witness: of what was to be seen.
        rooms: of each waypoint.
    """

    walked: WalkedHouse
    witness: Witness
    metric_map: MetricMap = field(default_factory=MetricMap)
    memory: SpatialCognitiveMemory = field(default_factory=SpatialCognitiveMemory)
    rooms: list[Room] = field(default_factory=list)

    @property
    def house(self) -> House:
        """The plan."""
        return self.walked.place.drawable.house

    @property
    def visited(self) -> list[Room]:
        """Rooms with a waypoint, each once."""
        return list({room.id: room for room in self.rooms}.values())

    @property
    def floors(self) -> dict[int, int]:
        """The map's number of every visited storey."""
        waypoints = self.memory.hierarchical.waypoints
        return {room.floor: waypoint.floor for room, waypoint in zip(self.rooms, waypoints, strict=True)}

    def raster(self, floor: int) -> RegionRaster:
        """Regions of a storey."""
        raster = region_raster(self.memory.hierarchical, floor)
        assert raster is not None
        return raster

    def to_memory(self, xy: NDArray[np.float64]) -> NDArray[np.float64]:
        """Scene points (N, 2) in the memory's frame."""
        return to_episode(self.walked.start, xy)

    def floor_points(self, room: Room) -> NDArray[np.float64]:
        """Known free floor of a room, one point every 10 cm, memory's frame."""
        grids = [
            np.stack(np.meshgrid(np.arange(r.x0 + 0.05, r.x1, 0.1), np.arange(r.y0 + 0.05, r.y1, 0.1)), axis=-1).reshape(-1, 2)
            for r in room.rects
        ]
        points = self.to_memory(np.unique(np.concatenate(grids).round(3), axis=0))
        crop = self.metric_map.crop(points.mean(axis=0), 40.0, floor=self.floors[room.floor])
        column, row = np.rint(crop.to_px(points)).astype(int).T
        return points[crop.free[row, column]]


def explore(seed: int, rooms: int | None = None, camera: Camera = CAMERA) -> Explored:
    """Walk through every room, or so many, map every image, add a Spatial Waypoint at each look-around."""
    walked, detector = walk(seed, rooms), LabelDetector()
    explored = Explored(walked, Witness(walked, np.random.default_rng(seed)))
    for stop, images in look(walked, camera):
        for pose, image in zip(stop.poses, images, strict=True):
            explored.metric_map.integrate(image)
            explored.witness.see(pose, image)
        if stop.looks_around and stop.room is not None:
            found = detector.detect(images, known_categories())
            sightings = [
                sighting for image, detections in zip(images, found, strict=True) for sighting in lift(image, detections)
            ]
            pose = stop.pose.relative_to(walked.start)
            explored.memory.add_waypoint(pose, stop.room.type, sightings, explored.metric_map)
            explored.rooms.append(stop.room)
    return explored


@dataclass(frozen=True)
class Quality:
    """Counts over one or several houses; see the properties."""

    right: int = 0
    owned: int = 0
    covered: int = 0
    free: int = 0
    regions: int = 0
    rooms: int = 0
    merged: int = 0
    pairs: int = 0

    def __add__(self, other: Quality) -> Quality:
        return Quality(*(one + two for one, two in zip(astuple(self), astuple(other), strict=True)))

    @property
    def purity(self) -> float:
        """Share of the regions' cells that lie in a room of the region's type."""
        return self.right / self.owned

    @property
    def cover(self) -> float:
        """Share of the explored floor of visited rooms that a region of some waypoint owns."""
        return self.covered / self.free

    @property
    def regions_per_room(self) -> float:
        """1 when every visited room is one region."""
        return self.regions / self.rooms

    @property
    def merged_share(self) -> float:
        """Share of the pairs of visited rooms of one type on one floor that share a region."""
        return self.merged / self.pairs if self.pairs else 0.0


def quality(case: Explored) -> Quality:
    """Regions of a house against its plan."""
    hierarchical = case.memory.hierarchical
    types = [region.type for region in hierarchical.regions.all]
    visited = {room.id for room in case.rooms}
    right = owned = covered = free = 0
    for room in case.house.rooms:
        if room.floor not in case.floors:
            continue
        points = case.floor_points(room)
        owners = case.raster(case.floors[room.floor]).at(points)
        owned += int(np.count_nonzero(owners))
        right += sum(types[owner - 1] == room.type for owner in owners.tolist() if owner)
        if room.id in visited:
            free += len(points)
            covered += int(np.count_nonzero(owners))
    regions_of: dict[int, set[str]] = {}
    for index, room in enumerate(case.rooms):
        regions_of.setdefault(room.id, set()).add(hierarchical.regions.of(index).label)
    pairs = [(a, b) for a, b in itertools.combinations(case.visited, 2) if a.type == b.type and a.floor == b.floor]
    merged = sum(bool(regions_of[a.id] & regions_of[b.id]) for a, b in pairs)
    return Quality(right, owned, covered, free, len(types), len(case.visited), merged, len(pairs))
