"""Ways and distances by Habitat-Sim's navigation mesh, and the reference follower that walks them; points in the scene frame."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from spacevln_bridge import messages as say

from spacevln.core.actions import Action, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.geometry import Float, Pose
from spacevln.environments.bridge.frame import points_from_habitat, points_to_habitat
from spacevln.environments.bridge.simulator import BridgedSimulator

ARRIVAL_M = 0.25
"""The follower stops strictly below this distance, as VLN-CE's ground-truth follower and OVON's view points want it."""
_LEAST_GAIN_M = 1e-3
_KEPT = 200_000


class SceneGeodesics:
    """Answers for one scene; what was measured once is kept.

    Args:
        simulator: may have another scene open in the meantime.
        scene: name, relative to the folder of scenes.
    """

    def __init__(self, simulator: BridgedSimulator, scene: str) -> None:
        self._simulator = simulator
        self._scene = scene
        self._known: dict[tuple[bytes, bytes], float] = {}

    def distances_m(self, positions: Float, targets: Float) -> Float:
        """Geodesic distance of each position (N, 3) to its nearest target (G, 3); inf when there is no way.

        Raises:
            EnvironmentFailure: the simulator failed.
        """
        wanted, goal = points_to_habitat(positions).astype(np.float32), say.pack(points_to_habitat(targets))
        keys = [(position.tobytes(), goal) for position in wanted]
        missing = list(dict.fromkeys(key for key in keys if key not in self._known))
        if missing:
            self._simulator.open(self._scene)
            points = np.array([np.frombuffer(key[0], np.float32) for key in missing])
            values = self._simulator.ask(say.Distances(say.pack(points), goal), say.Numbers).values
            if len(self._known) > _KEPT:
                self._known.clear()
            self._known.update(zip(missing, values, strict=True))
            found = dict(zip(missing, values, strict=True))
            return np.array([found[key] if key in found else self._known[key] for key in keys])
        return np.array([self._known[key] for key in keys])

    def path(self, start: Float, targets: Float) -> Float:
        """Corner points (M, 3) of the shortest way to the nearest target; (1, 3) when there is none."""
        self._simulator.open(self._scene)
        begin = _vector(start)
        points = say.unpack(self._simulator.ask(say.Path(begin, say.pack(points_to_habitat(targets))), say.Points).points)
        return points_from_habitat(points) if len(points) else np.asarray(start, np.float64).reshape(1, 3)

    def follow(self, pose: Pose, targets: Float) -> Action:
        """Turn to where one step leads nearest to a target, and go; STOP where it is near or nothing leads nearer."""
        setup = self._simulator.setup
        here = float(self.distances_m(pose.position_m[None], targets)[0])
        if here < ARRIVAL_M or not math.isfinite(here):
            return Stop()
        count = round(360 / setup.turn_deg)
        yaws = pose.yaw_rad + np.radians(setup.turn_deg) * np.arange(count)
        ahead = setup.step_m * np.column_stack([np.cos(yaws), np.sin(yaws), np.zeros(count)])
        request = say.Moves(
            _vector(pose.position_m),
            say.pack(points_to_habitat(pose.position_m + ahead)),
            say.pack(points_to_habitat(targets)),
        )
        self._simulator.open(self._scene)
        after = np.round(np.array(self._simulator.ask(request, say.Numbers).values), 4)
        turns = np.minimum(np.arange(count), count - np.arange(count))
        best = min(range(count), key=lambda k: (after[k], turns[k], k))
        if after[best] > here - _LEAST_GAIN_M:
            return Stop()
        if best == 0:
            return MoveForward(setup.step_m)
        return TurnLeft(setup.turn_deg) if best <= count / 2 else TurnRight(setup.turn_deg)


def _vector(point: Float) -> tuple[float, float, float]:
    return cast("tuple[float, float, float]", tuple(points_to_habitat(point)[0].tolist()))
