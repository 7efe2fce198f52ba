"""The shortest-path follower: the oracle that every route must be walkable for."""

from __future__ import annotations

import math
from collections.abc import Callable

from spacevln.core.actions import Action, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.geometry import Pose
from spacevln.environments.houses.walking.geodesics import Field
from spacevln.environments.houses.walking.motion import Body

STOP_M = 0.25
_PROGRESS_M = 0.005


class ShortestPathFollower:
    """Chooses the primitive that leads down a field of geodesic distances; knows the ground truth, for checks only.

    Of the headings that turns can reach it takes the one whose next step really ends nearest to the goal, collisions and
    sliding included; of equal ones the one with the fewest turns.

    Args:
        body: that will carry the actions out.
        field: distances from the goal.
        step_m, turn_deg: the primitives.
        arrived: says of a pose whether STOP is due there; by default within 0.25 m of the goal.
    """

    def __init__(
        self,
        body: Body,
        field: Field,
        *,
        step_m: float = 0.25,
        turn_deg: float = 30.0,
        arrived: Callable[[Pose], bool] | None = None,
    ) -> None:
        self._body = body
        self._field = field
        self._step_m = step_m
        self._turn_deg = turn_deg
        self._arrived = arrived or (lambda pose: field.at(pose.x_m, pose.y_m, pose.z_m) <= STOP_M)

    def action(self, pose: Pose) -> Action:
        """The next primitive from a pose (scene frame); Stop at the goal, or where no step leads nearer to it."""
        if self._arrived(pose):
            return Stop()
        here = self._field.at(pose.x_m, pose.y_m, pose.z_m)
        half = round(180.0 / self._turn_deg)
        turns = sorted(range(-half + 1, half + 1), key=abs)
        after = [self._after(pose.turned(math.radians(self._turn_deg * turn))) for turn in turns]
        best = min(range(len(turns)), key=lambda k: round(after[k], 6))
        if after[best] > here - _PROGRESS_M:
            return Stop()
        if turns[best] == 0:
            return MoveForward(self._step_m)
        return TurnLeft(self._turn_deg) if turns[best] > 0 else TurnRight(self._turn_deg)

    def _after(self, pose: Pose) -> float:
        reached, _ = self._body.forward(pose, self._step_m)
        left = self._field.at(reached.x_m, reached.y_m, reached.z_m)
        return -1.0 if left < self._step_m and self._arrived(reached) else left
