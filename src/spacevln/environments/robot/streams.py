"""What a robot says, put together: colour, depth and pose of one moment."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from spacevln.core.geometry import Float, Pose
from spacevln.environments.robot.clock import Clock
from spacevln.environments.robot.messages import NANO, CameraInfo, CompressedImage, Image, Odometry, TFMessage
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.transforms import PoseHistory, TfTree, place_of_camera, pose_of_matrix
from spacevln.environments.robot.transport import Qos, Topic, Transport

Picture = Image | CompressedImage
_KEPT = 8


def picture_topic(name: str) -> Topic[Any]:
    """The topic of an image stream; compressed where its name says so."""
    if name.endswith(("/compressed", "/compressedDepth")):
        return Topic(name, CompressedImage)
    return Topic(name, Image)


class PoseSource:
    """Poses of the body in the fixed frame, from odometry or from TF.

    Args:
        transport: hears ``odometry``, or ``tf`` and ``tf_static``.
        profile: names and frames.
        tell: called with every stamp and pose.
    """

    def __init__(self, transport: Transport, profile: RobotProfile, tell: Callable[[int, Pose], None]) -> None:
        self._frames, self._tell = profile.frames, tell
        self.tree = TfTree()
        topics = profile.topics
        self._from_tf = not topics.odometry
        if topics.odometry:
            transport.subscribe(Topic(topics.odometry, Odometry), lambda message: tell(message.header.stamp_ns, message.pose))
        transport.subscribe(Topic(topics.tf_static, TFMessage, Qos.LATCHED), self._transforms)
        if self._from_tf or profile.mount is None:
            transport.subscribe(Topic(topics.tf, TFMessage, Qos.RELIABLE), self._transforms)

    def _transforms(self, message: TFMessage) -> None:
        self.tree.add(message)
        if not self._from_tf:
            return
        T = self.tree.lookup(self._frames.fixed, self._frames.base)
        if T is None:
            return
        links = self.tree.links(self._frames.fixed, self._frames.base)
        stamps = [item.header.stamp_ns for item in message.transforms if item.child_frame_id.strip("/") in links]
        if stamps and max(stamps) > 0:
            self._tell(max(stamps), pose_of_matrix(T))


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """One synchronised set. ``labels`` only from a simulator."""

    stamp_ns: int
    rgb: Picture
    depth: Picture
    info: CameraInfo
    pose: Pose
    labels: Image | None = None


@dataclass(frozen=True, slots=True)
class StreamTimes:
    """Steady time [s] at which each stream was heard last (-inf before), and how many messages came."""

    rgb_s: float
    depth_s: float
    pose_s: float
    counts: tuple[int, int, int]


class Streams:
    """Listens to a robot.

    Args:
        transport: of its messages.
        profile: names, frames, tolerances.
        clock: for arrival times.
    """

    def __init__(self, transport: Transport, profile: RobotProfile, clock: Clock) -> None:
        self._profile, self._clock, self._lock = profile, clock, threading.Lock()
        self._rgb: OrderedDict[int, Picture] = OrderedDict()
        self._depth: OrderedDict[int, Picture] = OrderedDict()
        self._labels: OrderedDict[int, Image] = OrderedDict()
        self._history = PoseHistory(profile.sync.pose_gap_s)
        self._info: CameraInfo | None = None
        self._heard_s = [float("-inf")] * 3
        self._counts = [0, 0, 0]
        topics = profile.topics
        transport.subscribe(picture_topic(topics.rgb), self._keeper(self._rgb, 0))
        transport.subscribe(picture_topic(topics.depth), self._keeper(self._depth, 1))
        transport.subscribe(Topic(topics.camera_info, CameraInfo), self._calibrated)
        if topics.labels:
            transport.subscribe(Topic(topics.labels, Image), self._keeper(self._labels, None))
        self._source = PoseSource(transport, profile, self._moved)

    @property
    def times(self) -> StreamTimes:
        """When each stream was heard last."""
        with self._lock:
            return StreamTimes(
                self._heard_s[0], self._heard_s[1], self._heard_s[2], (self._counts[0], self._counts[1], self._counts[2])
            )

    @property
    def info(self) -> CameraInfo | None:
        """The camera's calibration, once heard."""
        return self._info

    @property
    def pose(self) -> tuple[int, Pose] | None:
        """The newest stamp and pose."""
        with self._lock:
            return self._history.latest

    def place_of_camera(self) -> Float | None:
        """T_base_camera (4, 4); None while it is not known.

        Raises:
            EnvironmentFailure: what TF says cannot be.
        """
        optical = self._info.header.frame_id if self._info is not None else ""
        return place_of_camera(self._source.tree, self._profile.frames.base, optical, self._profile.mount)

    def snapshot(self, after_ns: int = 0) -> Snapshot | None:
        """The newest colour with a depth and a pose of its time, stamped after ``after_ns``; None while there is none."""
        slop_ns = round(self._profile.sync.slop_s * NANO)
        with self._lock:
            if self._info is None or not self._depth:
                return None
            for stamp_ns in reversed(self._rgb):
                if stamp_ns <= after_ns:
                    return None
                nearest = min(self._depth, key=lambda other: abs(other - stamp_ns))
                pose = self._history.at(nearest)
                labels = self._labels.get(stamp_ns)
                if abs(nearest - stamp_ns) > slop_ns or pose is None or (self._profile.topics.labels and labels is None):
                    continue
                return Snapshot(stamp_ns, self._rgb[stamp_ns], self._depth[nearest], self._info, pose, labels)
        return None

    def offsets_s(self) -> tuple[float, ...]:
        """Stamp of colour less stamp of the nearest depth, of the images at hand [s]; for checks."""
        with self._lock:
            if not self._depth:
                return ()
            return tuple((rgb - min(self._depth, key=lambda other: abs(other - rgb))) / NANO for rgb in self._rgb)

    def _keeper(self, kept: OrderedDict[int, Picture] | OrderedDict[int, Image], index: int | None) -> Callable[[Picture], None]:
        def keep(image: Picture) -> None:
            with self._lock:
                if index is not None:
                    self._heard_s[index] = self._clock.now_s()
                    self._counts[index] += 1
                kept[image.header.stamp_ns] = image  # type: ignore[assignment]  # labels are never compressed
                while len(kept) > _KEPT:
                    kept.popitem(last=False)

        return keep

    def _calibrated(self, info: CameraInfo) -> None:
        self._info = info

    def _moved(self, stamp_ns: int, pose: Pose) -> None:
        with self._lock:
            self._heard_s[2] = self._clock.now_s()
            self._counts[2] += 1
            self._history.add(stamp_ns, pose)
