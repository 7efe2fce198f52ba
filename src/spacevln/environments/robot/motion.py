"""Carries out one primitive through the wheel guard, and waits where the guard says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from spacevln.core.errors import EnvironmentFailure, SafetyStop
from spacevln.core.geometry import Pose
from spacevln.environments.robot.clock import Clock
from spacevln.environments.robot.guard.status import GuardState, GuardStatus, StopReason, WheelLink
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Streams
from spacevln.environments.robot.tracking import Smoothed, Tracker

_STUCK_S = 0.8
"""How long an obstacle may keep the body from moving before the primitive ends."""
_CREEP_M_S = 0.02


class Outcome(StrEnum):
    """How a primitive ended."""

    REACHED = "reached"
    OBSTACLE = "obstacle"
    BLOCKED = "blocked"
    TIMEOUT = "timeout"
    RESUMED = "resumed"
    """The operator resumed after a stop: what was left of the primitive is dropped."""
    CALLED_OFF = "called_off"


@dataclass(slots=True)
class Times:
    """Where the time went [s], since the start of the episode."""

    begin_s: float
    first_motion_s: float | None = None
    moving_s: float = 0.0
    held_s: float = 0.0

    def idle_share(self, total_s: float) -> float:
        """Share of a time in which the robot stood still, for whatever reason."""
        return 1.0 - self.moving_s / total_s if total_s > 0 else 1.0


def _never() -> bool:
    return False


class Pilot:
    """Moves the body.

    Args:
        link: to the wheel guard.
        streams: give the live pose.
        profile: of the robot.
        clock: that waits.
        dry: nothing moves: a primitive ends at once.
    """

    def __init__(self, link: WheelLink, streams: Streams, profile: RobotProfile, clock: Clock, *, dry: bool = False) -> None:
        self._link, self._streams, self._clock, self._dry = link, streams, clock, dry
        self._motions, self._period_s = profile.motions, 1 / profile.control_hz
        self.times = Times(clock.now_s())

    def track(self, tracker: Tracker, until: Callable[[], bool] | None = None) -> Outcome:
        """Move until the target is reached or something prevents it; the body stands still afterwards.

        Args:
            tracker: of the target.
            until: asked again and again; ends the motion when it holds.

        Raises:
            EnvironmentFailure: data stayed away, or the guard is gone.
            SafetyStop: a stop was not resumed.
        """
        try:
            return self._track(tracker, until or _never)
        finally:
            self._stand()

    def _track(self, tracker: Tracker, until: Callable[[], bool]) -> Outcome:
        smoothed, begin_s, stuck_s, last_ns = Smoothed(), self._clock.now_s(), 0.0, 0
        pose = smoothed.update(self._pose()[1])
        while (wish := tracker.wish(pose)) is not None:
            if until():
                return Outcome.CALLED_OFF
            status = self._link.status()
            if status.reason is StopReason.WHEELS:
                return Outcome.BLOCKED
            if status.state is not GuardState.READY:
                waited_s = self._wait(status)
                if status.state is GuardState.STOPPED:
                    return Outcome.RESUMED
                begin_s += waited_s
                smoothed = Smoothed()
            if self._dry:
                self._link.wish(*wish)
                self._clock.sleep(self._period_s)
                return Outcome.OBSTACLE
            stuck_s = stuck_s + self._period_s if status.limited and status.speed_m_s < _CREEP_M_S else 0.0
            if stuck_s > _STUCK_S:
                return Outcome.OBSTACLE
            if self._clock.now_s() - begin_s > self._motions.timeout_s:
                return Outcome.TIMEOUT
            self._go(*wish)
            stamp_ns, live = self._pose()
            pose = smoothed.update(live) if stamp_ns != last_ns else pose
            last_ns = stamp_ns
        return Outcome.REACHED

    def _go(self, speed_m_s: float, turn_rad_s: float) -> None:
        self._link.wish(speed_m_s, turn_rad_s)
        times = self.times
        if times.first_motion_s is None:
            times.first_motion_s = self._clock.now_s() - times.begin_s
        before_s = self._clock.now_s()
        self._clock.sleep(self._period_s)
        times.moving_s += self._clock.now_s() - before_s

    def _stand(self) -> None:
        self._link.wish(0.0, 0.0)
        self._clock.sleep(self._motions.settle_s)

    def _pose(self) -> tuple[int, Pose]:
        found = self._streams.pose
        if found is None:
            raise EnvironmentFailure("The robot has told no pose: see `spacevln robot check`.")
        return found

    def _wait(self, status: GuardStatus) -> float:
        """Stand still until the guard is ready again; the time waited [s]."""
        begin_s = self._clock.now_s()
        while status.state is not GuardState.READY:
            waited_s = self._clock.now_s() - begin_s
            if status.state is GuardState.ENDED:
                raise EnvironmentFailure("The wheel guard has ended; the base stops by its own command time-out.")
            if waited_s > self._motions.patience_s:
                if status.state is GuardState.STOPPED:
                    raise SafetyStop(
                        f"The wheel guard stopped the robot ({status.reason}) and nobody resumed within {waited_s:.0f} s: "
                        "look at the robot, then run again."
                    )
                raise EnvironmentFailure(
                    f"The wheel guard holds the robot ({status.reason}) for {waited_s:.0f} s: see `spacevln robot check`."
                )
            self._link.wish(0.0, 0.0)
            self._clock.sleep(self._period_s)
            status = self._link.status()
        self.times.held_s += self._clock.now_s() - begin_s
        return self._clock.now_s() - begin_s
