"""10,000 steps over many episodes and two scenes leave memory and descriptors of both ends as they were."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from bridge_world import SCENE, episode, small, use_standin

from spacevln.core import EpisodeSpec, InstructionTask, MoveForward, TurnLeft
from spacevln.environments.habitat.environment import HabitatEnvironment

STEPS, EPISODE_STEPS, SCENE_EPISODES = 10_000, 250, 10
GROWTH_MB = 4


def resident_mb(process: int) -> float:
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def descriptors(process: int) -> int:
    return len(list(Path(f"/proc/{process}/fd").iterdir()))


def walk(world: HabitatEnvironment, scene: str, count: int) -> None:
    for number in range(count):
        if number % EPISODE_STEPS == 0:
            world.reset(EpisodeSpec("1", scene, episode().start, InstructionTask("go")))
        world.execute(MoveForward() if number % 3 == 0 else TurnLeft())
        world.observe()


@pytest.mark.slow
def test_many_steps_grow_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4", fault="blank")
    world = small(tmp_path / "scenes", cache=str(tmp_path / "meshes"))
    other = tmp_path / "scenes" / "other.glb"
    other.write_bytes(b"another")
    for scene in (SCENE, "other.glb"):
        walk(world, scene, EPISODE_STEPS)
    processes = (os.getpid(), world.simulator.worker.pid)  # type: ignore[attr-defined]
    before = [(resident_mb(each), descriptors(each)) for each in processes]
    share = EPISODE_STEPS * SCENE_EPISODES
    for part in range(STEPS // share):
        walk(world, (SCENE, "other.glb")[part % 2], share)
    after = [(resident_mb(each), descriptors(each)) for each in processes]
    world.close()
    for (was_mb, was), (is_mb, now) in zip(before, after, strict=True):
        assert is_mb - was_mb < GROWTH_MB
        assert now == was
