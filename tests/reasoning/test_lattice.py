"""The executor's search over turns and forwards, on made-up obstacles."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from spacevln.core import Pose
from spacevln.reasoning.rules.lattice import BODY_M, Gait, Run, first_run, straight_guide

GAIT = Gait()
NO_BUMPS = np.empty((0, 2))


class Obstacles:
    """The one question that the search asks of a map."""

    def __init__(self, solid: Callable[[np.ndarray, np.ndarray], np.ndarray] = lambda x, _: np.zeros(len(x), dtype=bool)) -> None:
        self._solid = solid

    def is_obstacle(self, xy_m: np.ndarray) -> np.ndarray:
        return self._solid(xy_m[:, 0], xy_m[:, 1])


def drive(obstacles: Obstacles, pose: Pose, target: tuple[float, float], most: int = 30) -> list[Run]:
    """Runs until the search stays, carried out without error."""
    runs = []
    way = straight_guide(pose.xy_m, np.array(target))
    for _ in range(most):
        run = first_run(GAIT, obstacles, NO_BUMPS, pose, way, np.array(target), 0.2, 1.25, (True, True))
        if run == Run() or pose.distance_m(*target) <= 0.2:
            return runs
        runs.append(run)
        pose = Pose(
            pose.x_m + run.forwards * GAIT.step_m * math.cos(pose.yaw_rad),
            pose.y_m + run.forwards * GAIT.step_m * math.sin(pose.yaw_rad),
            0.0,
            pose.yaw_rad + run.turns * math.pi / 6,
        )
    raise AssertionError(f"no end: {runs}")


def test_straight_on_in_the_open() -> None:
    assert drive(Obstacles(), Pose(0, 0, 0, 0), (2.0, 0.0)) == [Run(forwards=5), Run(forwards=3)]


@pytest.mark.parametrize(("bearing_deg", "turns"), [(90, 3), (-60, -2), (180, 6), (150, 5), (-150, -5)])
def test_turns_the_short_way_round_in_one_decision(bearing_deg: float, turns: int) -> None:
    target = (1.5 * math.cos(math.radians(bearing_deg)), 1.5 * math.sin(math.radians(bearing_deg)))
    runs = drive(Obstacles(), Pose(0, 0, 0, 0), target)
    assert runs[0] in (Run(turns=turns), Run(turns=-turns) if abs(turns) == 6 else Run(turns=turns))
    assert [run.forwards for run in runs[1:]] == [5] or sum(run.forwards for run in runs) == 6


def test_the_turn_of_a_stages_alignment_is_no_decision() -> None:
    start, target = Pose(0, 0, 0, 0), (1.06, 1.06)  # between two headings
    way = straight_guide(start.xy_m, np.array(target))
    runs = [
        first_run(GAIT, Obstacles(), NO_BUMPS, start, way, np.array(target), 0.2, 1.25, (True, True), aligning=aligning)
        for aligning in (False, True)
    ]
    assert runs[0].forwards
    assert runs[1] == Run(turns=1)


def test_a_target_off_the_headings_is_reached_without_running_to_and_fro() -> None:
    runs = drive(Obstacles(), Pose(0, 0, 0, 0), (1.2, 0.35))
    assert len(runs) <= 4
    assert sum(run.forwards for run in runs) <= 6


def test_a_gap_between_two_walls_is_passed() -> None:
    def wall(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return (np.abs(x - 1.0) < 0.1) & (np.abs(y - 0.4) > 0.3)

    runs = drive(Obstacles(wall), Pose(0, 0, 0, 0), (2.0, 0.4))
    assert 8 <= sum(run.forwards for run in runs) <= 11


def test_behind_a_closed_wall_one_goes_as_near_as_one_gets() -> None:
    def wall(x: np.ndarray, _: np.ndarray) -> np.ndarray:
        return np.asarray(np.abs(x - 1.0) < 0.1)

    runs = drive(Obstacles(wall), Pose(0, 0, 0, 0), (2.0, 0.0))
    assert sum(run.forwards for run in runs) in (2, 3)


def test_what_was_bumped_into_is_walked_around() -> None:
    pose, target = Pose(0, 0, 0, 0), np.array((1.5, 0.0))
    guide = straight_guide(pose.xy_m, target)
    bumps = np.array([(0.15, y) for y in (-0.05, 0.0, 0.05)])
    assert first_run(GAIT, Obstacles(), NO_BUMPS, pose, guide, target, 0.2, 1.25, (True, True)).forwards == 5
    run = first_run(GAIT, Obstacles(), bumps, pose, guide, target, 0.2, 1.25, (True, True))
    assert run.forwards == 0
    assert run.turns


def test_admissible_actions_bind_the_first_run_only() -> None:
    pose, target = Pose(0, 0, 0, 0), np.array((2.0, 0.0))
    guide = straight_guide(pose.xy_m, target)
    assert first_run(GAIT, Obstacles(), NO_BUMPS, pose, guide, target, 0.2, 0.5, (True, True)).forwards <= 2
    behind = np.array((-1.5, 0.3))
    back = straight_guide(pose.xy_m, behind)
    assert first_run(GAIT, Obstacles(), NO_BUMPS, pose, back, behind, 0.2, 1.25, (True, False)).turns > 0
    assert first_run(GAIT, Obstacles(), NO_BUMPS, pose, back, behind, 0.2, 1.25, (False, True)).turns < 0
    assert first_run(GAIT, Obstacles(), NO_BUMPS, pose, guide, target, 0.2, 0.0, (False, False)) == Run()


def test_out_of_a_place_too_tight_to_stand_in() -> None:
    def corner(x: np.ndarray, _: np.ndarray) -> np.ndarray:
        return np.asarray(x < -BODY_M[0] + 0.04)

    runs = drive(Obstacles(corner), Pose(0, 0, 0, 0), (1.0, 0.0))
    assert runs == [Run(forwards=4)]


def test_a_body_of_eight_headings_and_longer_steps() -> None:
    robot, pose, target = Gait(step_m=0.5, headings=8, run=3), Pose(0, 0, 0, 0), np.array((0.0, 1.5))
    guide = straight_guide(pose.xy_m, target)
    assert first_run(robot, Obstacles(), NO_BUMPS, pose, guide, target, 0.2, 1.5, (True, True)) == Run(turns=2)
    left = Pose(0, 0, 0, math.pi / 2)
    assert first_run(robot, Obstacles(), NO_BUMPS, left, guide, target, 0.2, 1.5, (True, True)) == Run(forwards=3)
