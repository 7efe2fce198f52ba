"""Posed RGB-D from a robot that somebody else drives."""

from __future__ import annotations

from collections.abc import Iterator

from spacevln.core.errors import EnvironmentFailure
from spacevln.core.geometry import Pose
from spacevln.core.sensing import Observation
from spacevln.environments.robot.clock import Clock, SystemClock
from spacevln.environments.robot.observer import Observer, flat
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Streams
from spacevln.environments.robot.transport import Transport

_POLL_S = 0.01


def capture(
    transport: Transport, profile: RobotProfile, hz: float, seconds: float | None, clock: Clock | None = None
) -> Iterator[tuple[int, Observation]]:
    """Stamp [ns] and observation, at most ``hz`` a second, in the frame of the first one, for ``seconds`` or for ever.

    Raises:
        EnvironmentFailure: nothing synchronised comes for ``patience_s``.
    """
    timer: Clock = clock or SystemClock()
    streams = Streams(transport, profile, timer)
    begin_s = heard_s = timer.now_s()
    observer: Observer | None = None
    origin: Pose | None = None
    last_ns = 0
    while seconds is None or timer.now_s() - begin_s < seconds:
        snapshot, place = streams.snapshot(last_ns), streams.place_of_camera()
        if snapshot is None or place is None:
            if timer.now_s() - heard_s > profile.motions.patience_s:
                raise EnvironmentFailure("No synchronised image, depth and pose came: run `spacevln robot check`.")
            timer.sleep(_POLL_S)
            continue
        observer = observer or Observer(profile, snapshot.info, place)
        origin = origin or flat(snapshot.pose)
        last_ns, heard_s = snapshot.stamp_ns, timer.now_s()
        yield last_ns, observer.observation(snapshot, origin)
        timer.sleep(1 / hz)
