"""What goes over the socket between a client and a detector server: JSON frames, masks as bits, images by shared memory.

Nothing is pickled. Images lie in memory that the client owns and hands over as a file descriptor, so that nothing has a name that
could be left behind; the socket lies in a folder that only its user can enter.
"""

from __future__ import annotations

import array
import json
import socket
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Detection

_SIZES = struct.Struct("<II")
MAX_FRAME_BYTES = 1 << 28


def send(connection: socket.socket, header: Mapping[str, Any], body: bytes = b"", descriptor: int | None = None) -> None:
    """One frame, with a file descriptor beside it where one is given."""
    text = json.dumps(header).encode()
    lead = _SIZES.pack(len(text), len(body))
    if descriptor is None:
        connection.sendall(lead)
    else:
        socket.send_fds(connection, [lead], [descriptor])
    connection.sendall(text)
    if body:
        connection.sendall(body)


def receive(connection: socket.socket) -> tuple[dict[str, Any], bytes, int | None]:
    """The next frame and the file descriptor beside it.

    Raises:
        ConnectionError: the other side is gone, or sends something else.
    """
    lead, ancillary, _, _ = connection.recvmsg(_SIZES.size, socket.CMSG_SPACE(array.array("i").itemsize))
    descriptors = array.array("i")
    for level, kind, data in ancillary:
        if level == socket.SOL_SOCKET and kind == socket.SCM_RIGHTS:
            descriptors.frombytes(data[: len(data) - len(data) % descriptors.itemsize])
    lead += _exactly(connection, _SIZES.size - len(lead)) if lead else b""
    if not lead:
        raise ConnectionError("the other side has closed")
    of_text, of_body = _SIZES.unpack(lead)
    if of_text + of_body > MAX_FRAME_BYTES:
        raise ConnectionError(f"a frame of {of_text + of_body} bytes was announced")
    header = json.loads(_exactly(connection, of_text))
    return header, _exactly(connection, of_body), descriptors[0] if descriptors else None


def _exactly(connection: socket.socket, size: int) -> bytes:
    received = bytearray(size)
    view, have = memoryview(received), 0
    while have < size:
        count = connection.recv_into(view[have:])
        if count == 0:
            raise ConnectionError("the other side has closed in the middle of a frame")
        have += count
    return bytes(received)


def pack(found: Sequence[Sequence[Detection]]) -> tuple[list[list[dict[str, Any]]], bytes]:
    """Detections of several images as JSON values and their masks as bits."""
    parts: list[bytes] = []

    def one(detection: Detection) -> dict[str, Any]:
        if detection.mask is not None:
            parts.append(np.packbits(detection.mask).tobytes())
        return {
            "category": detection.category,
            "box_px": detection.box_px,
            "confidence": detection.confidence,
            "attributes": detection.attributes,
            "has_mask": detection.mask is not None,
        }

    packed = [[one(detection) for detection in detections] for detections in found]
    return packed, b"".join(parts)


def unpack(packed: Sequence[Sequence[Mapping[str, Any]]], bits: bytes) -> list[tuple[Detection, ...]]:
    """The reverse of :func:`pack`."""
    at = 0

    def one(value: Mapping[str, Any]) -> Detection:
        nonlocal at
        x0, y0, x1, y1 = (int(edge) for edge in value["box_px"])
        mask: NDArray[np.bool_] | None = None
        if value["has_mask"]:
            pixels = (y1 - y0) * (x1 - x0)
            size = (pixels + 7) // 8
            flat = np.unpackbits(np.frombuffer(bits, np.uint8, size, at), count=pixels)
            mask, at = flat.astype(np.bool_).reshape(y1 - y0, x1 - x0), at + size
        return Detection(value["category"], (x0, y0, x1, y1), float(value["confidence"]), mask, tuple(value["attributes"]))

    return [tuple(one(value) for value in values) for values in packed]
