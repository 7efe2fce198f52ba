"""The tiled metric RGB-D map (paper, "Tiled metric RGB-D world map"; DESIGN 5.2)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core import Frontier, Observation, ObstacleDistances, Pose, Sighting, UsageError
from spacevln.mapping import persistence, sectors, wavefront
from spacevln.mapping.cells import FREE_EVIDENCE, free_of
from spacevln.mapping.crops import MapCrop, crop_floor
from spacevln.mapping.floors import Floor, FloorTracker, StairConnector
from spacevln.mapping.frontiers import find_frontiers
from spacevln.mapping.geodesics import FreeGrid, GeodesicField
from spacevln.mapping.integration import ON_STAIRS_M, FrameWriter, camera_view
from spacevln.mapping.stairways import across_floors_m
from spacevln.mapping.tiles import TiledLayer
from spacevln.mapping.traces import Trace

Float = NDArray[np.float64]
Mask = NDArray[np.bool_]

_FIELD_REACH_M = 40.0  # geodesics look at most this far around their start
_FIELDS_KEPT = 32


class MetricMap:
    """A metric map of any posed RGB-D stream: what is explored, free and an obstacle, and the ways on it.

    Input contract: each :class:`Observation` has depth in metres along the optical axis of a rectified pinhole camera, the pose
    of the agent's feet, and ``T_world_camera``, all in one fixed frame with z up. Depth outside 0.5 to 5.0 m, zero, negative,
    NaN and infinite depth is no measurement. Every query is about the current floor; all points are metres in that frame.

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
        self._tracker = FloorTracker()
        self._writer = FrameWriter(resolution_m, agent_radius_m)
        self._trace = Trace()
        self._pending: list[Observation] = []
        self._grids: dict[int, tuple[int, tuple[int, int, int, int], FreeGrid, NDArray[np.uint8]]] = {}
        self._fields: dict[tuple[int, int, float, float], GeodesicField] = {}
        self._nowhere = Floor(0, 0.0)

    # -- integrating -------------------------------------------------------------------------------------------------------

    def integrate(self, observation: Observation, sightings: Sequence[Sighting] = ()) -> None:
        """Add one posed RGB-D image, and where landmarks were sighted in it.

        Args:
            observation: see the class; its constructor checks shapes and types.
            sightings: lifted detections of the active landmark terms.

        Raises:
            UsageError: the pose is not finite.
        """
        pose = observation.pose
        if (
            not np.isfinite([pose.x_m, pose.y_m, pose.z_m, pose.yaw_rad]).all()
            or not np.isfinite(observation.T_world_camera).all()
        ):
            raise UsageError(f"Observation.pose {pose} or T_world_camera is not finite: give a pose in metres and radians.")
        self._writer.project(observation)
        before = self._tracker.current
        floor = self._tracker.update(pose, self._writer.flat_cells)
        self._trace.append(pose.x_m, pose.y_m, floor.id)
        if floor is not before and before is not None:
            # The frames that showed the new floor to be one were not written yet.
            for earlier in self._pending:
                self._writer.project(earlier)
                self._writer.settle(earlier, floor)
            self._pending.clear()
            self._writer.project(observation)
        if self._tracker.stable_steps:
            self._pending.append(observation)
            self._writer.settle_body(pose, floor)
            return
        self._pending.clear()
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
        self._trace = Trace()
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
        world_map._tracker, world_map._trace = state.tracker, state.trace
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

    # -- points ------------------------------------------------------------------------------------------------------------

    def is_explored(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points was seen, shape (N,)."""
        return np.asarray(self._values(self._floor.seen, xy_m) != 0)

    def is_free(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points is known free floor, shape (N,)."""
        return np.asarray(free_of(self._values(self._floor.seen, xy_m), self._values(self._floor.solid, xy_m)))

    def is_obstacle(self, xy_m: ArrayLike) -> Mask:
        """Whether each of the (N, 2) points is a known obstacle (0.15 to 1.30 m over the floor), shape (N,)."""
        return np.asarray(self._values(self._floor.solid, xy_m) != 0)

    def _values(self, layer: TiledLayer, xy_m: ArrayLike) -> NDArray[np.uint8]:
        return layer.at(np.floor(points_xy(xy_m) / self.resolution_m).astype(np.int64))

    def line_of_sight(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> bool:
        """Whether every cell on the straight line between two points is known free floor."""
        ends = np.concatenate([points_xy(a_xy_m), points_xy(b_xy_m)]) / self.resolution_m
        i0, j0 = (math.floor(value) for value in ends.min(axis=0))
        i1, j1 = (math.floor(value) + 1 for value in ends.max(axis=0))
        if max(i1 - i0, j1 - j0) * self.resolution_m > _FIELD_REACH_M:
            return False
        seen, solid = self._floor.seen.window(i0, j0, i1 - i0, j1 - j0), self._floor.solid.window(i0, j0, i1 - i0, j1 - j0)
        (a_i, a_j), (b_i, b_j) = ends - (i0, j0)
        return bool(wavefront.clear_line(free_of(seen, solid).astype(np.uint8), a_i, a_j, b_i, b_j))

    # -- ways --------------------------------------------------------------------------------------------------------------

    def geodesic_field(self, xy_m: ArrayLike) -> GeodesicField:
        """Distances from a point to all known free space, inflated by the agent's radius; kept until the map changes.

        A start that is not free is moved to the nearest free cell within 0.3 m. A field looks 40 m around its start.
        """
        return self._field(self._floor, xy_m)

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        """Shortest way on known free space inflated by the agent's radius [m]; inf when unknown or cut off."""
        return float(self.geodesic_field(a_xy_m).at(b_xy_m)[0])

    def path(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> Float:
        """That way, pulled straight, (N, 2) points with both ends; (0, 2) when there is none."""
        return self.geodesic_field(a_xy_m).path_to(b_xy_m)

    def cross_floor_m(self, a_xy_m: ArrayLike, a_floor: int, b_xy_m: ArrayLike, b_floor: int) -> float:
        """Shortest known way between points of two floors over stairs that were walked [m]; inf when there is none."""
        return across_floors_m(self._tracker, self._field, (a_xy_m, a_floor), (b_xy_m, b_floor))

    def _field(self, floor: Floor, xy_m: ArrayLike) -> GeodesicField:
        x, y = points_xy(xy_m)[0].tolist()
        key = (floor.id, floor.version, x, y)
        field = self._fields.get(key)
        if field is None:
            grid, _ = self._grid(floor, x, y)
            field = grid.field((x, y))
            while len(self._fields) >= _FIELDS_KEPT:
                del self._fields[next(iter(self._fields))]
            self._fields[key] = field
        return field

    def _grid(self, floor: Floor, x: float, y: float) -> tuple[FreeGrid, NDArray[np.uint8]]:
        """Free space of the floor, at most 40 m around a point, and the flags of the same window."""
        bounds = self._field_bounds(floor, x, y)
        kept = self._grids.get(floor.id)
        if kept is None or kept[:2] != (floor.version, bounds):
            i0, j0, i1, j1 = bounds
            seen = floor.seen.window(i0, j0, i1 - i0, j1 - j0)
            solid = floor.solid.window(i0, j0, i1 - i0, j1 - j0)
            grid = wavefront.passable(seen, solid, FREE_EVIDENCE, self.agent_radius_m / self.resolution_m)
            kept = self._grids[floor.id] = (floor.version, bounds, FreeGrid(i0, j0, self.resolution_m, grid), seen)
        return kept[2], kept[3]

    def _field_bounds(self, floor: Floor, x: float, y: float) -> tuple[int, int, int, int]:
        i, j = math.floor(x / self.resolution_m), math.floor(y / self.resolution_m)
        reach = round(_FIELD_REACH_M / self.resolution_m)
        i0, j0, i1, j1 = floor.bounds or (i, j, i, j)
        if i1 - i0 > reach or j1 - j0 > reach:
            i0, j0, i1, j1 = max(i0, i - reach), max(j0, j - reach), min(i1, i + reach), min(j1, j + reach)
        i0, j0 = i0 - 2, j0 - 2
        return i0, j0, max(i1 + 2, i0 + 4), max(j1 + 2, j0 + 4)

    def frontiers(self, pose: Pose) -> tuple[Frontier, ...]:
        """Reachable borders of the known free space at least 0.3 m wide, nearest on the way first."""
        field = self.geodesic_field(pose.xy_m)
        return find_frontiers(field, self._grid(self._floor, pose.x_m, pose.y_m)[1], pose)

    # -- obstacle distances ------------------------------------------------------------------------------------------------

    def obstacle_distances(self, observation: Observation) -> ObstacleDistances:
        """Omega_t: distance from the agent's centre to the nearest obstacle ahead and 30 degrees to either side [m].

        See :meth:`sector_distance_m`. The body touches it when it has moved the distance less ``agent_radius_m``.
        """
        ahead, left, right = (self.sector_distance_m(observation, bearing) for bearing in (0.0, math.pi / 6, -math.pi / 6))
        return ObstacleDistances(front_m=ahead, left_30_m=left, right_30_m=right)

    def sector_distance_m(self, observation: Observation, bearing_rad: float = 0.0) -> float:
        """Distance from the agent's centre to what its body would touch first in a direction [m], at most 5 m.

        The smaller of what the map (up to 2 m) and this depth image say: the front edge of a low thing leaves the image before
        the body reaches it, and an average would move it away. When at least 18 % (and 6) of the sector's depth samples are at
        the camera's lower limit, it is 0.49 m. Treads of stairs that lead on from the local floor are no obstacles.

        Args:
            observation: image and pose of the moment; need not be integrated.
            bearing_rad: direction, egocentric, left positive.
        """
        pose, floor, resolution_m = observation.pose, self._floor, self.resolution_m
        angle = pose.yaw_rad + bearing_rad
        direction = math.cos(angle), math.sin(angle)
        view = camera_view(observation, pose.x_m, pose.y_m)
        depth_m = np.ascontiguousarray(observation.depth_m, np.float32)
        seen_m = sectors.depth_distance_m(depth_m, view, direction, self.agent_radius_m, self._treads(pose))
        if abs(pose.z_m - floor.z_m) > ON_STAIRS_M:
            return float(min(sectors.DEPTH_REACH_M, seen_m))  # what stands on the floor left behind is over or under the agent
        reach = math.ceil(sectors.MAP_REACH_M / resolution_m) + 1
        i0, j0 = math.floor(pose.x_m / resolution_m) - reach, math.floor(pose.y_m / resolution_m) - reach
        map_m = resolution_m * sectors.map_distance_cells(
            floor.solid.window(i0, j0, 2 * reach, 2 * reach),
            pose.x_m / resolution_m - i0,
            pose.y_m / resolution_m - j0,
            *direction,
            self.agent_radius_m / resolution_m,
            self.agent_radius_m / resolution_m,
            sectors.MAP_REACH_M / resolution_m,
        )
        return float(min(sectors.DEPTH_REACH_M, map_m, seen_m))

    def _treads(self, pose: Pose) -> tuple[NDArray[np.uint8], NDArray[np.int8], int, float]:
        """Windows of flags and tread heights around the agent; empty while the floor knows no stairs."""
        floor = self._floor
        if not floor.ground.tiles:
            return np.zeros((0, 0), np.uint8), np.zeros((0, 0), np.int8), 0, self.resolution_m
        reach = math.ceil(sectors.DEPTH_REACH_M / self.resolution_m)
        i0, j0 = math.floor(pose.x_m / self.resolution_m) - reach, math.floor(pose.y_m / self.resolution_m) - reach
        feet_bins = round((pose.z_m - floor.z_m) / 0.05)
        return (
            floor.seen.window(i0, j0, 2 * reach, 2 * reach),
            floor.ground.window(i0, j0, 2 * reach, 2 * reach),
            feet_bins,
            self.resolution_m,
        )

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
        if floor is not None and floor not in self._tracker.floors:
            raise UsageError(f"Floor {floor} is not on the map: known are {list(self.floors)}.")
        x, y = points_xy(center_xy)[0].tolist()
        shown = self._floor if floor is None else self._tracker.floors[floor]
        return crop_floor(shown, self._trace, (x, y), size_m, heading_rad, self.resolution_m)


def points_xy(xy_m: ArrayLike) -> Float:
    """Points as (N, 2) float64.

    Raises:
        UsageError: the shape is another, or a value is not finite.
    """
    points = np.asarray(xy_m, np.float64)
    if points.ndim == 1 and points.shape == (2,):
        points = points[None]
    if points.ndim != 2 or points.shape[1] != 2:
        raise UsageError(f"Points of shape {points.shape} are not (N, 2): give x and y in metres per row.")
    if not np.isfinite(points).all():
        raise UsageError("A point is not finite: give x and y in metres.")
    return points
