"""Messages over a connected socket: a magic number, a length, msgpack."""

from __future__ import annotations

import socket
import struct
import time
from typing import Optional

import msgpack

from spacevln_bridge.messages import Message, MessageError, decode, encode

MAGIC = b"SVBR"
HEADER = struct.Struct(">4sI")
MAX_BYTES = 1 << 27


class ChannelError(Exception):
    """The other end cannot be understood or reached any more."""


class ChannelClosed(ChannelError):
    """The other end is gone."""


class ChannelLate(ChannelError):
    """The other end did not answer in time."""


class ChannelGarbled(ChannelError):
    """The other end says what is no message."""


class Channel:
    """Sends and receives messages; one thread at a time.

    Args:
        connection: a connected stream socket; the channel owns it.
    """

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection

    def send(self, message: Message, deadline_s: Optional[float] = None) -> None:
        """Send.

        Raises:
            ChannelClosed: the other end is gone.
            ChannelLate: it does not read.
        """
        body = msgpack.packb(encode(message), use_bin_type=True)
        try:
            self._socket.settimeout(deadline_s)
            self._socket.sendall(HEADER.pack(MAGIC, len(body)) + body)
        except socket.timeout as error:
            raise ChannelLate("it does not read") from error
        except OSError as error:
            raise ChannelClosed(error.strerror or str(error)) from error

    def receive(self, deadline_s: Optional[float] = None) -> Message:
        """The next message.

        Raises:
            ChannelClosed: the other end is gone.
            ChannelLate: nothing whole came before the deadline.
            ChannelGarbled: it was no message.
        """
        until = None if deadline_s is None else time.monotonic() + deadline_s
        magic, length = HEADER.unpack(self._exactly(HEADER.size, until))
        if magic != MAGIC or length > MAX_BYTES:
            raise ChannelGarbled("the bytes are no message header")
        try:
            return decode(msgpack.unpackb(self._exactly(length, until), raw=False, strict_map_key=False))
        except (MessageError, ValueError, msgpack.UnpackException, TypeError, RecursionError) as error:
            raise ChannelGarbled(str(error) or type(error).__name__) from error

    def _exactly(self, count: int, until: Optional[float]) -> bytes:
        data = bytearray(count)
        view, done = memoryview(data), 0
        while done < count:
            left = None if until is None else until - time.monotonic()
            if left is not None and left <= 0:
                raise ChannelLate("it did not answer in time")
            try:
                self._socket.settimeout(left)
                got = self._socket.recv_into(view[done:])
            except socket.timeout as error:
                raise ChannelLate("it did not answer in time") from error
            except OSError as error:
                raise ChannelClosed(error.strerror or str(error)) from error
            if not got:
                raise ChannelClosed("it hung up")
            done += got
        return bytes(data)

    def close(self) -> None:
        """Hang up; may be called twice."""
        self._socket.close()
