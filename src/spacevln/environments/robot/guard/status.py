"""What the guard says about itself."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol


class GuardState(StrEnum):
    """Whether wishes reach the wheels."""

    READY = "ready"
    """They do, within the limits."""
    HELD = "held"
    """They do not, until the reason is gone."""
    STOPPED = "stopped"
    """They do not, until the operator resumes."""
    ENDED = "ended"
    """The guard has let go of the wheels, at zero."""


class StopReason(StrEnum):
    """Why wishes do not reach the wheels."""

    NONE = ""
    AGENT = "agent"
    POSE = "pose"
    RGB = "rgb"
    DEPTH = "depth"
    BLIND = "depth_blind"
    CLOCK = "clock"
    WHEELS = "wheels_blocked"
    POSE_JUMP = "pose_jump"
    GEOFENCE = "geofence"
    OPERATOR = "operator"
    TRANSPORT = "transport"


@dataclass(frozen=True, slots=True)
class GuardStatus:
    """One report.

    Args:
        state, reason: see there; the reason of READY is none.
        speed_m_s, turn_rad_s: what is commanded now.
        free_m: free way ahead of the body as depth shows it [m].
        limited: the last wish was slowed or stopped by an obstacle or the fence ahead.
        stops: how often wishes were cut off since the start.
    """

    state: GuardState
    reason: StopReason
    speed_m_s: float = 0.0
    turn_rad_s: float = 0.0
    free_m: float = 0.0
    limited: bool = False
    stops: int = 0


class WheelLink(Protocol):
    """The agent's side of the guard."""

    def wish(self, speed_m_s: float, turn_rad_s: float) -> None:
        """Ask for velocities; to be said again within ``watchdog.agent_s``."""

    def operate(self, word: str) -> None:
        """What the operator says: ``"stop"`` or ``"resume"``."""

    def status(self) -> GuardStatus:
        """The newest report."""

    def close(self) -> None:
        """Let go; the guard commands zero and ends. May be called twice."""
