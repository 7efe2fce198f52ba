"""The guard as a process: ``python -m spacevln.environments.robot.guard``; the agent talks to it through a pipe.

The agent writes one JSON object per line: first the profile, then wishes and the operator's words. The guard answers with its
status, ten times a second and at every change. When the pipe ends, however the agent ended, the wheels are told to stand still.
"""

from __future__ import annotations

import json
import logging
import signal
import sys
import threading
from dataclasses import asdict, replace
from typing import IO, Any

from spacevln.core.errors import EnvironmentFailure, SpaceVLNError
from spacevln.core.geometry import Float
from spacevln.environments.robot.clock import Clock, SystemClock
from spacevln.environments.robot.guard.status import GuardState, GuardStatus, StopReason
from spacevln.environments.robot.guard.wheel import WheelGuard
from spacevln.environments.robot.images import depth_of
from spacevln.environments.robot.messages import CameraInfo, Header, TriggerReply, Twist, TwistStamped, Vector3
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Picture, PoseSource, picture_topic
from spacevln.environments.robot.transforms import place_of_camera
from spacevln.environments.robot.transport import Qos, Topic, Transport, open_transport

FAREWELL_S = 0.5
"""How long zero is commanded after the end of the agent."""
REPORT_S = 0.1


class WheelHolder:
    """A guard on a transport: hears the sensors, writes the velocity.

    Args:
        transport: of the robot.
        profile: names and limits.
        clock: steady time and time of day.
        dry: command zero whatever is wished.
    """

    def __init__(self, transport: Transport, profile: RobotProfile, clock: Clock, *, dry: bool = False) -> None:
        self.guard = WheelGuard(profile, clock)
        self._transport, self._profile, self._clock, self._dry = transport, profile, clock, dry
        self._info: CameraInfo | None = None
        self._T_base_camera: Float | None = None
        topics = profile.topics
        self._source = PoseSource(transport, profile, self.guard.hear_pose)
        transport.subscribe(Topic(topics.camera_info, CameraInfo), self._calibrated)
        transport.subscribe(picture_topic(topics.rgb), lambda image: self.guard.hear_rgb(image.header.stamp_ns))
        transport.subscribe(picture_topic(topics.depth), self._depth)
        transport.serve_trigger(topics.stop, lambda: self._operated("stop"))
        transport.serve_trigger(topics.resume, lambda: self._operated("resume"))

    def tick(self) -> None:
        """Command the velocity of now.

        Raises:
            EnvironmentFailure: the transport broke.
        """
        speed, turn = self.guard.tick()
        self.command(*((0.0, 0.0) if self._dry else (speed, turn)))

    def command(self, speed_m_s: float, turn_rad_s: float) -> None:
        """Write a velocity."""
        twist = Twist(Vector3(x=speed_m_s), Vector3(z=turn_rad_s))
        topics = self._profile.topics
        if topics.stamped_cmd_vel:
            header = Header(self._clock.stamp_ns(), self._profile.frames.base)
            self._transport.publish(Topic(topics.cmd_vel, TwistStamped, Qos.RELIABLE), TwistStamped(header, twist))
        else:
            self._transport.publish(Topic(topics.cmd_vel, Twist, Qos.RELIABLE), twist)

    def _operated(self, word: str) -> TriggerReply:
        self.guard.operate(word)
        return TriggerReply(success=True, message=f"{word}: the wheel guard obeys")

    def _calibrated(self, info: CameraInfo) -> None:
        self._info = info

    def _depth(self, image: Picture) -> None:
        if self._info is None:
            return
        if self._T_base_camera is None:
            mount, base = self._profile.mount, self._profile.frames.base
            self._T_base_camera = place_of_camera(self._source.tree, base, self._info.header.frame_id, mount)
        if self._T_base_camera is not None:
            depth_m = depth_of(image, self._profile.images.depth_scale_m)
            self.guard.hear_depth(image.header.stamp_ns, depth_m, self._info, self._T_base_camera)


def serve(source: IO[str], sink: IO[str]) -> None:
    """Hold the wheels until the source ends."""
    first = json.loads(source.readline())
    profile, clock = RobotProfile.model_validate(first["profile"]), SystemClock()
    transport = open_transport(profile.transport, domain=profile.domain, distro=profile.distro, endpoint=profile.endpoint)
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's Ctrl-C is for the agent; its end reaches us by the pipe
    holder = WheelHolder(transport, profile, clock, dry=first["dry"])
    threading.Thread(target=_listen, args=(source, holder.guard, ended), daemon=True).start()
    try:
        _hold(holder, sink, ended, 1 / profile.control_hz)
    finally:
        transport.close()


def _listen(source: IO[str], guard: WheelGuard, ended: threading.Event) -> None:
    for line in source:
        said: dict[str, Any] = json.loads(line)
        if "wish" in said:
            guard.wish(*said["wish"])
        else:
            guard.operate(said["operate"])
    ended.set()


def _hold(holder: WheelHolder, sink: IO[str], ended: threading.Event, period_s: float) -> None:
    said, said_s, clock = None, float("-inf"), SystemClock()
    while not ended.is_set():
        begin_s = clock.now_s()
        holder.tick()
        status = holder.guard.status()
        mark = (status.state, status.reason, status.limited)
        if mark != said or begin_s - said_s >= REPORT_S:
            said, said_s = mark, begin_s
            _tell(sink, status, ended)
        ended.wait(max(0.0, period_s - (clock.now_s() - begin_s)))
    last = replace(holder.guard.status(), state=GuardState.ENDED, reason=StopReason.AGENT)
    _tell(sink, last, ended)
    end_s = clock.now_s() + FAREWELL_S
    while clock.now_s() < end_s:
        holder.command(0.0, 0.0)
        clock.sleep(period_s)


def _tell(sink: IO[str], status: GuardStatus, ended: threading.Event) -> None:
    try:
        sink.write(json.dumps(asdict(status)) + "\n")
        sink.flush()
    except (BrokenPipeError, ValueError):
        ended.set()  # nobody reads: the agent is gone


def main() -> int:
    """The process."""
    logging.basicConfig(level=logging.WARNING, format="wheel guard: %(message)s")
    try:
        serve(sys.stdin, sys.stdout)
    except EnvironmentFailure as error:
        logging.warning("%s", error)
        return 1
    except SpaceVLNError as error:
        logging.warning("%s", error)
        return 3
    return 0
