"""Ways in a building of GN-Bench, measured on its occupancy map as its authors do, and the reference follower that walks them.

A way is GN-Bench's: the shortest over pixels that keep 7 pixels from obstacles (then 6, 5, 4 where there is none), straightened
where the line keeps 7, and measured pixel by pixel. Ends that are too near to an obstacle are moved to a walkable pixel first.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from spacevln.core.actions import Action, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.geometry import Float, Pose
from spacevln.environments.gn_bench.occupancy import MARGINS_PX, Occupancy
from spacevln.environments.gn_bench.search import Pixels, field, line, reach, shortest, smoothed

ARRIVAL_M = 0.25
"""The follower stops strictly below this distance."""

Pixel = tuple[int, int]


class OccupancyGeodesics:
    """Answers for one building; what was measured once is kept. Points are in the scene frame.

    Args:
        occupancy: of the building.
        step_m, turn_deg: primitives of the follower.
    """

    def __init__(self, occupancy: Occupancy, *, step_m: float, turn_deg: float) -> None:
        self._map = occupancy
        self._step_m, self._turn_deg = step_m, turn_deg
        self._known: dict[tuple[Pixel, Pixel], tuple[float, Pixels]] = {}
        self._field: tuple[tuple[Pixel, ...], Float] | None = None

    def distances_m(self, positions: Float, targets: Float) -> Float:
        """Length of the way from each position (N, 3) to its nearest target (G, 3); inf when there is no way."""
        ends = self._ends(targets)
        return np.array([min(self._way(start, end)[0] for end in ends) for start in self._ends(positions)])

    def path(self, start: Float, targets: Float) -> Float:
        """Bends (M, 3) of the way to the nearest target; (1, 3) when there is none."""
        (begin,) = self._ends(start[None])
        length_m, bends = min((self._way(begin, end) for end in self._ends(targets)), key=lambda way: way[0])
        return self._map.points_of(bends) if math.isfinite(length_m) else np.asarray(start, np.float64).reshape(1, 3)

    def follow(self, pose: Pose, targets: Float) -> Action:
        """Turn to where one step leads nearest to a target, and go; STOP where it is near or nothing leads nearer."""
        to_go = self._to_go(targets)
        ((x, y),) = self._ends(pose.position_m[None])
        here_m = float(to_go[y, x])
        if here_m < ARRIVAL_M or not math.isfinite(here_m):
            return Stop()
        count = round(360 / self._turn_deg)
        yaws = pose.yaw_rad + np.radians(self._turn_deg) * np.arange(count)
        ahead = pose.position_m[:2] + self._step_m * np.column_stack([np.cos(yaws), np.sin(yaws)])
        reached = [reach(self._map.walkable, (x, y), (int(u), int(v))) for u, v in self._map.pixels_of(ahead)]
        after = [round(float(to_go[v, u]), 4) for u, v in reached]
        best = min(range(count), key=lambda k: (after[k], min(k, count - k), k))
        if after[best] >= here_m:
            return Stop()
        if best == 0:
            return MoveForward(self._step_m)
        return TurnLeft(self._turn_deg) if best <= count / 2 else TurnRight(self._turn_deg)

    def _to_go(self, targets: Float) -> Float:
        """Metres from every walkable pixel to the nearest target, (H, W); kept for the last targets."""
        goals = tuple(self._ends(targets))
        if self._field is None or self._field[0] != goals:
            self._field = goals, field(self._map.walkable, np.array(goals)) * float(self._map.pixel_m.mean())
        return self._field[1]

    def _ends(self, points: Float) -> list[Pixel]:
        """Where the ways from and to some points (N, 3) begin and end."""
        return [self._map.walkable_near((int(x), int(y))) for x, y in self._map.pixels_of(np.asarray(points, np.float64))]

    def _way(self, start: Pixel, end: Pixel) -> tuple[float, Pixels]:
        """Length [m] and bends (M, 2) of a way."""
        if (start, end) not in self._known:
            self._known[start, end] = self._measured(start, end)
        return self._known[start, end]

    def _measured(self, start: Pixel, end: Pixel) -> tuple[float, Pixels]:
        if start == end:
            return 0.0, np.array([start, end])
        for margin in MARGINS_PX:
            way = shortest(self._map.free[margin], start, end)
            if len(way):
                bends = smoothed(self._map.free[MARGINS_PX[0]], way)
                steps = [np.diff(line(_pixel(a), _pixel(b)), axis=0) for a, b in itertools.pairwise(bends)]
                return float(np.linalg.norm(np.concatenate(steps) * self._map.pixel_m, axis=1).sum()), bends
        return math.inf, np.zeros((0, 2), np.int64)


def _pixel(pixel: Pixels) -> Pixel:
    return int(pixel[0]), int(pixel[1])
