"""The tiled metric RGB-D map (paper, "Tiled metric RGB-D world map"; DESIGN 5.2)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core import Frontier, Observation, ObstacleDistances, Pose, Sighting, UsageError
from spacevln.mapping import persistence, sectors
from spacevln.mapping.contract import check_frame
from spacevln.mapping.crops import MapCrop, crop_floor
from spacevln.mapping.floor_view import FloorView, points_xy
from spacevln.mapping.floors import Floor, FloorTracker, StairConnector
from spacevln.mapping.geodesics import GeodesicField
from spacevln.mapping.incline import Incline
from spacevln.mapping.integration import FrameWriter
from spacevln.mapping.stairways import across_floors_m
from spacevln.mapping.traces import Trace

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]


class MetricMap:
    """A metric map of any posed RGB-D stream: what is explored, free and an obstacle, and the ways on it.

    Input contract: each :class:`Observation` has depth in metres along the optical axis of a rectified pinhole camera (H, W,
    floating point), the pose of the agent's feet, and ``T_world_camera`` (4, 4; camera x forward, y left, z up), all in one fixed
    frame with z up. Depth outside 0.5 to 5.0 m, zero, negative, NaN and infinite depth is no measurement. Frames may come in
    any order, from anywhere; the floor is told from the height of the feet. Every query is about the current floor
    (:meth:`on_floor` asks another); all points are metres in that frame, (N, 2) or (2,).

    Args:
        resolution_m: side of a cell.
        agent_radius_m: of the disc that the agent is.

    Raises:
        UsageError: a value is not positive.
    """

    def __init__(self, resolution_m: float = 0.05, agent_radius_m: float = 0.1) -> None:
        if not (0.01 <= resolution_m <= 0.5 and 0 < agent_radius_m <= 2.0):
            raise UsageError(
                f"MetricMap(resolution_m={resolution_m}, agent_radius_m={agent_radius_m}) is out of range: "
                "allowed are cells of 0.01 to 0.5 m and a radius up to 2 m."
            )
        self.resolution_m = resolution_m
        self.agent_radius_m = agent_radius_m
        self._tracker = FloorTracker(agent_radius_m / resolution_m)
        self._writer = FrameWriter(resolution_m, agent_radius_m)
        self._trace = Trace()
        self._decided = 0  # places of the trace whose floor is certain
        self._pending: list[tuple[Observation, tuple[Sighting, ...]]] = []
        self._views: dict[int, FloorView] = {}
        self._nowhere = FloorTracker(1.0).open(0, 0.0)  # before the first frame

    # -- integrating -------------------------------------------------------------------------------------------------------

    def integrate(self, observation: Observation, sightings: Sequence[Sighting] = ()) -> None:
        """Add one posed RGB-D image, and where landmarks were sighted in it.

        Args:
            observation: see the class; its constructor checks shapes and types.
            sightings: lifted detections of the active landmark terms.

        Raises:
            UsageError: the pose or the camera's transform is not finite or no rigid transform, the camera frame is an optical
                one, or the depth is not in metres.
        """
        check_frame(observation)
        pose = observation.pose
        self._writer.project(observation)
        before = self._tracker.current
        floor = self._tracker.update(pose, self._writer.flat_cells)
        self._trace.append(pose.x_m, pose.y_m, floor.id)
        if self._tracker.stable_steps:  # on which floor this was seen is decided by the next frames
            self._pending.append((observation, tuple(sightings)))
            return
        if self._pending:
            self._trace.relabel(self._decided, floor.id)
            for frame, found in self._pending:
                self._writer.project(frame)
                self._settle(frame, found, floor)
            self._pending.clear()
            if before is not None and before is not floor:
                self._writer.leave(before, floor, pose)
            self._writer.project(observation)
        self._settle(observation, sightings, floor)
        self._decided = len(self._trace)

    def _settle(self, observation: Observation, sightings: Sequence[Sighting], floor: Floor) -> None:
        self._writer.settle(observation, floor)
        self._writer.settle_sightings(sightings, floor)

    def start_stage(self) -> None:
        """Begin a new stage: its trajectory starts here and the landmark channels of the last stage are dropped."""
        self._trace.start_stage()
        for floor in self._tracker.floors.values():
            floor.semantic.clear()

    def start_episode(self) -> None:
        """Keep what is known and begin anew, e.g. after :meth:`load`: the next pose may be anywhere in the same frame."""
        self._tracker.start_episode()
        self._trace, self._decided = Trace(), 0
        self._writer.resume(None, None)
        self._pending.clear()
        self.start_stage()

    # -- keeping -----------------------------------------------------------------------------------------------------------

    def save(self, path: str | Path) -> None:
        """Write the map to a ``.npz`` file (see ``mapping.persistence``); a file that was there is replaced whole.

        Frames on a landing that wait for the decision which floor they belong to (at most 3) are not part of it.
        """
        persistence.write(self.to_arrays(), Path(path))

    @classmethod
    def load(cls, path: str | Path) -> MetricMap:
        """The map that :meth:`save` wrote; it goes on where that one was. See :meth:`start_episode` for a new way in it.

        Raises:
            UsageError: the file is missing, damaged, no map, or of another version.
        """
        return cls.from_arrays(persistence.read(Path(path)))

    def to_arrays(self) -> dict[str, NDArray[Any]]:
        """What :meth:`save` writes, as named arrays that all begin with ``map/``: part of a larger archive."""
        return persistence.pack(persistence.MapState(self.resolution_m, self.agent_radius_m, self._tracker, self._trace))

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> MetricMap:
        """Inverse of :meth:`to_arrays`; other names among the arrays are ignored.

        Raises:
            UsageError: there is no map among them, or it is damaged or of another version.
        """
        state = persistence.unpack(arrays)
        world_map = cls(state.resolution_m, state.agent_radius_m)
        world_map._tracker, world_map._trace, world_map._decided = state.tracker, state.trace, len(state.trace)
        world_map._writer.resume(state.tracker.last, state.tracker.current)
        return world_map

    # -- floors ------------------------------------------------------------------------------------------------------------

    @property
    def floor(self) -> int:
        """Id of the current floor: 0 at the start, upper floors count up, lower ones down."""
        return self._floor.id

    @property
    def floors(self) -> tuple[int, ...]:
        """Ids of the known floors, ascending."""
        return tuple(sorted(self._tracker.floors))

    @property
    def connectors(self) -> tuple[StairConnector, ...]:
        """Stairs that were walked, in order."""
        return tuple(self._tracker.connectors)

    @property
    def nbytes(self) -> int:
        """Bytes of all tiles and traces: grows with the explored area only."""
        return sum(floor.nbytes for floor in self._tracker.floors.values()) + self._trace.nbytes

    @property
    def version(self) -> int:
        """Grows whenever a cell of the current floor changes."""
        return self._floor.version

    @property
    def travelled(self) -> Float:
        """Episode trajectory, (N, 3): x, y [m], floor. Places, so a turn adds none."""
        return self._trace.episode.copy()

    @property
    def travelled_stage(self) -> Float:
        """Trajectory of the current stage, (N, 3) as :attr:`travelled`."""
        return self._trace.stage.copy()

    @property
    def _floor(self) -> Floor:
        return self._tracker.current or self._nowhere

    def on_floor(self, floor: int) -> FloorView:
        """The same questions about any known floor.

        Raises:
            UsageError: the floor is not known.
        """
        return self._view(self._known(floor))

    def _known(self, floor: int) -> Floor:
        if floor not in self._tracker.floors:
            raise UsageError(f"Floor {floor} is not on the map: known are {list(self.floors)}.")
        return self._tracker.floors[floor]

    def _view(self, floor: Floor) -> FloorView:
        view = self._views.get(floor.id)
        if view is None:
            view = self._views[floor.id] = FloorView(floor, self.resolution_m)
        return view

    @property
    def _here(self) -> FloorView:
        return self._view(self._tracker.current) if self._tracker.current else FloorView(self._nowhere, self.resolution_m)

    # -- the current floor (see FloorView) ---------------------------------------------------------------------------------

    def is_explored(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points was seen, shape (N,)."""
        return self._here.is_explored(xy_m)

    def is_free(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points is known free floor, shape (N,)."""
        return self._here.is_free(xy_m)

    def is_obstacle(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points is a known obstacle (0.15 to 1.30 m over the floor), shape (N,)."""
        return self._here.is_obstacle(xy_m)

    def line_of_sight(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> bool:
        """Whether every cell on the straight line between two points is known free floor; never over more than 40 m."""
        return self._here.line_of_sight(a_xy_m, b_xy_m)

    def geodesic_field(self, xy_m: ArrayLike) -> GeodesicField:
        """Distances from a point to all known free space, inflated by the agent's radius; kept until the map changes.

        A start that is not free is moved to the nearest free cell within 0.3 m. A field looks 40 m around its start.
        """
        return self._here.geodesic_field(xy_m)

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        """Shortest way on known free space inflated by the agent's radius [m]; inf when unknown or cut off."""
        return self._here.geodesic_m(a_xy_m, b_xy_m)

    def path(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> Float:
        """That way, pulled straight, (N, 2) points with both ends; (0, 2) when there is none."""
        return self._here.path(a_xy_m, b_xy_m)

    def frontiers(self, pose: Pose) -> tuple[Frontier, ...]:
        """Reachable borders of the known free space at least 0.3 m wide, nearest on the way first."""
        return self._here.frontiers(pose)

    def cross_floor_m(self, a_xy_m: ArrayLike, a_floor: int, b_xy_m: ArrayLike, b_floor: int) -> float:
        """Shortest known way between points of two floors over stairs that were walked [m]; inf when there is none."""
        return across_floors_m(
            self._tracker, lambda floor, xy_m: self._view(floor).geodesic_field(xy_m), (a_xy_m, a_floor), (b_xy_m, b_floor)
        )

    # -- obstacle distances ------------------------------------------------------------------------------------------------

    def obstacle_distances(self, observation: Observation, incline: Incline | None = None) -> ObstacleDistances:
        """Omega_t: distance from the agent's centre to the nearest obstacle ahead and 30 degrees to either side [m].

        See :meth:`sector_distance_m`. The body touches it when it has moved the distance less ``agent_radius_m``.
        """
        bearings = (0.0, math.pi / 6, -math.pi / 6)
        ahead, left, right = sectors.body_distances_m(
            self._floor, observation, bearings, self.agent_radius_m, self.resolution_m, incline
        )
        return ObstacleDistances(front_m=ahead, left_30_m=left, right_30_m=right)

    def sector_distance_m(self, observation: Observation, bearing_rad: float = 0.0, incline: Incline | None = None) -> float:
        """Distance from the agent's centre to what its body would touch first in a direction [m], at most 5 m.

        The smaller of what the map (up to 2 m) and this depth image say: the front edge of a low thing leaves the image before
        the body reaches it, and an average would move it away. When at least 18 % (and 6) of the sector's depth samples are at
        the camera's lower limit, it is 0.49 m. Treads of stairs that lead on from the local floor are no obstacles.

        Args:
            observation: image and pose of the moment; need not be integrated.
            bearing_rad: direction, egocentric, left positive.
            incline: the flight of stairs that is being taken; what lies on it is no obstacle either.
        """
        (distance_m,) = sectors.body_distances_m(
            self._floor, observation, (bearing_rad,), self.agent_radius_m, self.resolution_m, incline
        )
        return distance_m

    # -- pictures ----------------------------------------------------------------------------------------------------------

    def crop(
        self, center_xy: ArrayLike, size_m: float = 24.0, heading_rad: float | None = None, floor: int | None = None
    ) -> MapCrop:
        """A square of the map as boolean images; heading-up when a heading is given, else x to the right and y up.

        Args:
            center_xy: point in the middle.
            size_m: side length.
            heading_rad: direction of the upper edge.
            floor: another floor than the current one.

        Raises:
            UsageError: the size is not positive, or the floor is not known.
        """
        if not 0 < size_m <= 400:
            raise UsageError(f"crop size_m={size_m} is outside (0, 400]: give the side of the square in metres.")
        x, y = points_xy(center_xy)[0].tolist()
        shown = self._floor if floor is None else self._known(floor)
        return crop_floor(shown, self._trace, (x, y), size_m, heading_rad, self.resolution_m)
