"""Messages as bytes: CDR little-endian by the rosbags type store, names and type hashes as ROS 2 middlewares spell them."""

from __future__ import annotations

from functools import cache
from typing import Any, cast

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from spacevln.environments.robot.fields import from_ros, to_ros
from spacevln.environments.robot.messages import TYPE_NAMES, Message, TriggerReply
from spacevln.environments.robot.transport import M

TRIGGER = "std_srvs/srv/Trigger"
TRIGGER_REQUEST, TRIGGER_RESPONSE = "std_srvs/srv/Trigger_Request", "std_srvs/srv/Trigger_Response"


@cache
def typestore() -> Typestore:
    """The definitions of Humble, which for every type used here are those of Jazzy and later too."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    byte, flag, text = ((Nodetype.BASE, (kind, 0)) for kind in ("uint8", "bool", "string"))
    # an empty request has one unused byte in every ROS 2 middleware
    store.register({TRIGGER_REQUEST: ([], [("structure_needs_at_least_one_member", byte)])})
    store.register({TRIGGER_RESPONSE: ([], [("success", flag), ("message", text)])})
    return store


def dds_name(ros_name: str) -> str:
    """The DDS spelling of a type: ``"sensor_msgs/msg/Image"`` is ``"sensor_msgs::msg::dds_::Image_"``."""
    package, kind, name = ros_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def type_hash(ros_name: str) -> str:
    """The RIHS01 hash of a type, as rmw_zenoh of Jazzy and later writes it into keys."""
    return str(typestore().hash_rihs01(ros_name))


def make(ros_name: str, /, **fields: Any) -> Any:
    """An object of the type store."""
    return typestore().types[ros_name](**fields)


def encode(message: Message) -> bytes:
    """A message as CDR, encapsulation header included."""
    return bytes(typestore().serialize_cdr(to_ros(message, make), TYPE_NAMES[type(message)]))


def decode(data: bytes | memoryview, kind: type[M], store: Typestore | None = None) -> M:
    """A message from its CDR.

    Args:
        data: with the encapsulation header.
        kind: of the message.
        store: definitions of a bag, where they may differ.
    """
    return cast(M, from_ros((store or typestore()).deserialize_cdr(data, TYPE_NAMES[kind]), kind))


def encode_trigger_reply(reply: TriggerReply) -> bytes:
    """A std_srvs/Trigger response as CDR."""
    response = make(TRIGGER_RESPONSE, success=reply.success, message=reply.message)
    return bytes(typestore().serialize_cdr(response, TRIGGER_RESPONSE))


def decode_trigger_reply(data: bytes) -> TriggerReply:
    """A std_srvs/Trigger response from its CDR."""
    found: Any = typestore().deserialize_cdr(data, TRIGGER_RESPONSE)
    return TriggerReply(bool(found.success), str(found.message))


def encode_trigger_request() -> bytes:
    """A std_srvs/Trigger request as CDR."""
    request = make(TRIGGER_REQUEST, structure_needs_at_least_one_member=0)
    return bytes(typestore().serialize_cdr(request, TRIGGER_REQUEST))
