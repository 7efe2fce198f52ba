"""The paper's robot as an :class:`~spacevln.core.interfaces.Environment`: posed RGB-D out, closed-loop primitives in."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from spacevln.core.actions import Action, Motion, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.errors import ContractError, EnvironmentFailure
from spacevln.core.geometry import Pose, wrap_angle
from spacevln.core.interfaces import EnvironmentSpec
from spacevln.core.sensing import InstanceLabel, Observation
from spacevln.core.task import EpisodeSpec
from spacevln.environments.robot.clock import Clock, SystemClock
from spacevln.environments.robot.guard.status import WheelLink
from spacevln.environments.robot.guard.surroundings import kept_free_m
from spacevln.environments.robot.motion import Outcome, Pilot, Times
from spacevln.environments.robot.observer import Observer, flat
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Snapshot, Streams
from spacevln.environments.robot.tracking import ForwardTracker, TurnTracker
from spacevln.environments.robot.transport import Transport

_TOLERANCE = 1e-6
_POLL_S = 0.01
SHORT_M = 0.1
"""A forward that falls this short of its target counts as collided, whatever the reason."""
SHORT_RAD = math.radians(10.0)

LabelNames = Callable[[str], Mapping[int, InstanceLabel]]


class RobotEnvironment:
    """Drives a ROS 2 robot.

    The episode frame begins where the robot stands at the reset; nobody carries it to ``episode.start`` but ``place``.

    Args:
        transport: of its messages.
        link: to the wheel guard, which alone writes velocities.
        profile: names, limits, tolerances.
        clock: of this machine, or a simulated one.
        place: puts the robot at an episode's start: a simulator does, an operator may.
        label_names: of a simulator: what the instance ids of a scene are called.
        dry: no motion; primitives are decided and reported as what really happened, nothing.

    Raises:
        EnvironmentFailure: a stream is missing or cannot be understood.
    """

    def __init__(
        self,
        transport: Transport,
        link: WheelLink,
        profile: RobotProfile,
        clock: Clock | None = None,
        *,
        place: Callable[[EpisodeSpec], None] | None = None,
        label_names: LabelNames | None = None,
        dry: bool = False,
    ) -> None:
        self._transport, self._link, self._profile = transport, link, profile
        self._clock: Clock = clock or SystemClock()
        self._place, self._label_names = place, label_names
        self._streams = Streams(transport, profile, self._clock)
        self._pilot = Pilot(link, self._streams, profile, self._clock, dry=dry)
        self._closed = False
        self._observer = self._connected()
        motions = profile.motions
        self._spec = EnvironmentSpec(
            self._observer.camera, motions.step_m, motions.turn_deg, motions.max_forward_m, kept_free_m(profile.limits)
        )
        self._origin: Pose | None = None
        self._names: Mapping[int, InstanceLabel] = {}
        self._heading_rad = 0.0
        self._set_out: Pose | None = None  # where the robot stood when it went on while a model thought
        self._observation: Observation | None = None

    @property
    def spec(self) -> EnvironmentSpec:
        """The rectified camera; by default 0.5 m steps up to 1.5 m and 45 degree turns, eight to a look-around.

        The body's radius is that of the disc that the guard keeps free: where less room is, it would stop.
        """
        return self._spec

    @property
    def goes_on_while_thinking(self) -> bool:
        """Whether the profile lets the robot go on while a model thinks."""
        return self._profile.motions.while_thinking == "continue"

    @property
    def origin(self) -> Pose:
        """Of the episode frame in the fixed frame."""
        if self._origin is None:
            raise ContractError("RobotEnvironment.origin was asked before reset(): reset to an episode first.")
        return self._origin

    @property
    def times(self) -> Times:
        """Where the time of the episode went."""
        return self._pilot.times

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Begin where the robot stands."""
        self._observation = self._origin = self._set_out = None
        if self._place is not None:
            self._place(episode)
        self._names = self._label_names(episode.scene) if self._label_names is not None else {}
        snapshot = self._fresh_snapshot(self._clock.stamp_ns())
        self._origin = flat(snapshot.pose)
        self._heading_rad = self._origin.yaw_rad
        self._observation = self._observed(snapshot)
        self._pilot.times = Times(self._clock.now_s())
        return self._observation

    def observe(self) -> Observation:
        """What the camera saw when the body last came to rest."""
        if self._observation is None:
            raise ContractError("RobotEnvironment.observe() was called before reset(): reset to an episode first.")
        return self._observation

    def live(self) -> Observation | None:
        """What the camera sees now, if it is newer than what :meth:`observe` tells; for mapping while a model thinks."""
        if self._origin is None:
            return None
        snapshot = self._streams.snapshot()
        return None if snapshot is None else self._observed(snapshot)

    def proceed(self, distance_m: float, until: Callable[[], bool]) -> None:
        """Go on straight ahead while a model thinks; the next primitive takes the way into account.

        The next forward is measured from where the robot last stood, so that a way of up to one step is part of it; a turn is
        made where the robot then is. Blocks; another thread may ask :meth:`live` meanwhile.

        Args:
            distance_m: at most; a step of the spec at most.
            until: ends it.

        Raises:
            EnvironmentFailure, SafetyStop: as :meth:`execute`.
        """
        self._set_out = self._here()
        self._pilot.track(self._ahead(self._set_out, min(distance_m, self._profile.motions.step_m)), until)

    def execute(self, action: Action) -> Motion:
        """Carry out one primitive; the motion told is what the pose shows.

        Raises:
            EnvironmentFailure: a stream stayed away, or the guard is gone.
            SafetyStop: the robot was stopped and not resumed.
            ContractError: the action is none of the spec's primitives, or the episode is over.
        """
        before, motions = self.observe().pose, self._profile.motions
        start, self._set_out = self._set_out or self._here(), None
        match action:
            case Stop():
                self._link.wish(0.0, 0.0)
                self._observation = None
                return Motion(0.0, 0.0, False)
            case MoveForward(distance_m=distance_m) if abs(distance_m - motions.step_m) < _TOLERANCE:
                outcome = self._pilot.track(self._ahead(start, distance_m))
            case TurnLeft(angle_deg=angle_deg) if abs(angle_deg - motions.turn_deg) < _TOLERANCE:
                outcome = self._turn(math.radians(angle_deg))
            case TurnRight(angle_deg=angle_deg) if abs(angle_deg - motions.turn_deg) < _TOLERANCE:
                outcome = self._turn(-math.radians(angle_deg))
            case _:
                raise ContractError(
                    f"{action!r} is no primitive: allowed are Stop(), MoveForward({motions.step_m}), "
                    f"TurnLeft({motions.turn_deg}) and TurnRight({motions.turn_deg}); split longer decisions."
                )
        self._observation = self._observed(self._fresh_snapshot(self._clock.stamp_ns()))
        return self._realised(action, before, self._observation.pose, outcome)

    def close(self) -> None:
        """Let go of the wheels and leave the network."""
        if self._closed:
            return
        self._closed = True
        self._link.close()
        self._transport.close()

    def _ahead(self, start: Pose, distance_m: float) -> ForwardTracker:
        line = Pose(start.x_m, start.y_m, 0.0, self._heading_rad)
        return ForwardTracker(line, distance_m, self._profile.motions, self._profile.limits)

    def _turn(self, angle_rad: float) -> Outcome:
        target = wrap_angle(self._heading_rad + angle_rad)  # a lattice of headings: errors do not add up over a look-around
        outcome = self._pilot.track(TurnTracker(target, self._profile.motions, self._profile.limits))
        self._heading_rad = target if outcome is Outcome.REACHED else self._here().yaw_rad
        return outcome

    def _realised(self, action: Action, before: Pose, after: Pose, outcome: Outcome) -> Motion:
        moved_m = before.distance_m(after.x_m, after.y_m)
        turned_rad = wrap_angle(after.yaw_rad - before.yaw_rad)
        if outcome is Outcome.RESUMED:
            self._heading_rad = self._here().yaw_rad
        short = outcome is not Outcome.REACHED
        match action:
            case MoveForward(distance_m=distance_m):
                short = short or moved_m < distance_m - SHORT_M
            case TurnLeft(angle_deg=angle_deg) | TurnRight(angle_deg=angle_deg):
                short = short or abs(turned_rad) < math.radians(angle_deg) - SHORT_RAD
            case _:
                pass
        return Motion(moved_m, turned_rad, short)

    def _here(self) -> Pose:
        found = self._streams.pose
        if found is None:
            raise EnvironmentFailure("The robot has told no pose: see `spacevln robot check`.")
        return found[1]

    def _observed(self, snapshot: Snapshot) -> Observation:
        return self._observer.observation(snapshot, self._origin or flat(snapshot.pose), self._names)

    def _fresh_snapshot(self, after_ns: int) -> Snapshot:
        """The first synchronised set taken after a time."""
        end_s = self._clock.now_s() + self._profile.motions.patience_s
        while (snapshot := self._streams.snapshot(after_ns)) is None:
            if self._clock.now_s() > end_s:
                raise EnvironmentFailure(f"No synchronised image, depth and pose came: {self._missing()}.")
            self._clock.sleep(_POLL_S)
        return snapshot

    def _connected(self) -> Observer:
        end_s = self._clock.now_s() + self._profile.motions.patience_s
        while True:
            info, place = self._streams.info, self._streams.place_of_camera()
            if info is not None and place is not None and self._streams.pose is not None:
                return Observer(self._profile, info, place)
            if self._clock.now_s() > end_s:
                self.close()
                raise EnvironmentFailure(f"The robot {self._profile.name!r} is not heard: {self._missing()}.")
            self._clock.sleep(_POLL_S)

    def _missing(self) -> str:
        topics, times, now_s = self._profile.topics, self._streams.times, self._clock.now_s()
        limit_s = self._profile.motions.patience_s
        names = (topics.rgb, topics.depth, topics.odometry or topics.tf)
        silent = [
            name
            for name, heard_s in zip(names, (times.rgb_s, times.depth_s, times.pose_s), strict=True)
            if now_s - heard_s > limit_s / 2
        ]
        if self._streams.info is None:
            silent.append(topics.camera_info)
        elif self._streams.place_of_camera() is None:
            silent.append(
                f"a transform from {self._profile.frames.base!r} to {self._streams.info.header.frame_id!r} (or [mount])"
            )
        heard = f"missing {', '.join(silent)}" if silent else "the stamps of colour, depth and pose do not match"
        return f"{heard}; run `spacevln robot check`"
