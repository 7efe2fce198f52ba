"""A furnished house explored by the scripted walk and remembered, with the true room types as the planner's words."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import astuple, dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Camera, EpisodeSpec, InstructionTask, Observation, Pose
from spacevln.environments.houses.environment import HousesEnvironment, load_place
from spacevln.environments.houses.plan import House, Room
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.language import known_categories
from spacevln.mapping import MetricMap
from spacevln.memory import SpatialCognitiveMemory
from spacevln.memory.region_raster import RegionRaster, region_raster
from spacevln.perception import LabelDetector, lift
from spacevln.testing.walks import scripted_walk, turned_around

CAMERA = Camera(320, 240, 79.0, 0.88)
place_of = functools.lru_cache(maxsize=2)(load_place)


@dataclass
class Explored:
    """A house and what is remembered of it; poses of the memory are relative to ``start``."""

    house: House
    start: Pose
    metric_map: MetricMap = field(default_factory=MetricMap)
    memory: SpatialCognitiveMemory = field(default_factory=SpatialCognitiveMemory)
    rooms: list[Room] = field(default_factory=list)  # of each waypoint

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
        c, s = math.cos(self.start.yaw_rad), math.sin(self.start.yaw_rad)
        return (xy - self.start.xy_m) @ np.array([[c, -s], [s, c]])

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


def explore(seed: int, environment: HousesEnvironment, rooms: int | None = None) -> Explored:
    """Walk through every room, or so many, look around, add a Spatial Waypoint at each look-around."""
    place = place_of(f"house-{seed:06d}")
    house, detector = place.drawable.house, LabelDetector()
    explored: Explored | None = None

    def look(pose: Pose) -> Observation:
        assert explored is not None
        seen = environment.reset(EpisodeSpec("", house.name, pose, InstructionTask("look")))
        return replace(seen, pose=pose.relative_to(explored.start), T_world_camera=None)

    pending = False
    for number, stand in enumerate(scripted_walk(Geodesics(place.ground), seed, rooms=rooms)):
        explored = explored or Explored(house, stand.pose)
        pending = pending or stand.looks_around
        if not (pending and stand.room is not None):
            if number % 2 == 0 or stand.room is None:  # every half metre, on stairs twice as often
                explored.metric_map.integrate(look(stand.pose))
            continue
        pending = False
        views = [look(pose) for pose in turned_around(stand.pose)]
        for view in views:
            explored.metric_map.integrate(view)
        found = detector.detect(views, known_categories())
        sightings = [sighting for view, detections in zip(views, found, strict=True) for sighting in lift(view, detections)]
        pose = stand.pose.relative_to(explored.start)
        explored.memory.add_waypoint(pose, stand.room.type, sightings, explored.metric_map)
        explored.rooms.append(stand.room)
    assert explored is not None
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
