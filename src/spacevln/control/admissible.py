"""U_t: the actions that an executor may choose now, from realised motion and obstacle distances.

Paper appendix "Action-space constraints"; DESIGN 5.6.
"""

from __future__ import annotations

import math

from spacevln.control.settings import ControlSettings
from spacevln.control.turns import Side, TurnMonitor
from spacevln.core import AdmissibleActions, EnvironmentSpec, ExecutedDecision, MoveForward, ObstacleDistances


def forward_choices(front_m: float, spec: EnvironmentSpec, settings: ControlSettings) -> tuple[float, ...]:
    """Forward distances that end before the obstacle in front [m], ascending.

    Multiples of the step up to ``max_forward_m`` that leave ``stand_off_m``.
    """
    room = math.floor((front_m - settings.stand_off_m) / spec.step_m + 1e-9)
    most = math.floor(spec.max_forward_m / spec.step_m + 1e-9)
    return tuple(spec.step_m * count for count in range(1, min(room, most) + 1))


class AdmissibleActionControl:
    """Keeps U_t over one stage.

    - A forward is shortened, or masked, before it would hit.
    - After a stall forward is masked; the next effective motion, a turn included, lifts the mask.
    - After N_turn turns in a row only forward or STOP is left; an effective forward lifts it.
    - A turn that would only undo the turn just made is masked while forward is possible: to and fro gains nothing. With
      forward masked, turning back is the recovery.

    What is left empty of forward and turns is ``blocked``, and the stage goes back to the planner.
    """

    def __init__(self, spec: EnvironmentSpec, settings: ControlSettings) -> None:
        self._spec = spec
        self._settings = settings
        self._stalled = False
        self._turns = TurnMonitor(settings.consecutive_turns, settings.stall_m)

    def observe(self, decision: ExecutedDecision) -> None:
        """Take note of what a decision really did."""
        self._turns.observe(decision)
        if isinstance(decision.asked, MoveForward):
            self._stalled = decision.stalled
        elif abs(decision.turned_rad) >= math.radians(self._spec.turn_deg) / 2:
            self._stalled = False

    def admissible(self, obstacles: ObstacleDistances) -> AdmissibleActions:
        """U_t for the next query."""
        reasons: list[str] = []
        forward = forward_choices(obstacles.front_m, self._spec, self._settings)
        if self._stalled:
            forward = ()
            reasons.append("forward is masked: the last forward did not move the body")
        elif not forward:
            reasons.append(f"forward is masked: an obstacle stands {obstacles.front_m:.2f} m ahead")
        elif forward[-1] + self._spec.step_m / 2 < self._spec.max_forward_m:
            reasons.append(f"forward is limited to {forward[-1]:.2f} m: an obstacle stands {obstacles.front_m:.2f} m ahead")
        left = right = not self._turns.exhausted
        if self._turns.exhausted:
            reasons.append(f"turns are masked: {self._settings.consecutive_turns} turns were made in a row")
        elif forward and self._turns.reversal is Side.LEFT:
            left = False
            reasons.append("left is masked: it would undo the turn just made")
        elif forward and self._turns.reversal is Side.RIGHT:
            right = False
            reasons.append("right is masked: it would undo the turn just made")
        return AdmissibleActions(forward_m=forward, left=left, right=right, reasons=tuple(reasons))
