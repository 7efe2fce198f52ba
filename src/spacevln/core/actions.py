"""Primitive actions, executor decisions and what the body really did (paper, "Stagewise Closed-Loop Navigation Interface")."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


@dataclass(frozen=True, slots=True)
class Stop:
    """End the stage (executor) or the episode (environment)."""


@dataclass(frozen=True, slots=True)
class MoveForward:
    """Move along the heading by ``distance_m`` [m]."""

    distance_m: float = 0.25


@dataclass(frozen=True, slots=True)
class TurnLeft:
    """Turn counter-clockwise by ``angle_deg`` [deg]."""

    angle_deg: float = 30.0


@dataclass(frozen=True, slots=True)
class TurnRight:
    """Turn clockwise by ``angle_deg`` [deg]."""

    angle_deg: float = 30.0


Action = Stop | MoveForward | TurnLeft | TurnRight


class TurnPurpose(StrEnum):
    """Why an executor turns (paper, "Action-space constraints")."""

    ALIGN = "align"
    AVOID = "avoid"


@dataclass(frozen=True, slots=True)
class Motion:
    """What an environment reports after one primitive.

    Args:
        moved_m: horizontal displacement of the feet.
        turned_rad: change of heading, left positive.
        collided: something shortened or deflected the requested move.
    """

    moved_m: float
    turned_rad: float
    collided: bool


def describe(action: Action) -> str:
    """A short name for people and prompts: ``"forward 0.75"``, ``"left 30"``, ``"stop"``."""
    match action:
        case Stop():
            return "stop"
        case MoveForward(distance_m=distance_m):
            return f"forward {distance_m:.2f}"
        case TurnLeft(angle_deg=angle_deg):
            return f"left {angle_deg:.0f}"
        case TurnRight(angle_deg=angle_deg):
            return f"right {angle_deg:.0f}"
