"""The guard's rules, without any process or transport: what it hears goes in, the velocity of this tick comes out."""

from __future__ import annotations

import math
import threading

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float, Pose, wrap_angle
from spacevln.environments.robot.clock import Clock
from spacevln.environments.robot.guard.geofence import inside
from spacevln.environments.robot.guard.slack import SlackMonitor
from spacevln.environments.robot.guard.stamps import Stamps
from spacevln.environments.robot.guard.status import GuardState, GuardStatus, StopReason
from spacevln.environments.robot.guard.surroundings import Surroundings
from spacevln.environments.robot.messages import NANO, CameraInfo
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.transforms import PoseHistory

_NEVER = float("-inf")
_STILL = 1e-3
LATCHED = frozenset({StopReason.POSE_JUMP, StopReason.GEOFENCE, StopReason.OPERATOR, StopReason.CLOCK})
"""What only the operator's resume lifts."""


class WheelGuard:
    """Turns wishes into velocities that are safe now.

    Every ``hear_*``, ``wish`` and ``operate`` may be called from any thread; ``tick`` from one.

    Args:
        profile: limits and watchdogs.
        clock: of this machine.
    """

    def __init__(self, profile: RobotProfile, clock: Clock) -> None:
        self._limits, self._watch, self._clock = profile.limits, profile.watchdog, clock
        self._lock = threading.RLock()
        self._around = Surroundings(profile.limits)
        self._slack = SlackMonitor(profile.watchdog)
        self._history = PoseHistory(profile.sync.pose_gap_s)
        self._start: Pose | None = None
        self._wish, self._wish_s = (0.0, 0.0), _NEVER
        self._heard_s = {StopReason.POSE: _NEVER, StopReason.RGB: _NEVER, StopReason.DEPTH: _NEVER}
        self._stamps: dict[StopReason, Stamps] = {}
        self._latched = StopReason.NONE
        self._command, self._tick_s = (0.0, 0.0), clock.now_s()
        self._state, self._reason, self._limited, self._stops = GuardState.HELD, StopReason.POSE, False, 0

    def hear_pose(self, stamp_ns: int, pose: Pose) -> None:
        """A pose of the body, fixed frame."""
        with self._lock:
            now_s = self._heard(StopReason.POSE, stamp_ns)
            last = self._history.latest
            if last is not None and self._jumped(last, stamp_ns, pose):
                self._latch(StopReason.POSE_JUMP)
            self._history.add(stamp_ns, pose)
            self._start = self._start or pose
            self._around.stand(pose)
            self._slack.moved(now_s, pose)
            if not inside(self._limits.geofence_m, *self._from_start(pose)):
                self._latch(StopReason.GEOFENCE)

    def hear_rgb(self, stamp_ns: int) -> None:
        """A colour image came."""
        with self._lock:
            self._heard(StopReason.RGB, stamp_ns)

    def hear_depth(self, stamp_ns: int, depth_m: NDArray[np.float32], info: CameraInfo, T_base_camera: Float) -> None:
        """A depth image came (H, W) [m], 0 for no measurement."""
        with self._lock:
            now_s = self._heard(StopReason.DEPTH, stamp_ns)
            pose = self._history.at(stamp_ns) or (self._history.latest[1] if self._history.latest else None)
            if pose is not None:
                self._around.see(depth_m, info, T_base_camera, pose, now_s)

    def wish(self, speed_m_s: float, turn_rad_s: float) -> None:
        """What the agent wants; it says so again and again while it wants it."""
        with self._lock:
            self._wish, self._wish_s = (speed_m_s, turn_rad_s), self._clock.now_s()
            if abs(speed_m_s) < _STILL and abs(turn_rad_s) < _STILL:
                self._slack.forget()

    def operate(self, word: str) -> None:
        """``"stop"`` latches; ``"resume"`` lifts whatever is latched and takes pose and clocks as they now are."""
        with self._lock:
            if word == "stop":
                self._latch(StopReason.OPERATOR)
            elif word == "resume":
                self._latched = StopReason.NONE
                self._stamps.clear()
                self._wish = (0.0, 0.0)
                self._slack.forget()

    def tick(self) -> tuple[float, float]:
        """The velocities (forward [m/s], turn [rad/s]) to command now."""
        with self._lock:
            now_s = self._clock.now_s()
            elapsed_s, self._tick_s = now_s - self._tick_s, now_s
            reason = self._latched or self._missing(now_s)
            self._report(reason)
            if reason:
                self._command = (0.0, 0.0)  # exempt from the acceleration limits
            else:
                self._command = self._follow(now_s, min(elapsed_s, 0.1))
            self._slack.commanded(now_s, *self._command, elapsed_s)
            return self._command

    def status(self) -> GuardStatus:
        """The newest report."""
        with self._lock:
            latest = self._history.latest
            free_m = self._around.free_m(latest[1]) if latest else 0.0
            return GuardStatus(self._state, self._reason, *self._command, round(free_m, 3), self._limited, self._stops)

    def _follow(self, now_s: float, elapsed_s: float) -> tuple[float, float]:
        (wish_v, wish_w), limits = self._wish, self._limits
        moves = wish_v > 0 or self._command[0] > 0
        ceiling = self._ceiling_m_s(now_s) if moves else limits.speed_m_s
        v = min(max(wish_v, 0.0), limits.speed_m_s, ceiling)  # never backwards: there is no eye behind
        w = math.copysign(min(abs(wish_w), limits.turn_rad_s), wish_w)
        self._limited = v < min(wish_v, limits.speed_m_s) - _STILL
        last_v, last_w = self._command
        dv, dw = limits.accel_m_s2 * elapsed_s, limits.turn_accel_rad_s2 * elapsed_s
        slowest = min(last_v - limits.brake_m_s2 * elapsed_s, ceiling)
        return max(slowest, min(v, last_v + dv)), min(max(w, last_w - dw), last_w + dw)

    def _ceiling_m_s(self, now_s: float) -> float:
        """Fastest speed from which one can still brake before obstacles and the fence, and slow down before unseen floor."""
        latest = self._history.latest
        if latest is None:
            return 0.0
        done_m = self._command[0] * (now_s - self._heard_s[StopReason.POSE])
        speed = self._braking_from(self._around.free_m(latest[1]) - done_m)
        speed = min(speed, max(self._limits.unseen_m_s, self._braking_from(self._around.seen_m(latest[1]) - done_m)))
        x, y = self._from_start(latest[1].compose(Pose(self._command[0] ** 2 / 2 / self._limits.brake_m_s2 + 0.1, 0.0)))
        return speed if inside(self._limits.geofence_m, x, y) else 0.0

    def _braking_from(self, way_m: float) -> float:
        """Speed that braking ends within a way."""
        return math.sqrt(2 * self._limits.brake_m_s2 * max(0.0, way_m))

    def _missing(self, now_s: float) -> StopReason:
        """What does not come, or what is wrong with what comes."""
        oldest = {StopReason.POSE: self._watch.pose_s, StopReason.RGB: self._watch.image_s, StopReason.DEPTH: self._watch.image_s}
        for reason, limit_s in oldest.items():
            if now_s - self._heard_s[reason] > limit_s:
                return reason
        if self._around.valid_share < self._watch.depth_share:
            return StopReason.BLIND
        if any(self._wish) and now_s - self._wish_s > self._watch.agent_s:
            return StopReason.AGENT
        return StopReason.WHEELS if self._slack.blocked else StopReason.NONE

    def _heard(self, stream: StopReason, stamp_ns: int) -> float:
        """When a message came; what is late is as old as that."""
        now_s = self._clock.now_s()
        stamps = self._stamps.setdefault(stream, Stamps(self._watch))
        late_s = stamps.late_s(now_s, (self._clock.stamp_ns() - stamp_ns) / NANO)
        if stamps.jumped:
            self._latch(StopReason.CLOCK)
        self._heard_s[stream] = max(self._heard_s[stream], now_s - late_s)
        return now_s

    def _jumped(self, last: tuple[int, Pose], stamp_ns: int, pose: Pose) -> bool:
        elapsed_s = max(0.0, (stamp_ns - last[0]) / NANO)
        moved_m = last[1].distance_m(pose.x_m, pose.y_m)
        turned_rad = abs(wrap_angle(pose.yaw_rad - last[1].yaw_rad))
        most_m = self._limits.speed_m_s * elapsed_s + self._watch.pose_jump_m
        return moved_m > most_m or turned_rad > self._limits.turn_rad_s * elapsed_s + math.radians(self._watch.pose_jump_deg)

    def _from_start(self, pose: Pose) -> tuple[float, float]:
        seen = pose.relative_to(self._start or pose)
        return seen.x_m, seen.y_m

    def _latch(self, reason: StopReason) -> None:
        if not self._latched:
            self._latched = reason

    def _report(self, reason: StopReason) -> None:
        state = GuardState.READY
        if reason:
            state = GuardState.STOPPED if reason in LATCHED else GuardState.HELD
        if state is not GuardState.READY and self._state is GuardState.READY:
            self._stops += 1
        self._state, self._reason = state, reason
