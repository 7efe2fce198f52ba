"""The Gymnasium registration and its own checker."""

from __future__ import annotations

import builtins
import importlib
import sys

import numpy as np
import pytest
import two_rooms

from spacevln.core import Camera, EpisodeSpec, InstructionTask, Pose, PrerequisiteError
from spacevln.environments.houses.environment import HousesEnvironment

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

from spacevln.environments.houses.gym import GymEpisode, register  # noqa: E402

GOAL = Pose(6.0, 2.0)


def draw(rng: np.random.Generator) -> GymEpisode:
    start = Pose(0.8, float(rng.uniform(1.8, 2.2)), 0.0, 0.0)
    spec = EpisodeSpec("1", "house-000000", start, InstructionTask("go through the door"))
    return GymEpisode(spec, lambda pose: pose.distance_m(GOAL.x_m, GOAL.y_m))


def small_house() -> HousesEnvironment:
    return HousesEnvironment(Camera(64, 48, 79.0, 0.88), renderer="raycast", load=two_rooms.place)


@pytest.fixture
def env():
    env = gymnasium.make(
        "spacevln.environments.houses.gym:spacevln/Houses-v0", render_mode="rgb_array", environment=small_house, draw=draw
    )
    yield env
    env.close()


def test_it_passes_gymnasiums_checker(env):
    check_env(env.unwrapped)


def test_it_is_registered_under_its_name():
    register()
    register()
    spec = gymnasium.spec("spacevln/Houses-v0")
    assert spec.max_episode_steps == 500
    assert spec.entry_point == "spacevln.environments.houses.gym:HousesGym"


def test_walking_to_the_goal_is_rewarded_and_stop_ends_it(env):
    _, info = env.reset(seed=3)
    assert info["instruction"] == "go through the door"
    total, start_m = 0.0, info["distance_m"]
    for _ in range(10):
        seen, reward, terminated, truncated, info = env.step(np.int64(1))
        total += reward
        assert not terminated
        assert not truncated
    assert total == pytest.approx(start_m - info["distance_m"])
    assert total == pytest.approx(2.5, abs=0.05)
    assert seen["pose"][0] == pytest.approx(2.5)
    _, reward, terminated, _, info = env.step(np.int64(0))
    assert terminated
    assert info["success"]
    assert reward == pytest.approx(10.0)


def test_the_same_seed_gives_the_same_episode(env):
    first, _ = env.reset(seed=11)
    second, _ = env.reset(seed=11)
    np.testing.assert_array_equal(first["rgb"], second["rgb"])


def test_without_gymnasium_one_sentence_says_what_to_install(monkeypatch):
    real = builtins.__import__

    def missing(name, *args, **kwargs):
        if name.partition(".")[0] == "gymnasium":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.delitem(sys.modules, "spacevln.environments.houses.gym")
    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(PrerequisiteError, match=r'pip install "spacevln\[gym\]"'):
        importlib.import_module("spacevln.environments.houses.gym")
