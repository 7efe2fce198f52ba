"""Zenoh, for robots that run rmw_zenoh: keys, attachments and type hashes as that middleware spells them."""

from __future__ import annotations

import itertools
import json
import struct
import threading
import time
import uuid
from collections.abc import Callable
from typing import Any

import zenoh
import zenoh.ext

from spacevln.core.errors import EnvironmentFailure
from spacevln.environments.robot import wire
from spacevln.environments.robot.messages import TYPE_NAMES, TriggerReply
from spacevln.environments.robot.transport import M, Qos, Topic

_ATTACHMENT = struct.Struct("<qqB16s")  # sequence number, source time [ns], length of the id, id of the writer
_NO_HASH = "TypeHashNotSupported"  # what rmw_zenoh of Humble writes where later ones write a hash
_LISTEN = "listen/"


def key_expression(domain: int, name: str, ros_name: str, hashed: str) -> str:
    """rmw_zenoh's key of a topic or service."""
    return f"{domain}/{name.strip('/')}/{wire.dds_name(ros_name)}/{hashed}"


def _configuration(endpoint: str) -> zenoh.Config:
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps("peer"))
    config.insert_json5("timestamping/enabled", "true")  # what late joiners of latched topics are served by
    if endpoint:
        side, address = ("listen", endpoint.removeprefix(_LISTEN)) if endpoint.startswith(_LISTEN) else ("connect", endpoint)
        config.insert_json5(f"{side}/endpoints", json.dumps([address]))
        config.insert_json5("scouting/multicast/enabled", "false")
    if not endpoint.startswith(_LISTEN):
        config.insert_json5("listen/endpoints", json.dumps(["tcp/127.0.0.1:0"]))
    return config


class ZenohTransport:
    """Implements :class:`~spacevln.environments.robot.transport.Transport`.

    Args:
        domain: ROS_DOMAIN_ID.
        distro: of the robot; ``"humble"`` writes no type hash.
        endpoint: router or peer, e.g. ``"tcp/192.168.1.7:7447"``; ``"listen/tcp/..."`` to be the one that is connected to; empty
            for discovery.
    """

    def __init__(self, domain: int = 0, *, distro: str = "jazzy", endpoint: str = "") -> None:
        self._domain, self._distro = domain, distro
        try:
            self._session: zenoh.Session | None = zenoh.open(_configuration(endpoint))
        except zenoh.ZError as error:
            raise EnvironmentFailure(
                f"Zenoh cannot reach {endpoint or 'the network'} ({error}): start the router or peer, or give --endpoint."
            ) from error
        self._id, self._sequence = uuid.uuid4().bytes, itertools.count(1)
        self._publishers: dict[str, Any] = {}
        self._declared: list[Any] = []
        self._sources: dict[str, set[str]] = {}
        self._lock = threading.Lock()

    def publish(self, topic: Topic[M], message: M) -> None:
        """Send one message."""
        try:
            self._publisher(topic).put(wire.encode(message), attachment=self._attachment())
        except zenoh.ZError as error:
            raise EnvironmentFailure(f"Zenoh could not write {topic.name!r} ({error}): check the network.") from error

    def subscribe(self, topic: Topic[M], handler: Callable[[M], None]) -> None:
        """Hear a topic, whatever hash its writer spells."""
        key = key_expression(self._domain, topic.name, TYPE_NAMES[topic.type], "*")
        seen = self._sources.setdefault(topic.name, set())

        def take(sample: zenoh.Sample) -> None:
            attachment = sample.attachment
            seen.add("" if attachment is None else attachment.to_bytes()[17:].hex())
            handler(wire.decode(sample.payload.to_bytes(), topic.type))

        session = self._open(topic.name)
        if topic.qos is Qos.LATCHED:
            history = zenoh.ext.HistoryConfig(detect_late_publishers=True)
            self._declared.append(zenoh.ext.declare_advanced_subscriber(session, key, take, history=history))
        else:
            self._declared.append(session.declare_subscriber(key, take))

    def serve_trigger(self, name: str, handler: Callable[[], TriggerReply]) -> None:
        """Offer a service."""

        def answer(query: zenoh.Query) -> None:
            with query:
                reply = wire.encode_trigger_reply(handler())
                query.reply(query.key_expr, reply, attachment=query.attachment or self._attachment())

        key = key_expression(self._domain, name, wire.TRIGGER, "*")
        self._declared.append(self._open(name).declare_queryable(key, answer, complete=True))

    def call_trigger(self, name: str, timeout_s: float = 2.0) -> TriggerReply | None:
        """Ask a service."""
        key, end = key_expression(self._domain, name, wire.TRIGGER, "*"), time.monotonic() + timeout_s
        while (left := end - time.monotonic()) > 0:
            replies = self._open(name).get(
                key, payload=wire.encode_trigger_request(), attachment=self._attachment(), timeout=left
            )
            for reply in replies:
                if reply.ok is not None:
                    return wire.decode_trigger_reply(reply.ok.payload.to_bytes())
            time.sleep(0.02)  # nobody offers it yet
        return None

    def peers(self, topic: Topic[Any]) -> int:
        """1 where a topic published here has readers; else the writers heard so far."""
        publisher = self._publishers.get(topic.name)
        if publisher is not None:
            return int(publisher.matching_status.matching)
        return len(self._sources.get(topic.name, ()))

    def close(self) -> None:
        """Leave the network."""
        session, self._session = self._session, None
        if session is not None:
            session.close()

    def _open(self, name: str) -> zenoh.Session:
        if self._session is None:
            raise EnvironmentFailure(f"The Zenoh transport is closed, and {name!r} cannot be used: open a new one.")
        return self._session

    def _publisher(self, topic: Topic[Any]) -> Any:
        session = self._open(topic.name)
        with self._lock:
            if topic.name not in self._publishers:
                ros_name = TYPE_NAMES[topic.type]
                hashed = _NO_HASH if self._distro == "humble" else wire.type_hash(ros_name)
                key = key_expression(self._domain, topic.name, ros_name, hashed)
                if topic.qos is Qos.LATCHED:
                    cache = zenoh.ext.CacheConfig(max_samples=10)
                    publisher = zenoh.ext.declare_advanced_publisher(session, key, cache=cache, publisher_detection=True)
                else:
                    publisher = session.declare_publisher(key)
                self._publishers[topic.name] = publisher
            return self._publishers[topic.name]

    def _attachment(self) -> bytes:
        return _ATTACHMENT.pack(next(self._sequence), time.time_ns(), len(self._id), self._id)
