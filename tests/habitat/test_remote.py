"""A worker on another machine: the same episode over TCP, a token at the door."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import spacevln_bridge
from bridge_world import SCENE, episode, scenes, small, use_standin

from spacevln.core import EnvironmentFailure, MoveForward, PrerequisiteError, UsageError
from spacevln.environments.habitat.environment import HabitatEnvironment
from spacevln.environments.habitat.setup import HabitatSetup

WORD = "known at both ends"
pytestmark = [pytest.mark.slow, pytest.mark.allow_hosts(["127.0.0.1"])]


@pytest.fixture
def address(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    use_standin(monkeypatch, "0.3.4")
    monkeypatch.setenv("SPACEVLN_BRIDGE_TOKEN", WORD)
    folder = str(Path(spacevln_bridge.__file__).parent)
    server = subprocess.Popen([sys.executable, folder, "--listen", "0"], stderr=subprocess.PIPE, text=True, env=dict(os.environ))
    assert server.stderr is not None
    yield "tcp://" + server.stderr.readline().split()[-1]
    server.kill()
    server.wait()
    server.stderr.close()


def far(address: str, folder: Path) -> HabitatEnvironment:
    return HabitatEnvironment(HabitatSetup(python=address, scenes=str(scenes(folder)), width_px=64, height_px=48, gpu_device=-1))


def test_what_is_seen_there_is_what_is_seen_here(address: str, tmp_path: Path) -> None:
    here, there = small(tmp_path), far(address, tmp_path)
    for world in (here, there):
        world.reset(episode())
        world.execute(MoveForward())
    ours, theirs = here.observe(), there.observe()
    np.testing.assert_array_equal(ours.rgb, theirs.rgb)
    np.testing.assert_array_equal(ours.depth_m, theirs.depth_m)
    assert ours.pose == theirs.pose
    here.close()
    there.close()
    again = far(address, tmp_path)  # the next client finds the scene open
    assert again.reset(episode()).pose.x_m == pytest.approx(0, abs=1e-6)
    start = episode().start.position_m[None]
    assert again.geodesics(SCENE).distances_m(start, start)[0] == pytest.approx(0, abs=1e-3)
    again.close()


def test_a_wrong_token_is_refused(address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPACEVLN_BRIDGE_TOKEN", "another token")
    with pytest.raises(UsageError, match=r"token is wrong"):
        far(address, tmp_path).reset(episode())
    monkeypatch.delenv("SPACEVLN_BRIDGE_TOKEN")
    with pytest.raises(PrerequisiteError, match=r"wants a token"):
        far(address, tmp_path).reset(episode())


def test_missing_and_lost_workers_are_told(address: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"no address"):
        far("tcp://somewhere", tmp_path).reset(episode())
    with pytest.raises(PrerequisiteError, match=r"Nobody answers"):
        far("tcp://127.0.0.1:9", tmp_path).reset(episode())
    world = far(address, tmp_path)
    world.reset(episode())
    world.simulator.worker.close()
    with pytest.raises(EnvironmentFailure, match=r"lost"):
        world.execute(MoveForward())
