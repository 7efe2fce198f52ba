"""The simulated robot: base, odometry and camera with noise, latency and losses, on a transport."""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from spacevln.core.geometry import Pose, wrap_angle
from spacevln.core.sensing import Camera
from spacevln.environments.robot.calibration import info_of
from spacevln.environments.robot.clock import Clock
from spacevln.environments.robot.images import depth_message, label_message, rgb_message
from spacevln.environments.robot.messages import (
    NANO,
    CameraInfo,
    Header,
    Image,
    Odometry,
    Quaternion,
    TFMessage,
    TransformStamped,
    Twist,
    TwistStamped,
    Vector3,
)
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.simulation.base import BaseSettings, SimulatedBase
from spacevln.environments.robot.simulation.world import World
from spacevln.environments.robot.transport import Qos, Topic, Transport

OPTICAL = "camera_color_optical_frame"


@dataclass(frozen=True, slots=True)
class SensorSettings:
    """Of the simulated sensors.

    Args:
        camera: size, field of view, height.
        image_hz, odometry_hz: rates.
        pose_noise_m, pose_noise_deg: standard deviations of what odometry tells; white, as a LiDAR SLAM's.
        depth_noise: standard deviation of depth per squared metre [1/m].
        image_latency_s, pose_latency_s: from measurement to message.
        drop_rate: share of image sets that get lost.
        depth_encoding: 16UC1 or 32FC1.
    """

    camera: Camera = field(default_factory=lambda: Camera(640, 480, 79.0, 0.88))
    image_hz: float = 10.0
    odometry_hz: float = 50.0
    pose_noise_m: float = 0.01
    pose_noise_deg: float = 0.5
    depth_noise: float = 0.002
    image_latency_s: float = 0.05
    pose_latency_s: float = 0.02
    drop_rate: float = 0.02
    depth_encoding: str = "16UC1"


@dataclass(slots=True)
class Faults:
    """What is broken now.

    Args:
        silent: streams that are not sent: ``rgb``, ``depth``, ``pose``.
        blind: depth measures nothing (NaN).
        clock_s: the robot's clock is ahead by this.
        pose_jump_m: odometry is off by this, along x.
        cut: nothing is sent and nothing heard, as when the network or the transport dies.
    """

    silent: frozenset[str] = frozenset()
    blind: bool = False
    clock_s: float = 0.0
    pose_jump_m: float = 0.0
    cut: bool = False


class SimulatedRobot:
    """Publishes what a robot at ``base.pose`` measures, and obeys velocity commands.

    Poses are told as odometry, or as TF where the profile names no topic of odometry, in a frame of its own with the origin where
    the robot first stood. ``move`` and ``look`` may run on two threads.

    Args:
        transport: of its messages.
        profile: names of topics and frames.
        world: around it, scene frame.
        start: pose in it.
        clock: of the robot.
        rng: of all noise.
    """

    def __init__(
        self,
        transport: Transport,
        profile: RobotProfile,
        world: World,
        start: Pose,
        clock: Clock,
        rng: np.random.Generator,
        *,
        base: BaseSettings | None = None,
        sensors: SensorSettings | None = None,
    ) -> None:
        self._transport, self._profile, self._clock = transport, profile, clock
        pose_rng, self._image_rng, base_rng = rng.spawn(3)
        self._pose_rng = pose_rng
        self.base = SimulatedBase(world, start, base or BaseSettings(), base_rng, clock.now_s())
        self.sensors, self.faults = sensors or SensorSettings(), Faults()
        self._origin = start
        self._next_pose_s = self._next_image_s = clock.now_s()
        self._order = itertools.count()
        self._outbox: list[tuple[float, int, Callable[[], None]]] = []
        self._information = info_of(self.sensors.camera, Header(0, OPTICAL))
        topics = profile.topics
        if topics.stamped_cmd_vel:
            stamped = Topic(topics.cmd_vel, TwistStamped, Qos.RELIABLE)
            transport.subscribe(stamped, lambda message: self._commanded(message.twist))
        else:
            transport.subscribe(Topic(topics.cmd_vel, Twist, Qos.RELIABLE), self._commanded)
        self._send(Topic(topics.tf_static, TFMessage, Qos.LATCHED), self._mount())

    def place(self, pose: Pose, world: World | None = None) -> None:
        """Carry the robot somewhere; its odometry knows."""
        if world is not None:
            self.base.world = world
        self.base.place(pose)

    def move(self) -> None:
        """Advance the base to now and send the odometry that is due."""
        now_s = self._clock.now_s()
        self.base.advance(now_s)
        if now_s >= self._next_pose_s - 1e-9:
            self._next_pose_s = max(self._next_pose_s + 1 / self.sensors.odometry_hz, now_s)
            if "pose" not in self.faults.silent:
                self._later(self.sensors.pose_latency_s, *self._told_pose())
        while self._outbox and self._outbox[0][0] <= now_s + 1e-9:
            heapq.heappop(self._outbox)[2]()

    def look(self) -> bool:
        """Take and send an image set if one is due; whether it was."""
        now_s = self._clock.now_s()
        if now_s < self._next_image_s - 1e-9:
            return False
        self._next_image_s = max(self._next_image_s + 1 / self.sensors.image_hz, now_s)
        header = Header(self._stamp_ns(), OPTICAL)
        T_scene_camera = self.base.pose.T_world_body
        T_scene_camera[2, 3] += self.sensors.camera.height_m
        lost = self._image_rng.random() < self.sensors.drop_rate
        silent = self.faults.silent
        if lost or {"rgb", "depth"} <= silent:
            return True
        sight, topics = self.base.world.render(T_scene_camera, self.sensors.camera), self._profile.topics
        noise = self._image_rng.standard_normal(sight.depth_m.shape, np.float32)
        depth_m = sight.depth_m + np.float32(self.sensors.depth_noise) * sight.depth_m**2 * noise
        if self.faults.blind:
            depth_m = np.zeros_like(depth_m)
        messages: list[tuple[Topic[Any], Any]] = [
            (Topic(topics.camera_info, CameraInfo), replace(self._information, header=header))
        ]
        if topics.labels:
            messages.append((Topic(topics.labels, Image), label_message(sight.ids, header)))
        if "depth" not in silent:
            messages.append((Topic(topics.depth, Image), depth_message(depth_m, header, self.sensors.depth_encoding)))
        if "rgb" not in silent:
            messages.append((Topic(topics.rgb, Image), rgb_message(sight.rgb, header)))
        for topic, message in messages:
            self._later(self.sensors.image_latency_s, topic, message)
        return True

    def _commanded(self, twist: Twist) -> None:
        if self.faults.cut:
            return
        self.base.command(twist.linear.x, twist.angular.z, self._clock.now_s())

    def _told_pose(self) -> tuple[Topic[Any], Any]:
        pose = self.base.pose.relative_to(self._origin)
        noise = self._pose_rng.standard_normal(3)
        x = pose.x_m + self.sensors.pose_noise_m * noise[0] + self.faults.pose_jump_m
        y = pose.y_m + self.sensors.pose_noise_m * noise[1]
        yaw = wrap_angle(pose.yaw_rad + math.radians(self.sensors.pose_noise_deg) * noise[2])
        frames = self._profile.frames
        twist = Twist(Vector3(x=self.base.speed_m_s), Vector3(z=self.base.turn_rad_s))
        header, position, turn = (
            Header(self._stamp_ns(), frames.fixed),
            Vector3(float(x), float(y)),
            Quaternion.of_yaw(float(yaw)),
        )
        topics = self._profile.topics
        if not topics.odometry:
            transform = TransformStamped(header, frames.base, position, turn)
            return Topic(topics.tf, TFMessage, Qos.RELIABLE), TFMessage((transform,))
        return Topic(topics.odometry, Odometry), Odometry(header, frames.base, position, turn, twist)

    def _mount(self) -> TFMessage:
        optical = Quaternion(-0.5, 0.5, -0.5, 0.5)  # z forward, x right
        place = Vector3(0.0, 0.0, self.sensors.camera.height_m)
        return TFMessage((TransformStamped(Header(self._stamp_ns(), self._profile.frames.base), OPTICAL, place, optical),))

    def _stamp_ns(self) -> int:
        return self._clock.stamp_ns() + round(self.faults.clock_s * NANO)

    def _later(self, delay_s: float, topic: Topic[Any], message: Any) -> None:
        due_s = self._clock.now_s() + delay_s
        heapq.heappush(self._outbox, (due_s, next(self._order), lambda: self._send(topic, message)))

    def _send(self, topic: Topic[Any], message: Any) -> None:
        if self.faults.cut:
            return
        self._transport.publish(topic, message)
