"""CycloneDDS in pure Python: talks to any stock ROS 2 robot (rmw_fastrtps or rmw_cyclonedds) without a ROS installation here.

A topic ``/x`` is the DDS topic ``rt/x``; the bytes are those of :mod:`..wire`, the type descriptions are built from the same
definitions. Services follow rmw_cyclonedds (a 16-byte header before the payload); rmw_fastrtps keeps the header elsewhere,
where this binding cannot write it.
"""

from __future__ import annotations

import struct
import threading
import time
from collections.abc import Callable
from functools import cache
from typing import Any
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException, GuardCondition, InstanceState, Policy, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.idl.annotations import final
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Qos as DdsQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic as DdsTopic
from cyclonedds.util import duration
from rosbags.interfaces import Nodetype

from spacevln.core.errors import EnvironmentFailure
from spacevln.environments.robot import wire
from spacevln.environments.robot.messages import TYPE_NAMES, TriggerReply
from spacevln.environments.robot.transport import M, Qos, Topic

_HEADER = struct.Struct("<Qq")  # rmw_cyclonedds: client guid, sequence number
_CDR_LE = b"\0\1\0\0"
_PRIMITIVES: dict[str, Any] = {
    "bool": bool,
    "int8": types.int8,
    "uint8": types.uint8,
    "int16": types.int16,
    "uint16": types.uint16,
    "int32": types.int32,
    "uint32": types.uint32,
    "int64": types.int64,
    "uint64": types.uint64,
    "float32": types.float32,
    "float64": types.float64,
    "string": str,
}


_REPRESENTATION = Policy.DataRepresentation(use_cdrv0_representation=True)
_WAIT = duration(seconds=10)
_QOS = {
    Qos.SENSOR: DdsQos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5), _REPRESENTATION),
    Qos.RELIABLE: DdsQos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(10), _REPRESENTATION),
    Qos.LATCHED: DdsQos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.TransientLocal,
        Policy.History.KeepLast(10),
        _REPRESENTATION,
    ),
}


@cache
def idl_type(ros_name: str, *, is_service: bool = False) -> Any:
    """The DDS description of a ROS 2 type, nested ones included; it can also serialise by itself.

    Args:
        ros_name: e.g. ``"sensor_msgs/msg/Image"``.
        is_service: begins with rmw_cyclonedds' request header.
    """
    fields = {name: _idl_field(node) for name, node in wire.typestore().fielddefs[ros_name][1]}
    header = {"guid": types.uint64, "seq": types.int64} if is_service else {}
    return final(make_idl_struct(ros_name.rpartition("/")[2] + "_", wire.dds_name(ros_name), header | fields))


def _idl_field(node: Any) -> Any:
    kind, detail = node
    match kind:
        case Nodetype.BASE:
            return _PRIMITIVES[detail[0]]
        case Nodetype.NAME:
            return idl_type(detail)
        case Nodetype.ARRAY:
            return types.array[_idl_field(detail[0]), detail[1]]
        case _:
            return types.sequence[_idl_field(detail[0])]


@cache
def _carrier(ros_name: str, *, is_service: bool = False) -> Any:
    """A type described as ``idl_type`` that puts bytes on the wire and takes them off it as they are.

    Python's own CDR packs byte by byte, 50 times slower for an image.
    """
    described = idl_type(ros_name, is_service=is_service)
    carrier: Any = final(make_idl_struct(described.__name__, wire.dds_name(ros_name), dict(described.__annotations__)))

    def deserialize(data: bytes, *_: Any, **__: Any) -> Any:
        sample = carrier.__new__(carrier)
        sample.raw = data
        return sample

    carrier.serialize = lambda sample, *_, **__: sample.raw
    carrier.deserialize = staticmethod(deserialize)
    return carrier


@cache
def _domain(domain: int, peers: str) -> Domain:
    """The settings of a DDS domain in this process: unicast to given peers, or what CYCLONEDDS_URI and discovery say."""
    addresses = [address.strip() for address in peers.split(",")]
    local = all(address.startswith("127.") for address in addresses)
    interface = '<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>' if local else ""
    listed = "".join(f"<Peer Address={quoteattr(address)}/>" for address in addresses)
    return Domain(
        domain,
        f"<CycloneDDS><Domain><General>{interface}<AllowMulticast>false</AllowMulticast></General>"
        f"<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>40</MaxAutoParticipantIndex>"
        f"<Peers>{listed}</Peers></Discovery></Domain></CycloneDDS>",
    )


class DdsTransport:
    """Implements :class:`~spacevln.environments.robot.transport.Transport`.

    Args:
        domain: ROS_DOMAIN_ID.
        peers: comma-separated addresses for networks without multicast; empty for discovery.
    """

    def __init__(self, domain: int = 0, *, peers: str = "") -> None:
        if peers:
            _domain(domain, peers)
        self._participant = DomainParticipant(domain)
        self._topics: dict[str, DdsTopic[Any]] = {}
        self._writers: dict[str, DataWriter[Any]] = {}
        self._readers: dict[str, DataReader[Any]] = {}
        self._handlers: list[tuple[DataReader[Any], Callable[[bytes], None]]] = []
        self._conditions: list[ReadCondition] = []
        self._wake, self._waitset = GuardCondition(self._participant), WaitSet(self._participant)
        self._waitset.attach(self._wake)
        self._lock = threading.Lock()
        self._closed = False
        self._thread = threading.Thread(target=self._listen, name="dds", daemon=True)
        self._thread.start()

    def publish(self, topic: Topic[M], message: M) -> None:
        """Send one message."""
        self._write("rt" + topic.name, TYPE_NAMES[topic.type], _QOS[topic.qos], wire.encode(message))

    def subscribe(self, topic: Topic[M], handler: Callable[[M], None]) -> None:
        """Hear a topic."""
        self._read(
            "rt" + topic.name,
            _carrier(TYPE_NAMES[topic.type]),
            _QOS[topic.qos],
            lambda data: handler(wire.decode(data, topic.type)),
        )

    def serve_trigger(self, name: str, handler: Callable[[], TriggerReply]) -> None:
        """Offer a service to clients on rmw_cyclonedds and to our own."""
        reply_type = _carrier(wire.TRIGGER_RESPONSE, is_service=True)
        reply_to = f"rr{name}Reply"
        self._writer(reply_to, reply_type, _QOS[Qos.RELIABLE])

        def answer(data: bytes) -> None:
            payload = wire.encode_trigger_reply(handler())
            self._write(reply_to, reply_type, _QOS[Qos.RELIABLE], _CDR_LE + data[4 : 4 + _HEADER.size] + payload[4:])

        self._read(f"rq{name}Request", _carrier(wire.TRIGGER_REQUEST, is_service=True), _QOS[Qos.RELIABLE], answer)

    def call_trigger(self, name: str, timeout_s: float = 2.0) -> TriggerReply | None:
        """Ask a service."""
        replies: dict[bytes, TriggerReply] = {}
        came = threading.Event()
        header = _HEADER.pack(self._participant.instance_handle & (2**64 - 1), time.monotonic_ns())

        def take(data: bytes) -> None:
            replies[data[4 : 4 + _HEADER.size]] = wire.decode_trigger_reply(_CDR_LE + data[4 + _HEADER.size :])
            if header in replies:
                came.set()

        reader = self._read(f"rr{name}Reply", _carrier(wire.TRIGGER_RESPONSE, is_service=True), _QOS[Qos.RELIABLE], take)
        request = _carrier(wire.TRIGGER_REQUEST, is_service=True)
        writer = self._writer(f"rq{name}Request", request, _QOS[Qos.RELIABLE])
        end = time.monotonic() + timeout_s
        while not (writer.get_matched_subscriptions() and reader.get_matched_publications()):
            if time.monotonic() > end:
                return None
            time.sleep(0.01)
        self._write(f"rq{name}Request", request, _QOS[Qos.RELIABLE], _CDR_LE + header + wire.encode_trigger_request()[4:])
        came.wait(max(0.0, end - time.monotonic()))
        return replies.get(header)

    def peers(self, topic: Topic[Any]) -> int:
        """Matched readers of a topic published here, else matched writers."""
        name = "rt" + topic.name
        if name in self._writers:
            return len(self._writers[name].get_matched_subscriptions())
        return len(self._readers[name].get_matched_publications()) if name in self._readers else 0

    def close(self) -> None:
        """Leave the domain."""
        if self._closed:
            return
        self._closed = True
        self._wake.set(True)
        if threading.current_thread() is not self._thread:
            self._thread.join()
        with self._lock:
            self._handlers.clear()
            self._writers.clear()
            self._readers.clear()
            self._topics.clear()

    def _topic(self, name: str, carrier: Any, qos: DdsQos) -> DdsTopic[Any]:
        if name not in self._topics:
            self._topics[name] = DdsTopic(self._participant, name, carrier, qos)
        return self._topics[name]

    def _writer(self, name: str, carrier: Any, qos: DdsQos) -> DataWriter[Any]:
        with self._lock:
            if name not in self._writers:
                self._writers[name] = DataWriter(self._participant, self._topic(name, carrier, qos), qos)
            return self._writers[name]

    def _write(self, name: str, carrier: Any, qos: DdsQos, data: bytes) -> None:
        if self._closed:
            raise EnvironmentFailure(f"The DDS transport is closed, and {name!r} cannot be written: open a new one.")
        kind = _carrier(carrier) if isinstance(carrier, str) else carrier
        writer = self._writer(name, kind, qos)
        try:
            writer.write(kind.deserialize(data))
        except DDSException as error:
            if error.code != DDSException.DDS_RETCODE_TIMEOUT:  # a reader is behind: this message is lost, as QoS allows
                raise EnvironmentFailure(f"DDS could not write {name!r} ({error}): check the network.") from error

    def _read(self, name: str, carrier: Any, qos: DdsQos, handler: Callable[[bytes], None]) -> DataReader[Any]:
        with self._lock:
            reader = self._readers.get(name)
            if reader is None:
                reader = self._readers[name] = DataReader(self._participant, self._topic(name, carrier, qos), qos)
                condition = ReadCondition(reader, SampleState.NotRead | ViewState.Any | InstanceState.Any)
                self._conditions.append(condition)
                self._waitset.attach(condition)
            self._handlers.append((reader, handler))
        self._wake.set(True)
        return reader

    def _listen(self) -> None:
        while not self._closed:
            self._waitset.wait(_WAIT)
            self._wake.set(False)
            with self._lock:
                handlers = list(self._handlers)
            for reader in dict.fromkeys(reader for reader, _ in handlers):
                for sample in reader.take(64):
                    if not isinstance(sample, InvalidSample):
                        for owner, handler in handlers:
                            if owner is reader:
                                handler(sample.raw)
