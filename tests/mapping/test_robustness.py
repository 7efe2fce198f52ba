"""Noise makes the map worse by degrees, never wild."""

from __future__ import annotations

import numpy as np
import pytest
from house_walks import CAMERA, look, walk
from noise import Trouble, redwood, troubled
from worlds import look as look_at
from worlds import room

from spacevln.core import Observation, Pose
from spacevln.mapping import MetricMap

ALL = Trouble(pose=1.0, depth=1.0, holes=0.1, dropped=0.2)


def test_redwood_depth_is_quantised_and_unbiased() -> None:
    flat = np.full((240, 320), 4.0, np.float32)
    noisy = redwood(flat, 1.0, np.random.default_rng(0))
    assert noisy.mean() == pytest.approx(4.0, abs=0.03)
    assert 0.01 < noisy.std() < 0.06
    assert len(np.unique(noisy)) < 6
    assert not redwood(np.zeros((4, 4), np.float32), 1.0, np.random.default_rng(0)).any()


def test_a_noisy_room_is_still_a_room() -> None:
    world = room(-2, -2, 3, 2)
    frames = [look_at(world, Pose(0.1 * k, 0, 0, k * np.pi / 6), CAMERA) for k in range(12)]
    world_map = MetricMap()
    for frame in troubled(frames, ALL, np.random.default_rng(5)):
        world_map.integrate(frame)
    inside = np.random.default_rng(1).uniform((-1.7, -1.7), (2.7, 1.7), (500, 2))
    assert world_map.is_explored(inside).mean() > 0.9
    assert world_map.is_obstacle(inside).mean() < 0.02
    assert world_map.floors == (0,)


@pytest.fixture(scope="module")
def frames() -> list[Observation]:
    """Of four rooms of a house."""
    return [image for _, images in look(walk(5, rooms=4)) for image in images]


@pytest.mark.slow
@pytest.mark.parametrize(
    "trouble",
    [
        Trouble(pose=1.0),
        Trouble(depth=1.0),
        Trouble(holes=0.1),
        Trouble(dropped=0.5),
        ALL,
        Trouble(pose=3.0, depth=3.0, holes=0.3, dropped=0.5),
    ],
)
def test_a_troubled_walk_neither_fails_nor_grows(trouble: Trouble, frames: list[Observation]) -> None:
    clean, noisy = MetricMap(), MetricMap()
    for frame in frames:
        clean.integrate(frame)
    for frame in troubled(frames, trouble, np.random.default_rng(5)):
        noisy.integrate(frame)
    assert noisy.floors == (0,)
    assert noisy.nbytes <= 2 * clean.nbytes
    size = noisy.nbytes
    for frame in troubled(frames, trouble, np.random.default_rng(6)):  # the same again: nothing new is to be known
        noisy.integrate(frame)
    assert noisy.nbytes <= 1.5 * size
