"""From an executor's decision to the environment's primitives (appendix "Action-space constraints", decomposition)."""

from __future__ import annotations

import math

from spacevln.core import Action, EnvironmentSpec, MoveForward, Stop, TurnLeft, TurnRight, wrap_angle


def _count(amount: float, unit: float, most: int) -> int:
    """Whole units in an amount: nearest, halves up, at least one, at most ``most``."""
    return min(max(math.floor(amount / unit + 0.5), 1), most)


def forward_count(distance_m: float, spec: EnvironmentSpec) -> int:
    """Number of forward primitives for a distance: nearest multiple of the step, halves up, 1 up to ``max_forward_m``."""
    return _count(distance_m, spec.step_m, max(1, math.floor(spec.max_forward_m / spec.step_m + 1e-9)))


def turn_count(angle_deg: float, spec: EnvironmentSpec) -> int:
    """Number of turn primitives for an angle: nearest multiple of the turn, halves up, 1 up to half a revolution."""
    return _count(angle_deg, spec.turn_deg, max(1, spec.lookaround_count // 2))


def decompose(action: Action, spec: EnvironmentSpec) -> tuple[Action, ...]:
    """The primitives that carry out one executor decision.

    A positive amount that is no whole multiple is rounded to the nearest one, halves up, never to zero. STOP ends a stage
    and moves nothing, so it has none.
    """
    match action:
        case Stop():
            return ()
        case MoveForward(distance_m=distance_m):
            return (MoveForward(spec.step_m),) * forward_count(distance_m, spec)
        case TurnLeft(angle_deg=angle_deg):
            return (TurnLeft(spec.turn_deg),) * turn_count(angle_deg, spec)
        case TurnRight(angle_deg=angle_deg):
            return (TurnRight(spec.turn_deg),) * turn_count(angle_deg, spec)


def turns_toward(heading_rad: float, spec: EnvironmentSpec) -> tuple[Action, ...]:
    """The fewest turn primitives that bring an egocentric heading to the front; straight back goes left."""
    turns = round(math.degrees(wrap_angle(heading_rad)) / spec.turn_deg)
    return (TurnLeft(spec.turn_deg),) * turns if turns >= 0 else (TurnRight(spec.turn_deg),) * -turns
