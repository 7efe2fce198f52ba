"""ROS 2 bags (MCAP or SQLite): their messages go through the same streams as a live robot's."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from spacevln.core.errors import RecordError
from spacevln.core.geometry import Pose
from spacevln.core.sensing import Observation
from spacevln.environments.robot.clock import SystemClock
from spacevln.environments.robot.messages import TYPE_NAMES, CameraInfo, Odometry, TFMessage
from spacevln.environments.robot.observer import Observer, flat
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Streams, picture_topic
from spacevln.environments.robot.transport import Qos, Topic, require
from spacevln.environments.robot.transports.loopback import LoopbackNetwork, LoopbackTransport


def read_bag(path: Path, profile: RobotProfile) -> Iterator[tuple[int, Observation]]:
    """Stamp [ns] and observation of every synchronised set, in the frame of the first one.

    Args:
        path: an ``.mcap`` file, or a bag's directory.
        profile: names of its topics and frames.

    Raises:
        PrerequisiteError: rosbags is not installed.
        RecordError: it is no bag, or has none of the profile's topics.
        EnvironmentFailure: an image cannot be understood.
    """
    require("rosbags")
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.rosbag2 import ReaderError

    from spacevln.environments.robot import wire

    wanted = {topic.name: topic for topic in _topics(profile)}
    player = LoopbackTransport(network := LoopbackNetwork())
    streams = Streams(LoopbackTransport(network), profile, SystemClock())
    try:
        with AnyReader([path], default_typestore=wire.typestore()) as reader:
            chosen = [each for each in reader.connections if each.topic in wanted]
            if not chosen:
                raise RecordError(f"The bag {str(path)!r} has none of the profile's topics: {', '.join(sorted(wanted))}.")
            observer: Observer | None = None
            origin: Pose | None = None
            last_ns = 0
            for connection, _, raw in reader.messages(connections=chosen):
                topic = wanted[connection.topic]
                if connection.msgtype != TYPE_NAMES[topic.type]:
                    raise RecordError(f"{topic.name!r} of the bag is {connection.msgtype}, needed is {TYPE_NAMES[topic.type]}.")
                player.publish(topic, wire.decode(raw, topic.type, reader.typestore))
                snapshot, place = streams.snapshot(last_ns), streams.place_of_camera()
                if snapshot is None or place is None:
                    continue
                observer = observer or Observer(profile, snapshot.info, place)
                origin = origin or flat(snapshot.pose)
                last_ns = snapshot.stamp_ns
                yield last_ns, observer.observation(snapshot, origin)
    except (AnyReaderError, ReaderError, FileNotFoundError) as error:
        raise RecordError(f"{str(path)!r} is no ROS 2 bag that can be read ({error}).") from error


def _topics(profile: RobotProfile) -> tuple[Topic[Any], ...]:
    topics = profile.topics
    named = [picture_topic(topics.rgb), picture_topic(topics.depth), Topic(topics.camera_info, CameraInfo)]
    if topics.odometry:
        named.append(Topic(topics.odometry, Odometry))
    return (*named, Topic(topics.tf, TFMessage, Qos.RELIABLE), Topic(topics.tf_static, TFMessage, Qos.LATCHED))
