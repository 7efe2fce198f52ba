"""A stand-in for rclpy: the calls that the transport makes, with their documented names, and messages as strict as its own.

No ROS 2 can be installed here. What rclpy's generated classes refuse is refused here too: unknown fields, numpy arrays in fields
of variable length, plain lists in numeric fields of fixed length, numbers of the wrong kind. Delivery is on the executor's
thread.
"""

from __future__ import annotations

import array
import enum
import queue
import sys
import threading
import types
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype

from spacevln.environments.robot import wire
from spacevln.environments.robot.messages import TYPE_NAMES

TRIGGER_PARTS = {"Request": {}, "Response": {"success": bool, "message": str}}


class ExternalShutdownException(Exception):  # noqa: N818 - its name there
    pass


class ReliabilityPolicy(enum.Enum):
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(enum.Enum):
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class HistoryPolicy(enum.Enum):
    KEEP_LAST = 1


@dataclass(frozen=True)
class QoSProfile:
    reliability: ReliabilityPolicy
    durability: DurabilityPolicy
    history: HistoryPolicy
    depth: int

    def heard_by(self, reader: QoSProfile) -> bool:
        """Request against offer, as DDS matches them."""
        wants_more = reader.reliability is ReliabilityPolicy.RELIABLE and self.reliability is ReliabilityPolicy.BEST_EFFORT
        late = reader.durability is DurabilityPolicy.TRANSIENT_LOCAL and self.durability is DurabilityPolicy.VOLATILE
        return not (wants_more or late)


@dataclass(eq=False)
class Context:
    domain: int = -1
    nodes: list[Node] = field(default_factory=list)


CONTEXTS: list[Context] = []


def _nodes(domain: int) -> list[Node]:
    return [node for context in CONTEXTS if context.domain == domain for node in context.nodes]


@dataclass(eq=False)
class Publisher:
    node: Node
    kind: type
    name: str
    qos: QoSProfile
    kept: list[Any] = field(default_factory=list)

    def publish(self, message: Any) -> None:
        if not isinstance(message, self.kind):
            raise TypeError(f"{self.name} takes {self.kind.__name__}")
        self.kept = [*self.kept, message][-self.qos.depth :]
        for reader in self._readers():
            reader.node.jobs.put(lambda reader=reader: reader.callback(message))

    def get_subscription_count(self) -> int:
        return len(self._readers())

    def _readers(self) -> list[Subscription]:
        every = [reader for node in _nodes(self.node.context.domain) for reader in node.subscriptions]
        return [reader for reader in every if reader.name == self.name and self.qos.heard_by(reader.qos)]


@dataclass(eq=False)
class Subscription:
    node: Node
    kind: type
    name: str
    callback: Callable[[Any], None]
    qos: QoSProfile


class Future:
    def __init__(self) -> None:
        self._done, self._result, self._calls = False, None, list[Callable[[Future], None]]()

    def set_result(self, result: Any) -> None:
        self._done, self._result = True, result
        for call in self._calls:
            call(self)

    def add_done_callback(self, call: Callable[[Future], None]) -> None:
        if self._done:
            call(self)
        else:
            self._calls.append(call)

    def result(self) -> Any:
        return self._result


@dataclass(eq=False)
class Client:
    node: Node
    kind: Any
    name: str

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        del timeout_sec
        return self._server() is not None

    def call_async(self, request: Any) -> Future:
        future, server = Future(), self._server()
        assert server is not None
        node, handler = server

        def serve() -> None:
            response = handler(request, self.kind.Response())
            self.node.jobs.put(lambda: future.set_result(response))  # the client's executor must be spinning

        node.jobs.put(serve)
        return future

    def _server(self) -> tuple[Node, Callable[[Any, Any], Any]] | None:
        for node in _nodes(self.node.context.domain):
            if self.name in node.services:
                return node, node.services[self.name]
        return None


@dataclass(eq=False)
class Node:
    name: str
    context: Context
    jobs: queue.SimpleQueue[Callable[[], None] | None] = field(default_factory=queue.SimpleQueue)
    subscriptions: list[Subscription] = field(default_factory=list)
    publishers: list[Publisher] = field(default_factory=list)
    services: dict[str, Callable[[Any, Any], Any]] = field(default_factory=dict)

    def create_publisher(self, kind: type, name: str, qos: QoSProfile) -> Publisher:
        self.publishers.append(Publisher(self, kind, name, qos))
        return self.publishers[-1]

    def create_subscription(self, kind: type, name: str, callback: Callable[[Any], None], qos: QoSProfile) -> Subscription:
        reader = Subscription(self, kind, name, callback, qos)
        self.subscriptions.append(reader)
        if qos.durability is DurabilityPolicy.TRANSIENT_LOCAL:
            for node in _nodes(self.context.domain):
                for publisher in node.publishers:
                    if publisher.name == name and publisher.qos.heard_by(qos):
                        for message in publisher.kept:
                            self.jobs.put(lambda message=message: callback(message))
        return reader

    def create_service(self, kind: Any, name: str, handler: Callable[[Any, Any], Any]) -> None:
        del kind
        self.services[name] = handler

    def create_client(self, kind: Any, name: str) -> Client:
        return Client(self, kind, name)

    def count_publishers(self, name: str) -> int:
        return sum(publisher.name == name for node in _nodes(self.context.domain) for publisher in node.publishers)


class SingleThreadedExecutor:
    def __init__(self, *, context: Context) -> None:
        del context
        self._node: Node | None = None
        self._ended = threading.Event()

    def add_node(self, node: Node) -> None:
        self._node = node

    def spin(self) -> None:
        assert self._node is not None
        while not self._ended.is_set():
            job = self._node.jobs.get()
            if job is None:
                raise ExternalShutdownException
            job()

    def shutdown(self) -> None:
        self._ended.set()


def init(*, context: Context, domain_id: int) -> None:
    context.domain = domain_id
    CONTEXTS.append(context)


def create_node(name: str, *, context: Context) -> Node:
    node = Node(name, context)
    context.nodes.append(node)
    return node


def shutdown(*, context: Context) -> None:
    CONTEXTS.remove(context)
    for node in context.nodes:
        node.jobs.put(None)


def message_class(ros_name: str) -> type:
    """A class as strict as rosidl_generator_py's."""
    fields = dict(wire.typestore().fielddefs[ros_name][1])

    def begin(self: Any, **given: Any) -> None:
        unknown = set(given) - set(fields)
        assert not unknown, f"{ros_name} has no {unknown}"
        for name, value in given.items():
            _check(fields[name], value, f"{ros_name}.{name}")
            setattr(self, name, value)

    return type(ros_name.rpartition("/")[2], (), {"__init__": begin, "__slots__": tuple(fields)})


def _check(node: Any, value: Any, where: str) -> None:
    kind, about = node
    if kind is Nodetype.ARRAY:
        assert isinstance(value, np.ndarray), f"{where} is of fixed length: numpy"
        assert value.shape == (about[1],), where
    elif kind is Nodetype.SEQUENCE:
        assert isinstance(value, array.array | list | tuple), f"{where} is of variable length: array.array or a sequence"
    elif kind is Nodetype.BASE:
        wanted = {"bool": bool, "string": str}.get(about[0], float if about[0].startswith("float") else int)
        assert isinstance(value, wanted), f"{where} must be {wanted.__name__}, is {type(value).__name__}"


def install(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put it where the transport imports it from."""
    here = {name: value for name, value in globals().items() if not name.startswith("_")}
    for name in ("rclpy", "rclpy.context", "rclpy.executors", "rclpy.qos"):
        module = types.ModuleType(name)
        module.__dict__.update(here)
        monkeypatch.setitem(sys.modules, name, module)
    made: dict[str, dict[str, Any]] = {"std_srvs.srv": {"Trigger": _trigger()}}
    nested = ("builtin_interfaces/msg/Time", "std_msgs/msg/Header", "nav_msgs/msg/Odometry")
    names = {name for name in wire.typestore().fielddefs if name.split("/")[0] in ("geometry_msgs", "sensor_msgs")}
    for name in sorted({*names, *TYPE_NAMES.values(), *nested}):
        package, part, kind = name.split("/")
        made.setdefault(f"{package}.{part}", {})[kind] = message_class(name)
    for name, classes in made.items():
        module = types.ModuleType(name)
        module.__dict__.update(classes)
        monkeypatch.setitem(sys.modules, name.partition(".")[0], types.ModuleType(name.partition(".")[0]))
        monkeypatch.setitem(sys.modules, name, module)


def _trigger() -> type:
    response = message_class(wire.TRIGGER_RESPONSE)
    return type("Trigger", (), {"Request": type("Request", (), {}), "Response": response})
