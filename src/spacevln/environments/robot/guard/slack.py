"""Whether the wheels do what they are told: commanded way against the way that the pose shows, over short windows."""

from __future__ import annotations

import math
from collections import deque

from spacevln.core.geometry import Pose, wrap_angle
from spacevln.environments.robot.profile import Watchdog

WINDOWS_S = (0.3, 1.0, 2.0)
"""The slower the body is told to move, the longer it takes until its standing still shows in a noisy pose."""
_LAG_S = 0.1  # of base and pose together: that much of the command may still be on its way
_SHARE = 0.25  # of the commanded way that must show
_MEAN_OF = 4  # poses at either end, against noise


class SlackMonitor:
    """Blocked wheels stay so until the agent asks for standing still."""

    def __init__(self, watch: Watchdog) -> None:
        self._watch = watch
        self._commands: deque[tuple[float, float, float]] = deque(maxlen=200)  # time, forward [m], turn [rad] of a tick
        self._poses: deque[tuple[float, Pose]] = deque(maxlen=200)
        self.blocked = False

    def commanded(self, now_s: float, speed_m_s: float, turn_rad_s: float, elapsed_s: float) -> None:
        """What was commanded over a tick."""
        self._commands.append((now_s, speed_m_s * elapsed_s, turn_rad_s * elapsed_s))

    def forget(self) -> None:
        """The agent stands still by its own wish."""
        self.blocked = False
        self._commands.clear()

    def moved(self, now_s: float, pose: Pose) -> None:
        """What the pose shows."""
        self._poses.append((now_s, pose))
        self.blocked = self.blocked or any(self._stands(now_s, window_s) for window_s in WINDOWS_S)

    def _stands(self, now_s: float, window_s: float) -> bool:
        """Whether the body stood over a window though it was told to move all the time."""
        begin = now_s - window_s
        older = [pose for time_s, pose in self._poses if time_s <= begin][-_MEAN_OF:]
        window = [(v, w) for time_s, v, w in self._commands if begin - _LAG_S <= time_s <= now_s - _LAG_S]
        asked_m, asked_rad = sum(v for v, _ in window), sum(w for _, w in window)
        ahead, turning = asked_m > self._watch.slack_m, abs(asked_rad) > math.radians(self._watch.slack_deg)
        if not older or not (ahead or turning) or not all(abs(w) + abs(v) > 0 for v, w in window):
            return False
        newer = [pose for _, pose in self._poses][-_MEAN_OF:]
        x0, y0, x1, y1 = (sum(p) / len(p) for p in _columns(older, newer))
        base = older[-1].yaw_rad
        turned_rad = _mean_turn(newer, base) - _mean_turn(older, base)
        unmoved = ahead and math.hypot(x1 - x0, y1 - y0) < _SHARE * asked_m
        return unmoved or (turning and abs(turned_rad) < _SHARE * abs(asked_rad))


def _columns(older: list[Pose], newer: list[Pose]) -> tuple[list[float], list[float], list[float], list[float]]:
    return [p.x_m for p in older], [p.y_m for p in older], [p.x_m for p in newer], [p.y_m for p in newer]


def _mean_turn(poses: list[Pose], base_rad: float) -> float:
    return sum(wrap_angle(pose.yaw_rad - base_rad) for pose in poses) / len(poses)
