"""A scripted walk through a furnished house where the body fits by everything that the map knows of: the truth's own geometry."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from house_truth import Truth, truth_of

from spacevln.core import Camera, EpisodeSpec, InstructionTask, Observation, Pose
from spacevln.environments.houses.environment import HousesEnvironment, Place, load_place
from spacevln.environments.houses.ground.walkable import RESOLUTION_M
from spacevln.environments.houses.plan import Rect, Room
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.testing.walks import scripted_walk

CAMERA = Camera(320, 240, 79.0, 0.88)
VIEWS = 12  # of a look-around, as the agent makes it
_BODY_M = 0.13  # the walker's way keeps it from everything 0.15 to 1.30 m over the floor


@dataclass(frozen=True, slots=True)
class Stop:
    """A place on the walk and what is seen there: one image, or all of a look-around.

    Args:
        pose: scene frame.
        room: that holds it; None on a threshold or on stairs.
        poses: of the images, scene frame.
    """

    pose: Pose
    room: Room | None
    poses: tuple[Pose, ...]

    @property
    def looks_around(self) -> bool:
        return len(self.poses) > 1


@dataclass(frozen=True, slots=True, eq=False)
class WalkedHouse:
    """A house, what stands in it, and a walk through it.

    Args:
        truths: of every storey.
        stops: in order.
    """

    place: Place
    truths: tuple[Truth, ...]
    stops: tuple[Stop, ...]

    @property
    def start(self) -> Pose:
        """The first pose: origin of the episode frame."""
        return self.stops[0].poses[0]

    @property
    def poses(self) -> list[Pose]:
        """Of all images, scene frame."""
        return [pose for stop in self.stops for pose in stop.poses]


def walk(seed: int, rooms: int | None = None) -> WalkedHouse:
    """Through every room of every floor, or so many: an image every half metre, a look-around in each room and every 4 m."""
    place = load_place(f"house-{seed:06d}")
    truths = tuple(truth_of(place, floor.index) for floor in place.drawable.house.floors)
    stops: list[Stop] = []
    pending = False
    stands = scripted_walk(_true_geodesics(place, truths), seed, every_m=4.0, rooms=rooms)
    for number, stand in enumerate(stands):
        pending = pending or stand.looks_around
        if pending and stand.room is not None:
            stops.append(Stop(stand.pose, stand.room, tuple(stand.pose.turned(k * math.tau / VIEWS) for k in range(VIEWS))))
            pending = False
        elif number % 2 == 0 or stand.room is None:
            stops.append(Stop(stand.pose, stand.room, (stand.pose,)))
    return WalkedHouse(place, truths, tuple(stops))


def _true_geodesics(place: Place, truths: tuple[Truth, ...]) -> Geodesics:
    """The house's ways, less those past what its collision model leaves out, such as a door knob at the height of the eye."""
    ground = copy.copy(place.ground)
    spaces = []
    for space, truth in zip(ground.floors, truths, strict=True):
        i, j = np.indices(space.clearance_m.shape).reshape(2, -1)
        centres = np.array(space.origin_m) + (np.stack([i, j], axis=1) + 0.5) * RESOLUTION_M
        clear = truth.at(truth.distance_m, centres).reshape(space.clearance_m.shape).astype(np.float32)
        for stairs in place.drawable.house.stairs:
            r = stairs.rect
            on_flight = space.cells_of(Rect(r.x0 - 0.3, r.y0 - 0.3, r.x1 + 0.3, r.y1 + 0.3))
            clear[on_flight] = space.clearance_m[on_flight]  # steps are no obstacles
        spaces.append(replace(space, clearance_m=np.minimum(space.clearance_m, clear)))
    ground.floors = tuple(spaces)
    return Geodesics(ground, _BODY_M)


def look(walked: WalkedHouse, camera: Camera = CAMERA) -> Iterator[tuple[Stop, list[Observation]]]:
    """What the camera sees at each stop, in the episode frame of the first pose."""
    house = walked.place.drawable.house
    environment = HousesEnvironment(camera, load=lambda _: walked.place)

    def image(pose: Pose) -> Observation:
        seen = environment.reset(EpisodeSpec("", house.name, pose, InstructionTask("look")))
        return replace(seen, pose=pose.relative_to(walked.start), T_world_camera=None)

    for stop in walked.stops:
        yield stop, [image(pose) for pose in stop.poses]
    environment.close()


def to_scene(start: Pose, xy_m: np.ndarray) -> np.ndarray:
    """Points of the episode frame in the scene frame."""
    c, s = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    return xy_m @ np.array([[c, s], [-s, c]]) + start.xy_m


def to_episode(start: Pose, xy_m: np.ndarray) -> np.ndarray:
    """Points of the scene frame in the episode frame."""
    c, s = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    return (xy_m - start.xy_m) @ np.array([[c, -s], [s, c]])
