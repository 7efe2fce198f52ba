"""Logs, playback, checks, routes, confirmation, and the map that goes on while a model thinks."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spacevln.assembly.attentive import Attention, way_ahead_m
from spacevln.core import (
    AdmissibleActions,
    Anchor,
    Camera,
    EnvironmentFailure,
    EpisodeSpec,
    ExecutorContext,
    InstructionTask,
    MoveForward,
    Observation,
    ObstacleDistances,
    Pose,
    RecordError,
    SpaceKind,
    StageRecord,
    Stop,
    Subtask,
    TurnLeft,
)
from spacevln.environments.playback.environment import PlaybackEnvironment
from spacevln.environments.playback.log import Log, LogWriter
from spacevln.environments.robot.checks import check_streams, check_turning
from spacevln.environments.robot.profile import Images, RobotProfile
from spacevln.environments.robot.simulation.lockstep import Lockstep
from spacevln.environments.robot.simulation.robot import SensorSettings
from spacevln.environments.robot.streams import Streams
from spacevln.evaluation.robot_routes import Route, Routes, Row, table, trials
from spacevln.mapping import MetricMap
from spacevln.testing.flatland import Flatland
from spacevln.testing.robot_world import FlatlandWorld

CAMERA = Camera(48, 36, 79.0, 0.88)
EPISODE = EpisodeSpec("1", "flatland", Pose(0.0, 0.0), InstructionTask("go"))


def walk() -> list[Observation]:
    world = Flatland(camera=CAMERA, turn_deg=45.0)
    seen = [world.reset(EPISODE)]
    for action in (MoveForward(0.25), TurnLeft(45.0), TurnLeft(45.0), MoveForward(0.25)):
        world.execute(action)
        seen.append(world.observe())
    return seen


def logged(directory: Path) -> list[Observation]:
    seen = walk()
    writer = LogWriter(directory, CAMERA, "test")
    for index, observation in enumerate(seen):
        writer.add(observation, index)
    writer.close()
    writer.close()
    return seen


def test_a_log_gives_back_what_was_written(tmp_path: Path) -> None:
    seen = logged(tmp_path)
    log = Log(tmp_path)
    assert len(log) == len(seen)
    for was, found in zip(seen, log, strict=True):
        assert found.pose == was.pose
        assert found.T_world_camera == pytest.approx(was.T_world_camera)
        assert found.depth_m == pytest.approx(was.depth_m, abs=6e-4)
        assert np.abs(found.rgb.astype(int) - was.rgb).mean() < 6
    with pytest.raises(RecordError, match="holds a log already"):
        LogWriter(tmp_path, CAMERA)


def test_a_line_that_a_kill_cut_off_is_left_out(tmp_path: Path) -> None:
    seen = logged(tmp_path)
    file = tmp_path / "frames.jsonl"
    file.write_text(file.read_text()[:-20])
    assert len(Log(tmp_path)) == len(seen) - 1
    (tmp_path / "log.json").write_text("{}")
    with pytest.raises(RecordError, match="no posed RGB-D log"):
        Log(tmp_path)


def test_playback_does_what_the_recorded_body_did(tmp_path: Path) -> None:
    seen = logged(tmp_path)
    environment = PlaybackEnvironment(Log(tmp_path))
    assert environment.reset(EPISODE).pose == Pose(0.0, 0.0)
    motion = environment.execute(TurnLeft(30.0))
    assert motion.moved_m == pytest.approx(0.25)
    assert environment.observe().pose == seen[1].pose
    while environment.frames_left:
        environment.execute(MoveForward(0.25))
    with pytest.raises(EnvironmentFailure, match="ended after 5 frames"):
        environment.execute(MoveForward(0.25))
    assert environment.execute(Stop()).moved_m == 0.0
    assert environment.reset(EPISODE).pose == Pose(0.0, 0.0)


def test_depth_that_moves_otherwise_than_odometry_is_found() -> None:
    assert check_turning(walk()).ok
    rgb, wall = np.zeros((36, 48, 3), np.uint8), np.full((36, 48), 2.0, np.float32)
    before = Observation(rgb, wall, Pose(0.0, 0.0), CAMERA)
    nearer = Observation(rgb, wall - np.float32(0.25), Pose(0.25, 0.0), CAMERA)
    assert check_turning([before, nearer]).ok
    still = replace(nearer, pose=Pose(0.0, 0.0), T_world_camera=before.T_world_camera)
    wrong = check_turning([before, still])
    assert not wrong.ok
    assert "25 cm apart" in wrong.what
    assert wrong.mend


def test_check_says_what_is_missing() -> None:
    profile = RobotProfile(name="t", images=Images(width_px=0))
    parts = Lockstep(profile, FlatlandWorld(), Pose(0.0, 0.0), sensors=SensorSettings(CAMERA, drop_rate=0.0))
    streams = Streams(parts.transport, profile, parts.clock)
    findings = check_streams(streams, profile, parts.clock, 2.0)
    assert [finding.what for finding in findings if not finding.ok] == []
    parts.robot.faults.silent = frozenset({"depth"})
    parts.robot.faults.clock_s = -2.0
    findings = check_streams(streams, profile, parts.clock, 2.0)
    wrong = " ".join(finding.what for finding in findings if not finding.ok)
    assert "depth: 0.5 Hz on /camera/aligned_depth_to_color/image_raw" in wrong  # one was on its way
    assert "clocks: stamps are 20" in wrong
    assert all(finding.mend for finding in findings if not finding.ok)


def test_the_table_has_the_papers_shape() -> None:
    def row(name: str, setting: str, error_m: float, stopped: bool = True) -> Row:
        return Row(
            episode_id=name,
            setting=setting,
            status="stopped" if stopped else "step_limit",
            stopped=stopped,
            NE_m=error_m,
            success=stopped and error_m <= 2.0,
            judged_by="tracked",
            seconds=1.0,
        )

    rows = [row("a", "Hall", 1.0), row("b", "Hall", 3.0), row("c", "Office", 1.0, stopped=False)]
    lines = table("ours", rows).splitlines()
    assert lines[0] == "| Method | Hall NE | Hall SR | Office NE | Office SR | Overall NE | Overall SR |"
    assert lines[2] == "| ours | 2.00 | 50 (1/2) | 1.00 | 0 (0/1) | 1.67 | 33 (1/3) |"


def test_every_variant_of_a_route_is_a_trial() -> None:
    routes = Routes(name="lab", routes=(Route(id="r", setting="Hall", instructions=("go", "walk"), goal_m=(1.0, 0.0)),))
    assert [trial.spec.episode_id for trial in trials(routes)] == ["r-1", "r-2"]
    assert [trial.spec.task for trial in trials(routes)] == [InstructionTask("go"), InstructionTask("walk")]


def test_the_map_goes_on_while_a_model_thinks() -> None:
    views, grid = walk(), MetricMap()
    attention = Attention(lambda: views[0])

    def think() -> str:
        time.sleep(0.5)
        return "done"

    assert attention.during(think, grid) == "done"
    assert attention.integrated >= 1
    assert grid.is_explored([[0.5, 0.0]]).all()

    asked: list[bool] = []

    def move(until: Callable[[], bool]) -> None:
        while not until():
            time.sleep(0.01)
        asked.append(True)

    assert attention.during(think, grid, move) == "done"
    assert asked == [True]

    def fail() -> str:
        raise EnvironmentFailure("no")

    with pytest.raises(EnvironmentFailure, match="no"):
        attention.during(fail, grid)


def test_a_robot_goes_on_where_the_stages_next_waypoint_lies_ahead() -> None:
    views, grid = walk(), MetricMap()
    grid.integrate(views[0])

    def context(target: tuple[float, float] | None, forward_m: tuple[float, ...] = (0.5, 1.0)) -> ExecutorContext:
        anchor, there = Anchor("bedroom", SpaceKind.ROOM), None if target is None else (*target, 0.0)
        subtask = Subtask((anchor, anchor), 0, anchor, anchor, "front", "go", "", complete=False, target_m=there)
        obstacles, progress = ObstacleDistances(2.0, 2.0, 2.0), StageRecord(views[0].pose)
        return ExecutorContext(views[0], obstacles, (), subtask, progress, AdmissibleActions(forward_m, True, True), grid, 5)

    assert way_ahead_m(context((0.9, 0.0))) == pytest.approx(0.9, abs=0.06)
    assert way_ahead_m(context((3.0, 0.0))) in (0.0, 1.0)  # as far as is known to be free, and as control lets it
    assert way_ahead_m(context((0.9, 0.0), ())) == 0.0
    assert way_ahead_m(context(None)) == 0.0
    assert way_ahead_m(context((0.6, 0.6))) == 0.0  # aside
