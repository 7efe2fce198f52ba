"""A base played by a test, on a real transport: sensors at their rates, and a note of every velocity command."""

from __future__ import annotations

import threading
import time

import numpy as np

from spacevln.core import Camera
from spacevln.environments.robot.calibration import info_of
from spacevln.environments.robot.images import depth_message, rgb_message
from spacevln.environments.robot.messages import CameraInfo, Header, Image, Odometry, Quaternion, Twist, Vector3
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.transport import Qos, Topic, Transport

CAMERA = Camera(64, 48, 79.0, 0.88)
COMMAND_TIMEOUT_S = 0.25  # of the simulated base
_PERIOD_S = 0.05


class Peer:
    """Stands still in front of nothing; publishes at 20 Hz until closed."""

    def __init__(self, transport: Transport, profile: RobotProfile) -> None:
        self.transport, self.profile = transport, profile
        self.commands: list[tuple[float, float, float]] = []
        self.starved_s = 0.0
        """Longest time for which this machine kept even this process waiting, since it was last set to 0."""
        transport.subscribe(Topic(profile.topics.cmd_vel, Twist, Qos.RELIABLE), self._commanded)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._talk)
        self._thread.start()

    def wait_for_motion(self, timeout_s: float = 40.0) -> None:
        end = time.monotonic() + timeout_s
        while not (self.commands and self.commands[-1][1] > 0):
            assert time.monotonic() < end, "no velocity came"
            time.sleep(0.01)

    def wait_for_zero(self, timeout_s: float = 20.0) -> tuple[float, float]:
        """Steady times of the first zero, and when the wheels stand: then, or earlier by the base's time-out."""
        end = time.monotonic() + timeout_s
        while self.commands[-1][1:] != (0.0, 0.0):
            assert time.monotonic() < end, "the wheels were not stopped"
            time.sleep(0.005)
        moving = [time_s for time_s, v, w in self.commands if (v, w) != (0.0, 0.0)]
        zero_s = min(time_s for time_s, _, _ in self.commands if time_s > moving[-1])
        return zero_s, min(moving[-1] + COMMAND_TIMEOUT_S, zero_s)

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self.transport.close()

    def _commanded(self, twist: Twist) -> None:
        self.commands.append((time.monotonic(), twist.linear.x, twist.angular.z))

    def _talk(self) -> None:
        topics = self.profile.topics
        rgb, depth = np.zeros((48, 64, 3), np.uint8), np.full((48, 64), 9.0, np.float32)
        last_s = time.monotonic()
        while not self._ended.wait(_PERIOD_S):
            self.starved_s = max(self.starved_s, time.monotonic() - last_s - _PERIOD_S)
            last_s = time.monotonic()
            header = Header(time.time_ns(), "camera")
            odometry = Odometry(Header(header.stamp_ns, "odom"), "base_link", Vector3(), Quaternion())
            info = info_of(CAMERA, header)
            self.transport.publish(Topic(topics.odometry, Odometry), odometry)
            self.transport.publish(Topic(topics.camera_info, CameraInfo), info)
            self.transport.publish(Topic(topics.depth, Image), depth_message(depth, header))
            self.transport.publish(Topic(topics.rgb, Image), rgb_message(rgb, header))
