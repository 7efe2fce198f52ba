"""What the bridge to Habitat-Sim costs: one 640x480 RGB-D step with labels, beside a stand-in that draws nothing.

``pytest benchmarks/test_bridge.py --benchmark-only``. Goals: 3 ms for a step through shared memory, from action to observation;
images sent over the socket are beside it for comparison. 10,000 steps leave memory and descriptors as they were.
"""

from __future__ import annotations

import os
import sys
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
STEPS = 10_000
GROWTH_MB = 8


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[HabitatEnvironment]:
    use_standin(monkeypatch, "0.3.4", fault="blank")
    world = HabitatEnvironment(setup(tmp_path))
    world.reset(episode())
    yield world
    world.close()


def step(world: HabitatEnvironment) -> None:
    world.execute(TurnLeft())
    world.observe()


def test_a_step_through_shared_memory(benchmark: object, world: HabitatEnvironment) -> None:
    benchmark(step, world)  # type: ignore[operator]
    assert benchmark.stats.stats.median < GOAL_S  # type: ignore[attr-defined]


def test_an_image_over_the_socket(benchmark: object) -> None:
    import socket
    import threading

    ours, theirs = socket.socketpair()
    client, server = Channel(ours), Channel(theirs)
    image = bytes(block_bytes(640, 480))
    here = (0.0, 0.0, 0.0)
    view = say.View(here, (*here, 1.0), here, (*here, 1.0), collided=False, navigable=True, image=image)

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


def test_many_steps_grow_nothing(benchmark: object, world: HabitatEnvironment) -> None:
    processes = (os.getpid(), world.simulator.worker.pid)
    for _ in range(200):
        step(world)
    before = [(_resident_mb(each), _descriptors(each)) for each in processes]
    benchmark.pedantic(lambda: [step(world) for _ in range(STEPS)], rounds=1)  # type: ignore[attr-defined]
    for process, (resident_mb, descriptors) in zip(processes, before, strict=True):
        assert _resident_mb(process) - resident_mb < GROWTH_MB
        assert _descriptors(process) == descriptors


def _resident_mb(process: int) -> float:
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def _descriptors(process: int) -> int:
    return len(list(Path(f"/proc/{process}/fd").iterdir()))
