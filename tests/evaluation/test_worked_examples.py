"""Worked examples of the benchmark notes that need more than a formula: a body, a dataset, a map."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import made_up
import numpy as np
import pytest
import scripted_bench

from spacevln.assembly import Configuration
from spacevln.core import Action, Camera, Motion, MoveForward, Observation, Pose, Stop
from spacevln.evaluation import datasets
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.baselines import BLIND_FORWARDS
from spacevln.evaluation.judging import judge
from spacevln.evaluation.truth import MeasuredTruth, Points
from spacevln.mapping import MetricMap
from spacevln.recording import RecordLevel, ResultFile


class OneWall(scripted_bench.Void):
    """A void in which one forward, the third, is blocked."""

    def __init__(self) -> None:
        super().__init__(0.0, scripted_bench.Gate(Path(), 1))
        self._tried = 0

    def execute(self, action: Action) -> Motion:
        self._tried += isinstance(action, MoveForward)
        if isinstance(action, MoveForward) and self._tried == 3:
            return Motion(0.0, 0.0, True)
        return super().execute(action)


def walk(world: scripted_bench.Void, folder: Path) -> ResultFile:
    (episode,) = scripted_bench.scripted_episodes(1)
    with Session(Configuration(driver="forward"), world) as session:
        return session.attempt(episode, folder, level=RecordLevel.LIGHT)


def test_a_blocked_forward_is_a_step_and_a_collision_and_no_way(tmp_path: Path) -> None:
    """Worked example 10."""
    free = walk(scripted_bench.Void(0.0, scripted_bench.Gate(Path(), 1)), tmp_path / "free").metrics
    blocked = walk(OneWall(), tmp_path / "blocked").metrics
    assert (free.steps, free.collisions, free.path_length) == (BLIND_FORWARDS + 1, 0, pytest.approx(0.25 * BLIND_FORWARDS))
    assert (blocked.steps, blocked.collisions) == (BLIND_FORWARDS + 1, 1)
    assert blocked.path_length == pytest.approx(0.25 * (BLIND_FORWARDS - 1))


class CrowFlies:
    """Geodesics of a world without walls."""

    def distances_m(self, positions: Points, targets: Points) -> Points:
        return np.linalg.norm(positions[:, None] - targets[None], axis=2).min(axis=1)

    def path(self, start: Points, targets: Points) -> Points:
        return np.vstack([start, targets[:1]])

    def follow(self, pose: Pose, targets: Points) -> Action:
        del pose, targets
        return Stop()


def viewed_from(category: str, number: int, ahead_m: float) -> dict[str, object]:
    goal = made_up.ovon_goal(category, number, 0.0)
    goal["view_points"][0]["agent_state"]["position"] = [0.0, 0.0, -ahead_m]
    return goal


@pytest.mark.parametrize(("children", "shortest_m"), [([], 4.0), (["side table"], 3.0)])
def test_the_nearest_view_point_of_any_instance_and_child_counts(children: list[str], shortest_m: float, tmp_path: Path) -> None:
    """Worked example 20: instances 6 and 4 m away make L = 4; a child category 3 m away makes L = 3."""
    scene = "AAAAAAAAAAA"
    episode = made_up.ovon_episode(
        0, scene, start_position=[0.0, 0.0, 0.0], start_rotation=[0, 0, 0, 1], children_object_categories=children
    )
    shard = made_up.ovon_shard(scene) | {
        "episodes": [episode],
        "goals_by_category": {
            f"{scene}.basis.glb_coffee table": [viewed_from("coffee table", 1, 6.0), viewed_from("coffee table", 2, 4.0)],
            f"{scene}.basis.glb_side table": [viewed_from("side table", 3, 3.0)],
        },
    }
    (loaded,) = datasets.load("hm3d-ovon", made_up.write_json(tmp_path / f"{scene}.json.gz", shard))
    assert loaded.annotations is not None
    truth = MeasuredTruth(loaded.annotations, CrowFlies(), loaded.start)
    walked = np.array([loaded.start.position_m, [shortest_m - 0.2, 0.0, 0.0]])
    found = judge(truth, walked, stopped=True)
    assert found.start_m == pytest.approx(shortest_m)
    assert (found.SR, found.SPL) == (1.0, 1.0)


def seen(depth_m: float) -> MetricMap:
    """The map after one look at a flat thing in front; normalised depth n of [0.5, 5] m stands for 0.5 + 4.5 n metres."""
    camera = Camera(width_px=64, height_px=48, hfov_deg=79, height_m=0.88)
    blank = Observation(
        rgb=np.zeros((48, 64, 3), np.uint8), depth_m=np.zeros((48, 64), np.float32), pose=Pose(0.0, 0.0), camera=camera
    )
    observed = MetricMap()
    observed.integrate(replace(blank, depth_m=np.full((48, 64), depth_m, np.float32)))
    return observed


def test_normalised_depth_at_its_ends_says_nothing() -> None:
    """Worked example 21: n = 0.5 is 2.75 m; n = 0 is a hole or at most 0.5 m, n = 1 at least 5 m, and neither is an obstacle.

    We keep metres, with 0 for a hole, so the ends of the sensor's range are told from a wall.
    """
    half = 0.5 + 4.5 * 0.5
    assert half == 2.75
    met = seen(half)
    assert met.is_obstacle([[2.76, 0.0]]).item()
    assert not met.is_obstacle([[2.0, 0.0]]).item()
    for at_an_end in (0.0, 0.4, 5.2, math.inf):
        map_then = seen(at_an_end)
        ahead = [[x, 0.0] for x in np.arange(0.3, 6.0, 0.05)]
        assert not map_then.is_obstacle(ahead).any()
