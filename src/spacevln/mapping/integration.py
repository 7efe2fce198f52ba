"""Writing one observation into the tiles of a floor."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Observation, Pose, Sighting
from spacevln.mapping import projection, settling
from spacevln.mapping.cells import DEPTH_TO_M, HEIGHT_BIN_M
from spacevln.mapping.floors import LEVEL_M, ON_STAIRS_M, Floor
from spacevln.mapping.tiles import TiledLayer

_STAIRS_REACH_M = 1.0
_TREADS_REACH_M = 1.5  # the next storey's floor is seen beyond the last tread
_LANDING_REACH_M = 4.0
_BLIND_M = 1.2
_SAME_STRIDE_M = 0.6  # a longer way between two frames is not walked over in a straight line


class FrameWriter:
    """Projects an observation once, then settles it into a floor. Scratch memory is kept between frames."""

    def __init__(self, resolution_m: float, agent_radius_m: float) -> None:
        self.resolution_m = resolution_m
        self.agent_radius_m = agent_radius_m
        self._scratch: dict[str, NDArray[np.uint8]] = {}
        self._origin = (0, 0)
        self._heights = np.zeros((0, 0), np.uint32)
        self._view = np.zeros(16)
        self._depth_m = np.zeros((0, 0), np.float32)
        self._last: tuple[Pose, Floor] | None = None

    def resume(self, pose: Pose | None, floor: Floor | None) -> None:
        """The body was here when it was last written; None when nothing leads to its next place."""
        self._last = None if pose is None or floor is None else (pose, floor)

    def _window(self, name: str, rows: int, columns: int, itemsize: int = 1) -> NDArray[np.uint8]:
        """A contiguous piece of kept memory, as bytes."""
        need = rows * columns * itemsize
        buffer = self._scratch.get(name)
        if buffer is None or buffer.size < need:
            buffer = self._scratch[name] = np.zeros(need, np.uint8)
        return buffer[:need]

    def project(self, observation: Observation) -> None:
        """Collect the heights that the depth image shows, over the cells that the camera can see."""
        i0, j0, rows, columns = self._frustum(observation)
        self._origin = (i0, j0)
        self._depth_m = np.ascontiguousarray(observation.depth_m, np.float32)
        self._view = projection.camera_view(observation, i0 * self.resolution_m, j0 * self.resolution_m)
        self._heights = self._window("heights", rows, columns, 4).view(np.uint32).reshape(rows, columns)
        self._heights.fill(0)
        projection.scatter_heights(self._depth_m, self._view, self.resolution_m, self._heights)
        camera = self._view[9] / self.resolution_m, self._view[10] / self.resolution_m, self._view[11]
        settling.fill_lying(self._heights, camera, observation.camera.fy_px, self.resolution_m)

    @property
    def flat_cells(self) -> int:
        """Cells of the projected frame that show floor at the height of the feet."""
        return int(settling.count_flat(self._heights))

    def settle(self, observation: Observation, floor: Floor) -> None:
        """Write the projected frame into a floor's tiles."""
        pose, resolution_m = observation.pose, self.resolution_m
        (i0, j0), shape = self._origin, self._heights.shape
        seen, solid, ground = self._read(floor, i0, j0, shape)
        before = seen.copy(), solid.copy()
        rise_m = pose.z_m - floor.z_m
        on_stairs, level = abs(rise_m) > ON_STAIRS_M, abs(rise_m) <= LEVEL_M
        feet_bins = 0 if level else round(rise_m / HEIGHT_BIN_M)
        self._stamp(pose, floor, (seen, solid, ground), feet_bins)
        if not on_stairs:
            projection.see_floor(self._depth_m, self._view, resolution_m, self._heights, seen)
        if level:
            settling.drop_treads_over_floor(seen, ground)
        camera_ij = self._view[9] / resolution_m, self._view[10] / resolution_m
        stairs_cells = (_TREADS_REACH_M if on_stairs else 4 * DEPTH_TO_M) / resolution_m
        found = settling.find_stairs(
            self._heights, seen, ground, feet_bins, not level, camera_ij, stairs_cells, _BLIND_M / resolution_m
        )
        if found or not level:
            floor.ground.write(i0, j0, ground)
        radius_cells = (_STAIRS_REACH_M if on_stairs else 4 * DEPTH_TO_M) / resolution_m
        settling.settle(self._heights, seen, solid, ground, feet_bins, camera_ij, radius_cells)
        if level:
            projection.clear_seen_through(self._depth_m, self._view, resolution_m, self._heights, seen, solid)
        self._store(floor, i0, j0, (seen, solid), before)
        self._last = pose, floor

    def leave(self, left: Floor, reached: Floor, pose: Pose) -> None:
        """Another floor was reached: its landing, seen from the last treads, belongs to it."""
        span = math.ceil(_LANDING_REACH_M / self.resolution_m)
        i0, j0 = math.floor(pose.x_m / self.resolution_m) - span, math.floor(pose.y_m / self.resolution_m) - span
        seen, solid, ground = self._read(left, i0, j0, (2 * span, 2 * span))
        before = seen.copy(), solid.copy()
        settling.drop_landing(seen, ground, round((reached.z_m - left.z_m) / HEIGHT_BIN_M))
        self._store(left, i0, j0, (seen, solid), before)

    def settle_sightings(self, sightings: Sequence[Sighting], floor: Floor) -> None:
        """Mark the cells around the points where landmarks were sighted."""
        for sighting in sightings:
            layer = floor.semantic.setdefault(sighting.category, TiledLayer())
            for x_m, y_m in (sighting.position_m[:2], *sighting.surface_m):
                i0, j0 = math.floor(x_m / self.resolution_m) - 1, math.floor(y_m / self.resolution_m) - 1
                layer.write(i0, j0, np.ones((3, 3), np.uint8))

    def _read(
        self, floor: Floor, i0: int, j0: int, shape: tuple[int, int]
    ) -> tuple[NDArray[np.uint8], NDArray[np.uint8], NDArray[np.int8]]:
        seen = self._window("seen", *shape).reshape(shape)
        solid = self._window("solid", *shape).reshape(shape)
        ground = self._window("ground", *shape).view(np.int8).reshape(shape)
        floor.seen.read(i0, j0, seen)
        floor.solid.read(i0, j0, solid)
        floor.ground.read(i0, j0, ground)
        return seen, solid, ground

    def _store(
        self,
        floor: Floor,
        i0: int,
        j0: int,
        after: tuple[NDArray[np.uint8], NDArray[np.uint8]],
        before: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    ) -> None:
        changed = np.flatnonzero(((after[0] != before[0]) | (after[1] != before[1])).any(axis=1))
        if not len(changed):
            return
        a, b = int(changed[0]), int(changed[-1]) + 1
        floor.seen.write(i0 + a, j0, after[0][a:b])
        floor.solid.write(i0 + a, j0, after[1][a:b])
        floor.changed(i0 + a, j0, i0 + b, j0 + after[0].shape[1])

    def _stamp(
        self, pose: Pose, floor: Floor, cells: tuple[NDArray[np.uint8], NDArray[np.uint8], NDArray[np.int8]], feet_bins: int
    ) -> None:
        """Free the body's footprint and its way since the last frame."""
        here = pose.x_m / self.resolution_m - self._origin[0], pose.y_m / self.resolution_m - self._origin[1]
        there = here
        if self._last is not None and self._last[1] is floor and self._last[0].distance_m(pose.x_m, pose.y_m) <= _SAME_STRIDE_M:
            there = (
                self._last[0].x_m / self.resolution_m - self._origin[0],
                self._last[0].y_m / self.resolution_m - self._origin[1],
            )
        settling.stamp_body(*cells, feet_bins, there, here, self.agent_radius_m / self.resolution_m)

    def _frustum(self, observation: Observation) -> tuple[int, int, int, int]:
        """Window (i0, j0, rows, columns) of the cells that the image can show, and of the body's way."""
        camera, T_world_camera = observation.camera, observation.T_world_camera
        across = [-(edge - camera.cx_px) / camera.fx_px for edge in (0, camera.width_px)]
        upward = [-(edge - camera.cy_px) / camera.fy_px for edge in (0, camera.height_px)]
        corners = np.array([(1.0, left, up) for left in across for up in upward]) * DEPTH_TO_M
        xy = (corners @ T_world_camera[:3, :3].T)[:, :2] + T_world_camera[:2, 3]
        pose = observation.pose
        margin_m = _SAME_STRIDE_M + self.agent_radius_m
        low = np.minimum(np.minimum(xy.min(axis=0), T_world_camera[:2, 3]), pose.xy_m - margin_m) / self.resolution_m
        high = np.maximum(np.maximum(xy.max(axis=0), T_world_camera[:2, 3]), pose.xy_m + margin_m) / self.resolution_m
        i0, j0 = math.floor(low[0]) - 2, math.floor(low[1]) - 2
        return i0, j0, math.floor(high[0]) + 3 - i0, math.floor(high[1]) + 3 - j0
