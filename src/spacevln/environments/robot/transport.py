"""The one interface behind which messages travel, and the choice of what carries them."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Generic, Literal, Protocol, TypeVar

from spacevln.core.errors import PrerequisiteError
from spacevln.environments.robot.messages import Message, TriggerReply

M = TypeVar("M", bound=Message)
INSTALL = "pip install 'spacevln[robot]'"


def _elsewhere(module: str) -> str:
    """CycloneDDS has wheels for x86-64 only, so that the extra leaves it out on other machines."""
    return " on x86-64, or take --transport zenoh" if module == "cyclonedds" else ""


class Qos(StrEnum):
    """Quality of service of a topic, by the profiles that ROS 2 robots use."""

    SENSOR = "sensor"
    """Best effort, the last few: images, odometry."""
    RELIABLE = "reliable"
    """Reliable, the last ten: commands, transforms."""
    LATCHED = "latched"
    """Reliable and transient local, for late joiners: /tf_static."""


@dataclass(frozen=True, slots=True)
class Topic(Generic[M]):
    """A named stream of one type.

    Args:
        name: absolute, e.g. ``"/camera/color/image_raw"``.
        type: of its messages.
        qos: of writer and reader.
    """

    name: str
    type: type[M]
    qos: Qos = Qos.SENSOR


class Transport(Protocol):
    """Carries messages. Handlers run on a thread of the transport and must return at once."""

    def publish(self, topic: Topic[M], message: M) -> None:
        """Send one message; does not wait for readers.

        Raises:
            EnvironmentFailure: the transport is closed or broke.
        """

    def subscribe(self, topic: Topic[M], handler: Callable[[M], None]) -> None:
        """Call ``handler`` with every message from now on."""

    def serve_trigger(self, name: str, handler: Callable[[], TriggerReply]) -> None:
        """Offer a std_srvs/Trigger service."""

    def call_trigger(self, name: str, timeout_s: float = 2.0) -> TriggerReply | None:
        """Ask a std_srvs/Trigger service; None when no reply came in time."""

    def peers(self, topic: Topic[Any]) -> int:
        """How many readers (of a topic published here) or writers (of one subscribed here) are matched now."""

    def close(self) -> None:
        """Leave the network. May be called twice."""


TransportName = Literal["dds", "zenoh", "rclpy"]


def require(module: str) -> None:
    """Make sure that a module of the extra ``robot`` is there.

    Raises:
        PrerequisiteError: it is not.
    """
    if importlib.util.find_spec(module) is None:
        raise PrerequisiteError(
            f"The robot transport needs {module!r}, which is not installed: run {INSTALL}{_elsewhere(module)}."
        )


def open_transport(name: TransportName, *, domain: int = 0, distro: str = "jazzy", endpoint: str = "") -> Transport:
    """Join the network.

    Args:
        name: ``dds`` (CycloneDDS, any stock ROS 2), ``zenoh`` (a robot with rmw_zenoh), ``rclpy`` (a sourced ROS 2 here).
        domain: ROS_DOMAIN_ID.
        distro: of the robot; decides the type hash in Zenoh's keys.
        endpoint: for Zenoh the router or peer, e.g. ``"tcp/192.168.1.7:7447"``; for DDS the addresses of peers where multicast
            is not wanted, e.g. ``"127.0.0.1"``; empty for discovery.

    Raises:
        PrerequisiteError: what it needs is not installed.
    """
    match name:
        case "dds":
            require("cyclonedds")
            require("rosbags")
            from spacevln.environments.robot.transports.dds import DdsTransport

            return DdsTransport(domain, peers=endpoint)
        case "zenoh":
            require("zenoh")
            require("rosbags")
            from spacevln.environments.robot.transports.zenoh import ZenohTransport

            return ZenohTransport(domain, distro=distro, endpoint=endpoint)
        case "rclpy":
            if importlib.util.find_spec("rclpy") is None:
                raise PrerequisiteError(
                    "The transport 'rclpy' needs ROS 2 in this shell: source /opt/ros/DISTRO/setup.bash, or use --transport dds."
                )
            from spacevln.environments.robot.transports.ros import RclpyTransport

            return RclpyTransport(domain)
