"""rclpy, where a ROS 2 is sourced: the middleware, its QoS and its services are then the robot's own."""

from __future__ import annotations

import array
import importlib
import threading
import time
from collections.abc import Callable
from typing import Any, cast

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from spacevln.core.errors import EnvironmentFailure
from spacevln.environments.robot.fields import from_ros, to_ros
from spacevln.environments.robot.messages import TYPE_NAMES, TriggerReply
from spacevln.environments.robot.transport import M, Qos, Topic

_QOS = {
    Qos.SENSOR: (ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE, 5),
    Qos.RELIABLE: (ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE, 10),
    Qos.LATCHED: (ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL, 10),
}
_SEQUENCES = {"data": "B", "d": "d"}
"""Numeric fields of variable length, of the types used here, and their type codes."""


def _class(ros_name: str) -> Any:
    package, kind, name = ros_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


def _make(ros_name: str, /, **fields: Any) -> Any:
    return _class(ros_name)(**{name: _taken(name, value) for name, value in fields.items()})


def _taken(name: str, value: Any) -> Any:
    """Generated classes take numpy arrays in fields of fixed length only."""
    return array.array(_SEQUENCES[name], value.tobytes()) if name in _SEQUENCES else value


def _profile(qos: Qos) -> QoSProfile:
    reliability, durability, depth = _QOS[qos]
    return QoSProfile(reliability=reliability, durability=durability, history=HistoryPolicy.KEEP_LAST, depth=depth)


class RclpyTransport:
    """Implements :class:`~spacevln.environments.robot.transport.Transport` by a node of its own."""

    def __init__(self, domain: int = 0) -> None:
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = rclpy.create_node("spacevln", context=self._context)
        self._publishers: dict[str, Any] = {}
        self._closed = False
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._spin, name="rclpy", daemon=True)
        self._thread.start()

    def publish(self, topic: Topic[M], message: M) -> None:
        """Send one message."""
        if self._closed:
            raise EnvironmentFailure(f"The rclpy transport is closed, and {topic.name!r} cannot be written: open a new one.")
        if topic.name not in self._publishers:
            kind = _class(TYPE_NAMES[topic.type])
            self._publishers[topic.name] = self._node.create_publisher(kind, topic.name, _profile(topic.qos))
        self._publishers[topic.name].publish(to_ros(message, _make))

    def subscribe(self, topic: Topic[M], handler: Callable[[M], None]) -> None:
        """Hear a topic."""
        kind = _class(TYPE_NAMES[topic.type])
        self._node.create_subscription(
            kind, topic.name, lambda found: handler(cast(M, from_ros(found, topic.type))), _profile(topic.qos)
        )

    def serve_trigger(self, name: str, handler: Callable[[], TriggerReply]) -> None:
        """Offer a service."""

        def answer(_: Any, response: Any) -> Any:
            reply = handler()
            response.success, response.message = reply.success, reply.message
            return response

        self._node.create_service(_class("std_srvs/srv/Trigger"), name, answer)

    def call_trigger(self, name: str, timeout_s: float = 2.0) -> TriggerReply | None:
        """Ask a service."""
        end = time.monotonic() + timeout_s
        kind = _class("std_srvs/srv/Trigger")
        client = self._node.create_client(kind, name)
        if not client.wait_for_service(timeout_sec=timeout_s):
            return None
        done = threading.Event()
        future = client.call_async(kind.Request())
        future.add_done_callback(lambda _: done.set())
        if not done.wait(max(0.0, end - time.monotonic())):
            return None
        return TriggerReply(bool(future.result().success), str(future.result().message))

    def peers(self, topic: Topic[Any]) -> int:
        """Matched readers of a topic published here, else writers."""
        if topic.name in self._publishers:
            return int(self._publishers[topic.name].get_subscription_count())
        return int(self._node.count_publishers(topic.name))

    def close(self) -> None:
        """Leave."""
        if self._closed:
            return
        self._closed = True
        self._executor.shutdown()
        rclpy.shutdown(context=self._context)
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            return  # close() shut the context down
