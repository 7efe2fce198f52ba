"""Floors: each has its own tiles; a new one is opened from the pose's height and joined by a stair connector (DESIGN 5.2)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from spacevln.core import Pose
from spacevln.mapping.reachability import Reachability
from spacevln.mapping.tiles import TiledLayer

SAME_FLOOR_M = 1.0
OTHER_FLOOR_M = 1.5
STABLE_STEPS = 3
LEVEL_M = 0.1  # within this height of a floor one stands on it, not on its stairs
ON_STAIRS_M = 0.25  # farther from it, one is on its stairs: only what is near is written
_STABLE_RISE_M = 0.05
_STABLE_MOVE_M = 0.1
_FLAT_CELLS = 200  # this much floor seen at the height of the feet: not a tread


@dataclass(slots=True, eq=False)
class Floor:
    """One storey of the map.

    Args:
        id: 0 for the floor of the start; upper floors count up, lower ones down.
        z_m: height of its surface in the episode frame.
        reachable: where the body may be, derived from ``seen`` and ``solid``.
        seen, solid, ground: see ``mapping.cells``.
        semantic: per landmark term, the cells where it was sighted.
        bounds: first and last explored cell (i0, j0, i1, j1), ends exclusive; None while nothing is explored.
        version: grows when a cell changes.
    """

    id: int
    z_m: float
    reachable: Reachability
    seen: TiledLayer = field(default_factory=TiledLayer)
    solid: TiledLayer = field(default_factory=TiledLayer)
    ground: TiledLayer = field(default_factory=lambda: TiledLayer(np.int8))
    semantic: dict[str, TiledLayer] = field(default_factory=dict)
    bounds: tuple[int, int, int, int] | None = None
    version: int = 0

    @property
    def nbytes(self) -> int:
        """Bytes of all layers."""
        layers = self.seen, self.solid, self.ground, *self.semantic.values()
        return sum(layer.nbytes for layer in layers) + self.reachable.nbytes

    def changed(self, i0: int, j0: int, i1: int, j1: int) -> None:
        """Cells of a window have changed."""
        self.version += 1
        self.reachable.touch(i0, j0, i1, j1)
        if self.bounds is not None:
            a, b, c, d = self.bounds
            i0, j0, i1, j1 = min(i0, a), min(j0, b), max(i1, c), max(j1, d)
        self.bounds = (i0, j0, i1, j1)


@dataclass(frozen=True, slots=True)
class StairConnector:
    """A way between two floors that the agent walked.

    Args:
        from_floor, to_floor: floor ids in the order of walking.
        start: last pose on ``from_floor``.
        end: first pose on ``to_floor``.
        length_m: way walked between the two, horizontal and vertical.
    """

    from_floor: int
    to_floor: int
    start: Pose
    end: Pose
    length_m: float


class FloorTracker:
    """Decides from the poses which floor the agent is on.

    Within 1.0 m of a known floor's height it is that floor. More than 1.5 m away from the current one for 3 steps at a stable
    height (the agent moved, or sees floor at the height of its feet) it is another.

    Args:
        radius_cells: of the body, in cells.
    """

    def __init__(self, radius_cells: float) -> None:
        self._radius_cells = radius_cells
        self.floors: dict[int, Floor] = {}
        self.connectors: list[StairConnector] = []
        self.current: Floor | None = None
        self.stable_steps = 0
        self.last: Pose | None = None
        self.left_at: Pose | None = None
        self.climbed_m = 0.0

    def update(self, pose: Pose, flat_cells: int) -> Floor:
        """The floor of this pose; opens one when needed.

        Args:
            pose: live pose.
            flat_cells: number of cells in which floor at the height of the feet is seen now.
        """
        current = self.current or self._arrive(pose)
        last, self.last = self.last or pose, pose
        moved_m = last.distance_m(pose.x_m, pose.y_m)
        rise_m = pose.z_m - current.z_m
        if abs(rise_m) <= LEVEL_M:
            self.left_at, self.climbed_m = pose, 0.0
        else:
            self.climbed_m += math.hypot(moved_m, pose.z_m - last.z_m)
        stable = abs(pose.z_m - last.z_m) <= _STABLE_RISE_M and (moved_m >= _STABLE_MOVE_M or flat_cells >= _FLAT_CELLS)
        self.stable_steps = self.stable_steps + 1 if abs(rise_m) > OTHER_FLOOR_M and stable else 0
        if self.stable_steps >= STABLE_STEPS:
            current = self._switch(current, pose, 1 if rise_m > 0 else -1)
        return current

    def open(self, floor_id: int, z_m: float) -> Floor:
        """A new floor."""
        floor = self.floors[floor_id] = Floor(floor_id, z_m, Reachability(self._radius_cells))
        return floor

    def start_episode(self) -> None:
        """The next pose begins a new way, anywhere on the known floors or beside them."""
        self.current = self.last = self.left_at = None
        self.stable_steps, self.climbed_m = 0, 0.0

    def _arrive(self, pose: Pose) -> Floor:
        """The floor on which a way begins."""
        known = sorted(self.floors)
        floor = self._near(pose)
        if floor is None:
            upward = bool(known) and pose.z_m > self.floors[known[-1]].z_m
            floor_id = 0 if not known else known[-1] + 1 if upward else known[0] - 1
            floor = self.open(floor_id, pose.z_m)
        self.current = floor
        return floor

    def _near(self, pose: Pose) -> Floor | None:
        near = [floor for floor in self.floors.values() if abs(floor.z_m - pose.z_m) <= SAME_FLOOR_M]
        return min(near, key=lambda floor: abs(floor.z_m - pose.z_m)) if near else None

    def _switch(self, left: Floor, pose: Pose, direction: int) -> Floor:
        floor = self._near(pose)
        if floor is None:
            floor_id = left.id + direction
            while floor_id in self.floors:
                floor_id += direction
            floor = self.open(floor_id, pose.z_m)
        start = self.left_at or pose
        self.connectors.append(StairConnector(left.id, floor.id, start, pose, self.climbed_m))
        self.current, self.stable_steps = floor, 0
        self.left_at, self.climbed_m = pose, 0.0
        return floor
