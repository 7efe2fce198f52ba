"""Attempts: the agent cannot use the truth, results repeat, workers may die, and nothing is counted twice."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_runs import plain_results, workers_of

from spacevln.agent import NavigationAgent
from spacevln.assembly import Configuration, ModelPair, PromptOptions
from spacevln.core import Environment, EpisodeSpec, EventSink, InstructionTask, Pose, SpendingLimit, UsageError
from spacevln.environments.houses.episodes import Grounds, route_episode
from spacevln.environments.houses.house import build_house
from spacevln.evaluation import attempt, datasets
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.baselines import BLIND_FORWARDS
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.houses import RouteTruth, densify, house_episode, pick_episode
from spacevln.evaluation.probes import probe
from spacevln.models import ModelChoice
from spacevln.perception import LabelDetector
from spacevln.recording import RecordLevel, read_events
from spacevln.recording.schema import EpisodeEndedLine, StepTakenLine
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import ScriptedExecutor, ScriptedPlanner

SHORT = Configuration(step_budget=34)


def actions(directory: Path) -> list[tuple[str, str, Pose]]:
    return [(line.phase, line.action, line.pose) for line in read_events(directory) if isinstance(line, StepTakenLine)]


def test_another_goal_behind_the_same_instruction_changes_no_action(tmp_path: Path) -> None:
    episode = house_episode("houses-vln-000003")
    other = house_episode("houses-vln-000004")
    assert isinstance(other.truth, RouteTruth)
    swapped = replace(episode, truth=other.truth)
    with Session(SHORT) as session:
        first = session.attempt(episode, tmp_path / "a", level=RecordLevel.LIGHT)
        second = session.attempt(swapped, tmp_path / "b", level=RecordLevel.LIGHT)
    assert actions(tmp_path / "a") == actions(tmp_path / "b")
    assert first.metrics.NE != second.metrics.NE


def test_a_repeated_attempt_differs_in_its_time_only(tmp_path: Path) -> None:
    episode = house_episode("houses-objectnav-000003")
    results = []
    for name in ("a", "b"):
        with Session(SHORT) as session:
            results.append(
                session.attempt(episode, tmp_path / name, level=RecordLevel.LIGHT).model_copy(update={"timing_s": 0.0})
            )
    assert results[0] == results[1]


@pytest.mark.parametrize("suite", ["houses-vln", "houses-objectnav"])
def test_the_oracle_succeeds_and_the_blind_do_not_look(suite: str, tmp_path: Path) -> None:
    episode = datasets.load(suite, seeds=(5, 6))[0]
    for driver in ("oracle", "random", "forward"):
        with Session(Configuration(driver=driver)) as session:
            result = session.attempt(episode, tmp_path / driver, level=RecordLevel.LIGHT)
        if driver == "oracle":
            assert result.metrics.SR == 1.0
            assert result.metrics.SPL is not None
            assert result.metrics.SPL > 0.9
        else:
            forwards = [action for _, action, _ in actions(tmp_path / driver) if action.startswith("forward")]
            assert len(forwards) == BLIND_FORWARDS


def test_the_frontier_walker_looks_around_then_gets_about(tmp_path: Path) -> None:
    with Session(Configuration(driver="frontier", step_budget=60)) as session:
        result = session.attempt(house_episode("houses-objectnav-000005"), tmp_path, level=RecordLevel.LIGHT)
    taken = [action for _, action, _ in actions(tmp_path)]
    look_around = ["left 30"] * 12
    assert taken[:12] == look_around
    forwards = [index for index, action in enumerate(taken) if action.startswith("forward")]
    assert look_around in [taken[index : index + 12] for index in range(forwards[0], 60)]  # it reached a frontier
    assert result.metrics.steps == 60
    unblocked_m = 0.25 * (len(forwards) - result.metrics.collisions)
    assert unblocked_m <= result.metrics.path_length <= 0.25 * len(forwards)
    assert result.metrics.path_length > 1.0  # 24 and more of its 59 moves look around; the first frontier is 1 m away


def test_a_free_instruction_claims_nothing(tmp_path: Path) -> None:
    episode = pick_episode("vln", 3, instruction="Leave the room.")
    assert episode.truth is None
    with Session(SHORT) as session:
        result = session.attempt(episode, tmp_path, level=RecordLevel.LIGHT)
    assert result.metrics.SR is None
    assert result.truth is None
    assert result.metrics.steps > 0


def test_a_bug_is_recorded_and_counted_not_raised(tmp_path: Path) -> None:
    episode = house_episode("houses-vln-000003")
    broken = Episode(EpisodeSpec("broken", "house-x", episode.start, InstructionTask("Go.")), episode.truth)
    with Session(SHORT) as session:
        result = session.attempt(broken, tmp_path, level=RecordLevel.LIGHT)
    assert result.status == "environment_failure"
    assert result.metrics.SR == 0.0
    assert "house-x" in (tmp_path / "crash.txt").read_text()


def test_a_spent_purse_ends_the_run_and_leaves_the_episode_to_be_resumed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def poor(_: Configuration, environment: Environment, sinks: Sequence[EventSink], *__: object) -> NavigationAgent:
        planner = ScriptedPlanner([SpendingLimit("The run has spent 5 USD.")])
        return NavigationAgent(environment, LabelDetector(), planner, ScriptedExecutor(), None, sinks)

    monkeypatch.setattr(attempt, "build_agent", poor)
    spec = EpisodeSpec("e", "flatland", Pose(0.0, 0.0), InstructionTask("Go."))
    with Session(SHORT, Flatland()) as session, pytest.raises(SpendingLimit, match="5 USD"):
        session.attempt(Episode(spec, None), tmp_path, level=RecordLevel.LIGHT)
    assert not (tmp_path / "result.json").exists()
    last = list(read_events(tmp_path))[-1]
    assert isinstance(last, EpisodeEndedLine)
    assert (last.status, last.stop_reason, last.stopped) == ("interrupted", "spending", True)


def test_settings_that_do_not_fit_the_body_are_told_before_anything_begins() -> None:
    relay = ModelChoice(profile="relay", model="talk")
    wrong = Configuration(
        planner="vlm", executor="vlm", models=ModelPair(planner=relay, executor=relay), prompts=PromptOptions(view_count=5)
    )
    with pytest.raises(UsageError, match=r"^view_count=5 does not divide the 12 views of a look-around: use 1, 2, "):
        Session(wrong, Flatland())


def test_only_what_can_film_the_robot_is_asked_to(tmp_path: Path) -> None:
    with Session(SHORT, Flatland()) as session, pytest.raises(UsageError, match="only the embedded houses can film the robot"):
        session.attempt(house_episode("houses-vln-000003"), tmp_path / "a", chase=True)


def test_probes_change_the_words_and_not_the_goal() -> None:
    episode = house_episode("houses-vln-000003")
    swapped, last = probe(episode, "swapped"), probe(episode, "last-noun")
    assert swapped.truth is episode.truth
    assert swapped.instruction != episode.instruction
    assert last.instruction is not None
    assert last.instruction.startswith("Walk to the ")
    with pytest.raises(UsageError, match="houses-vln"):
        probe(house_episode("houses-objectnav-000003"), "swapped")


def test_an_instruction_that_leads_elsewhere_ends_out_of_the_goals_radius() -> None:
    episode = house_episode("houses-vln-000003")
    assert episode.truth is not None
    text = probe(episode, "elsewhere").instruction
    grounds = Grounds(build_house(3))
    others = [route_episode(grounds, seed, "dev") for seed in range(100, 106)]
    (goal,) = [other.goals[0] for other in others if other.spec.task == InstructionTask(text or "")]
    assert text != episode.instruction
    assert episode.truth.distances_m(np.array([goal]))[0] > 3.0


def test_the_reference_is_dense_and_keeps_its_ends() -> None:
    path = np.array([[0.0, 0, 0], [1.1, 0, 0], [1.1, 2, 0]])
    dense = densify(path, 0.25)
    assert np.linalg.norm(np.diff(dense, axis=0), axis=1).max() <= 0.25 + 1e-9
    assert np.array_equal(dense[[0, -1]], path[[0, -1]])


def test_loading_refuses_what_it_does_not_know() -> None:
    for call in (
        lambda: datasets.load("houses-nln"),
        lambda: datasets.load("houses-vln", colour="red"),
        lambda: datasets.load("houses-vln", seeds=(4, 4)),
    ):
        with pytest.raises(UsageError):
            call()


def bench(out: Path, *words: str) -> subprocess.Popen[bytes]:
    command = [
        sys.executable,
        "-m",
        "spacevln",
        "bench",
        "houses-vln",
        "--seeds",
        "3:6",
        "--steps",
        "60",
        "--out",
        str(out),
        *words,
    ]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.slow
def test_workers_their_deaths_and_a_killed_runner_do_not_change_results(tmp_path: Path) -> None:
    calm = bench(tmp_path / "calm", "--workers", "1")
    assert calm.wait(timeout=280) == 0
    rough = bench(tmp_path / "rough", "--workers", "2")
    deadline = time.monotonic() + 120
    while not list((tmp_path / "rough").glob("episodes/*/images/*")):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    os.kill(workers_of(rough.pid)[0], signal.SIGKILL)
    time.sleep(6)
    rough.kill()
    rough.wait(timeout=30)
    assert bench(tmp_path / "rough", "--workers", "2").wait(timeout=280) == 0
    assert plain_results(tmp_path / "rough") == plain_results(tmp_path / "calm")
    assert len(plain_results(tmp_path / "rough")) == 3
    assert (tmp_path / "rough/summary.json").read_bytes() == (tmp_path / "calm/summary.json").read_bytes()
