"""What the bridge to Habitat-Sim costs: one 640x480 RGB-D step with labels, beside a stand-in that draws nothing.

``pytest benchmarks/test_bridge.py --benchmark-only``. Goal: 3 ms for an RGB-D step through shared memory, from action to
observation; a step with labels, and images sent over the socket, are beside it for comparison. ``extra_info`` has the CPU time
of client and worker, which a busy machine changes less.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("msgpack")
TESTS = Path(__file__).resolve().parents[1] / "tests" / "habitat"
sys.path.insert(0, str(TESTS))

from bridge_world import episode, setup, use_standin  # noqa: E402
from spacevln_bridge import messages as say  # noqa: E402
from spacevln_bridge.channel import Channel  # noqa: E402
from spacevln_bridge.images import block_bytes  # noqa: E402

from spacevln.core import TurnLeft  # noqa: E402
from spacevln.environments.habitat.environment import HabitatEnvironment  # noqa: E402

GOAL_S = 0.003
STEPS = 300


@pytest.fixture(params=[False, True], ids=["rgb-d", "with-labels"])
def world(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[HabitatEnvironment]:
    use_standin(monkeypatch, "0.3.4", fault="blank")
    world = HabitatEnvironment(setup(tmp_path, labels=request.param))
    world.reset(episode())
    yield world
    world.close()


def step(world: HabitatEnvironment) -> None:
    world.execute(TurnLeft())
    world.observe()


def test_a_step_through_shared_memory(benchmark: object, world: HabitatEnvironment, request: pytest.FixtureRequest) -> None:
    worker = world.simulator.worker.pid  # type: ignore[attr-defined]
    begin = (time.process_time(), _cpu_s(worker))
    for _ in range(STEPS):
        step(world)
    used = (time.process_time() - begin[0], _cpu_s(worker) - begin[1])
    benchmark.extra_info.update(client_cpu_ms=1e3 * used[0] / STEPS, worker_cpu_ms=1e3 * used[1] / STEPS)  # type: ignore[attr-defined]
    benchmark(step, world)  # type: ignore[operator]
    if "with-labels" not in request.node.name:
        assert benchmark.stats.stats.median < GOAL_S  # type: ignore[attr-defined]


def test_an_image_over_the_socket(benchmark: object) -> None:
    import socket
    import threading

    ours, theirs = socket.socketpair()
    client, server = Channel(ours), Channel(theirs)
    image = bytes(block_bytes(640, 480))
    here = (0.0, 0.0, 0.0)
    view = say.View(here, (*here, 1.0), here, (*here, 1.0), collided=False, image=image)

    def serve() -> None:
        while isinstance(server.receive(), say.Act):
            server.send(view)

    thread = threading.Thread(target=serve)
    thread.start()

    def ask() -> None:
        client.send(say.Act("turn_left"))
        client.receive()

    benchmark(ask)  # type: ignore[operator]
    client.send(say.Bye())
    thread.join()
    client.close()
    server.close()


def _cpu_s(process: int) -> float:
    user, system = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
