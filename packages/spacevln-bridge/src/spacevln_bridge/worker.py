"""The worker: serves one client after the other; ends with the client that started it."""

from __future__ import annotations

import argparse
import ctypes
import dataclasses
import hmac
import os
import platform
import signal
import socket
import sys
from typing import Any, Callable, Dict, List, Optional

from spacevln_bridge import messages as say
from spacevln_bridge.channel import Channel, ChannelClosed, ChannelError
from spacevln_bridge.images import block_bytes, shared_block, views
from spacevln_bridge.simulator import MeasuringSimulator, Simulator, SimulatorError, load_package, simulator_of

TOKEN_VARIABLE = "SPACEVLN_BRIDGE_TOKEN"  # noqa: S105 - the name of a variable
GREETING_S = 10.0
PR_SET_PDEATHSIG = 1


class Session:
    """Answers one client.

    Args:
        channel: to it.
        simulator: reused over clients.
        block: descriptor of the shared-memory file for images; None sends them.
    """

    def __init__(self, channel: Channel, simulator: Simulator, block: Optional[int]) -> None:
        self._channel = channel
        self._simulator = simulator
        self._descriptor = block
        self._size = (0, 0)
        self._block: Any = None
        self._answers: Dict[type, Callable[[Any], say.Message]] = {
            say.Ping: lambda _: say.Pong(),
            say.Open: self._open,
            say.OpenSplats: self._open,
            say.Place: lambda asked: self._seen(simulator.place(asked.position, asked.rotation)),
            say.Act: lambda asked: self._seen(simulator.act(asked.action)),
        }
        if isinstance(simulator, MeasuringSimulator):
            self._answers.update(_measurements(simulator))

    def serve(self) -> None:
        """Answer until the client says goodbye.

        Raises:
            ChannelError: it is gone, or is not understood.
        """
        while True:
            asked = self._channel.receive()
            if isinstance(asked, say.Bye):
                return
            self._channel.send(self._answer(asked))

    def _answer(self, asked: say.Message) -> say.Message:
        answer = self._answers.get(type(asked))
        if answer is None:
            return say.Failed("usage", f"{type(asked).__name__} is no request of {type(self._simulator).__name__}.")
        try:
            return answer(asked)
        except SimulatorError as error:
            return say.Failed(error.kind, str(error))
        except Exception as error:  # noqa: BLE001 - the boundary to foreign code
            return say.Failed("simulator", f"The simulator failed in {type(asked).__name__}: {type(error).__name__}: {error}")

    def _open(self, asked: Any) -> say.Message:
        opened: say.Message = self._simulator.open(asked)
        size = (asked.width_px, asked.height_px)
        if size != self._size:
            shared = self._descriptor is not None
            self._block = shared_block(self._descriptor, *size) if shared else bytearray(block_bytes(*size))  # type: ignore[arg-type]
            self._size = size
        return opened

    def _seen(self, view: say.View) -> say.View:
        self._simulator.draw(*views(self._block, *self._size))
        if self._descriptor is not None:
            return view
        return dataclasses.replace(view, image=bytes(self._block))


def _measurements(simulator: MeasuringSimulator) -> Dict[type, Callable[[Any], say.Message]]:
    return {
        say.Distances: lambda asked: say.Numbers(simulator.distances(say.unpack(asked.positions), say.unpack(asked.targets))),
        say.Path: lambda asked: say.Points(say.pack(simulator.path(asked.start, say.unpack(asked.targets)))),
        say.Moves: lambda asked: say.Numbers(simulator.moves(asked.start, say.unpack(asked.ends), say.unpack(asked.targets))),
    }


def greet(channel: Channel, token: str) -> Optional[say.Hello]:
    """Exchange versions; what the client said, None if it may not go on."""
    hello = channel.receive(GREETING_S)
    if not isinstance(hello, say.Hello) or not hmac.compare_digest(hello.token.encode(), token.encode()):
        channel.send(say.Failed("usage", f"The token is wrong: set the worker's {TOKEN_VARIABLE} at the client too."))
        return None
    if hello.protocol != say.PROTOCOL:
        channel.send(
            say.Failed(
                "version",
                f"The worker speaks protocol {say.PROTOCOL}, the client {hello.protocol}: install one version at both ends.",
            )
        )
        return None
    return hello


def main(arguments: Optional[List[str]] = None) -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="spacevln_bridge", description="Runs a simulator for spacevln.")
    parser.add_argument("--channel", type=int, help="descriptor of an inherited, connected socket")
    parser.add_argument("--block", type=int, help="descriptor of an inherited shared-memory file for images")
    parser.add_argument("--listen", metavar="[HOST:]PORT", help="serve clients over TCP, one at a time")
    options = parser.parse_args(arguments)
    if options.channel is not None:
        _die_with_parent()
        connection = socket.socket(fileno=options.channel)
        _serve([connection], "", options.block)
    elif options.listen is not None:
        _serve(_clients(options.listen), _token(), None)
    else:
        parser.error("give --listen, or let spacevln start this")


def _serve(connections: Any, token: str, block: Optional[int]) -> None:
    running: Dict[str, Simulator] = {}  # one at most
    for connection in connections:
        channel = Channel(connection)
        try:
            hello = greet(channel, token)
            if hello is not None:
                simulator = _begin(channel, hello.simulator, running)
                if simulator is not None:
                    Session(channel, simulator, block).serve()
        except ChannelClosed:
            continue
        except ChannelError as error:
            sys.stderr.write(f"spacevln_bridge: the client cannot be served any longer: {error}\n")
        finally:
            channel.close()
    for simulator in running.values():
        simulator.close()


def _begin(channel: Channel, name: str, running: Dict[str, Simulator]) -> Optional[Simulator]:
    """Welcome a client with the simulator that it names, or tell it why not."""
    try:
        if running and name not in running:
            raise SimulatorError("usage", f"This worker runs {next(iter(running))!r}, not {name!r}: start another one.")
        package = load_package(name)
    except SimulatorError as error:
        channel.send(say.Failed(error.kind, str(error)))
        return None
    version = str(getattr(package, "__version__", "unknown"))
    channel.send(say.Welcome(say.PROTOCOL, platform.python_version(), version, os.getpid()))
    if name not in running:
        running[name] = simulator_of(name, package)
    return running[name]


def _clients(address: str) -> Any:
    host, _, port = address.rpartition(":")
    with socket.create_server((host or "127.0.0.1", int(port))) as server:
        sys.stderr.write(f"spacevln_bridge: listening on {server.getsockname()[0]}:{server.getsockname()[1]}\n")
        sys.stderr.flush()
        while True:
            connection, _ = server.accept()
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            yield connection


def _token() -> str:
    token = os.environ.get(TOKEN_VARIABLE, "")
    if len(token) < 16:
        sys.exit(f"spacevln_bridge: --listen needs a token of at least 16 characters in {TOKEN_VARIABLE}.")
    return token


def _die_with_parent() -> None:
    """Be killed when the client's thread dies, also in a native call; elsewhere than on Linux the closed socket must do."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
