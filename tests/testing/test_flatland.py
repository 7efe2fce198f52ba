"""Flatland is an exact, conforming environment."""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacevln.core import Camera, ContractError, EpisodeSpec, InstructionTask, MoveForward, Pose, Stop, TurnLeft
from spacevln.testing.environment import EnvironmentConformance
from spacevln.testing.flatland import Box, Flatland

CAMERA = Camera(81, 61, 79.0, 0.88)  # odd, so that one pixel looks straight ahead


def at(pose: Pose) -> EpisodeSpec:
    return EpisodeSpec("e", "flatland", pose, InstructionTask("Go."))


class TestConformance(EnvironmentConformance):
    def make_environment(self) -> Flatland:
        return Flatland()

    def make_episode(self) -> EpisodeSpec:
        return at(Pose(-0.5, -0.5, 0.0, 0.3))


@pytest.mark.parametrize(("yaw_deg", "depth_m"), [(0.0, 5.95), (90.0, 1.95), (180.0, 1.95), (-90.0, 1.95)])
def test_depth_is_exact_along_the_axis(yaw_deg: float, depth_m: float) -> None:
    world = Flatland(camera=CAMERA)
    image = world.reset(at(Pose(0.0, 0.0, 0.0, math.radians(yaw_deg))))
    assert image.depth_m[30, 40] == pytest.approx(depth_m, abs=1e-5)


def test_every_pixel_lies_on_a_surface() -> None:
    world = Flatland([Box(1.0, -1.0, 2.0, 1.0, z1_m=0.5, category="table")], CAMERA)
    image = world.reset(at(Pose(0.0, 0.0)))
    v, u = np.mgrid[: CAMERA.height_px, : CAMERA.width_px]
    depth = image.depth_m.astype(float)
    y = (CAMERA.cx_px - u - 0.5) / CAMERA.fx_px * depth
    z = CAMERA.height_m + (CAMERA.cy_px - v - 0.5) / CAMERA.fy_px * depth
    assert image.labels is not None
    table = image.labels.instance_ids == 1
    assert table.any()
    on_side = np.isclose(depth, 1.0, atol=1e-4) & (z <= 0.5001)
    on_top = np.isclose(z, 0.5, atol=1e-4) & (depth >= 1.0)
    assert (on_side | on_top)[table].all()
    empty = ~table & (depth > 0)
    assert np.allclose(z[empty], np.where(v < 30, 2.5, 0.0)[empty], atol=1e-3)
    assert (np.abs(y[table]) <= 1.001).all()


def test_the_body_stops_where_its_disc_touches() -> None:
    world = Flatland()
    world.reset(at(Pose(1.7, 1.5)))
    motion = world.execute(MoveForward(0.25))
    assert motion.collided
    assert motion.moved_m == pytest.approx(0.15, abs=0.002)
    assert world.execute(TurnLeft(30.0)).turned_rad == pytest.approx(math.radians(30))


def test_doorways_are_passable_labelled_and_of_one_piece() -> None:
    world = Flatland()
    image = world.reset(at(Pose(0.0, 0.0)))
    assert image.labels is not None
    assert sorted(label.category for label in image.labels.instances.values()) == ["bed", "doorway"]
    moved = sum(world.execute(MoveForward(0.25)).moved_m for _ in range(12))
    assert moved == pytest.approx(3.0)


def test_nothing_moves_after_stop() -> None:
    world = Flatland()
    world.reset(at(Pose(0.0, 0.0)))
    world.execute(Stop())
    with pytest.raises(ContractError, match="reset"):
        world.observe()
