"""Messages within one process: for tests, and for a simulated robot under a simulated clock."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any

from spacevln.core.errors import EnvironmentFailure
from spacevln.environments.robot.messages import TriggerReply
from spacevln.environments.robot.transport import M, Qos, Topic


class LoopbackNetwork:
    """What the loopback transports of one process share. Delivery is immediate, in order, on the sender's thread."""

    def __init__(self) -> None:
        self.handlers: defaultdict[str, list[Callable[[Any], None]]] = defaultdict(list)
        self.writers: defaultdict[str, int] = defaultdict(int)
        self.services: dict[str, Callable[[], TriggerReply]] = {}
        self.latched: dict[str, Any] = {}


class LoopbackTransport:
    """Implements :class:`~spacevln.environments.robot.transport.Transport`."""

    def __init__(self, network: LoopbackNetwork) -> None:
        self._network, self._closed = network, False
        self._published: set[str] = set()
        self._subscribed: list[tuple[str, Callable[[Any], None]]] = []

    def publish(self, topic: Topic[M], message: M) -> None:
        """Hand a message to every handler."""
        if self._closed:
            raise EnvironmentFailure("The loopback transport is closed: open a new one.")
        if topic.name not in self._published:
            self._published.add(topic.name)
            self._network.writers[topic.name] += 1
        if topic.qos is Qos.LATCHED:
            self._network.latched[topic.name] = message
        for handler in tuple(self._network.handlers[topic.name]):
            handler(message)

    def subscribe(self, topic: Topic[M], handler: Callable[[M], None]) -> None:
        """Hear every message from now on, and the latched one."""
        self._subscribed.append((topic.name, handler))
        self._network.handlers[topic.name].append(handler)
        if topic.qos is Qos.LATCHED and topic.name in self._network.latched:
            handler(self._network.latched[topic.name])

    def serve_trigger(self, name: str, handler: Callable[[], TriggerReply]) -> None:
        """Offer a service."""
        self._network.services[name] = handler

    def call_trigger(self, name: str, timeout_s: float = 2.0) -> TriggerReply | None:
        """Ask a service; nobody there is a time-out."""
        del timeout_s
        handler = self._network.services.get(name)
        return None if handler is None else handler()

    def peers(self, topic: Topic[Any]) -> int:
        """Readers of a topic that is published here, else writers."""
        if topic.name in self._published:
            return len(self._network.handlers[topic.name])
        return self._network.writers[topic.name]

    def close(self) -> None:
        """Leave: nothing is heard or said any more."""
        if self._closed:
            return
        self._closed = True
        for name, handler in self._subscribed:
            self._network.handlers[name].remove(handler)
        for name in self._published:
            self._network.writers[name] -= 1
