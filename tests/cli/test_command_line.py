"""The real command line: what a user types, and what a user types wrong."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from spacevln.recording import ResultFile, SummaryFile, read_events, read_file

COMMAND = (sys.executable, "-m", "spacevln")


def spacevln(*words: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *words], cwd=cwd, capture_output=True, text=True, timeout=280, env={**os.environ, **environment}, check=False
    )


def assert_one_sentence(done: subprocess.CompletedProcess[str]) -> None:
    assert "Traceback" not in done.stdout + done.stderr
    assert done.stderr.strip()


@pytest.fixture(scope="module")
def short_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    folder = tmp_path_factory.mktemp("run")
    return folder / "out", spacevln("run", "--seed", "3", "--steps", "40", "--out", "out", cwd=folder)


def test_run_leaves_a_complete_record(short_run: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    out, done = short_run
    assert done.returncode == 0, done.stderr
    assert "result   status" in done.stdout
    (folder,) = (out / "episodes").iterdir()
    result = read_file(folder / "result.json", ResultFile)
    assert result.metrics.steps <= 40
    assert result.truth is not None
    assert result.metrics.NE is not None
    summary = read_file(out / "summary.json", SummaryFile)
    assert summary.episodes == 1
    assert set(summary.metrics) >= {"SR", "SPL", "OSR", "NE", "nDTW", "steps"}
    assert sum(summary.statuses.values()) == 1
    assert (folder / "topdown.png").stat().st_size > 1000
    events = list(read_events(folder))
    named = [event.rgb for event in events if event.event == "step_taken" and event.rgb]
    named += [
        event.memory.map_image for event in events if event.event == "looked_around" and event.memory and event.memory.map_image
    ]
    assert len(named) > 10
    assert all((folder / name).exists() for name in named)
    kinds = [event.event for event in events]
    assert (kinds[0], kinds[-1]) == ("episode_started", "episode_ended")
    assert kinds.count("step_taken") == result.metrics.steps


def test_the_same_command_resumes_and_keeps_the_first_result(short_run: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    out, _ = short_run
    (result,) = out.glob("episodes/*/result.json")
    before = result.read_bytes()
    done = spacevln("run", "--seed", "3", "--steps", "40", "--out", str(out), cwd=out.parent)
    assert done.returncode == 0
    assert result.read_bytes() == before


def test_another_configuration_does_not_enter_the_directory(short_run: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    out, _ = short_run
    done = spacevln("run", "--seed", "3", "--steps", "41", "--out", str(out), cwd=out.parent)
    assert done.returncode == 2
    assert_one_sentence(done)
    assert "another --out" in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ("run", "--task", "dance"),
        ("run", "--instruction", ""),
        ("run", "--instruction", "  "),
        ("run", "--instruction", "go " * 10_000),
        ("run", "--goal", "sofa"),
        ("run", "--task", "objectnav", "--instruction", "Go."),
        ("run", "--task", "objectnav", "--goal", "unicorn"),
        ("run", "--seed", "-1"),
        ("run", "--out", "/proc/nowhere"),
        ("bench", "houses-nln"),
        ("bench", "houses-vln", "--seeds", "9:3"),
        ("bench", "houses-vln", "--seeds", "a:b"),
        ("bench", "houses-vln", "--workers", "0"),
        ("houses", "render", "--seed", "x"),
        ("fly",),
    ],
)
def test_wrong_usage_is_one_clear_sentence(words: tuple[str, ...], tmp_path: Path) -> None:
    done = spacevln(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert_one_sentence(done)


def test_a_suite_that_needs_more_names_what(tmp_path: Path) -> None:
    done = spacevln("bench", "r2r-ce", cwd=tmp_path)
    assert done.returncode == 3
    assert "Habitat" in done.stderr


@pytest.mark.parametrize("instruction", ["🏠➡️🛋️", "去厨房然后停下", "xyzzy plugh"])
def test_an_instruction_that_says_nothing_ends_typed(instruction: str, tmp_path: Path) -> None:
    done = spacevln("run", "--seed", "3", "--steps", "30", "--instruction", instruction, "--out", "out", cwd=tmp_path)
    assert "Traceback" not in done.stdout + done.stderr
    (path,) = tmp_path.glob("out/episodes/*/result.json")
    result = read_file(path, ResultFile)
    assert result.metrics.SR is None
    assert (done.returncode == 1) == (result.status == "model_failure")


def test_doctor_says_what_draws(tmp_path: Path) -> None:
    done = spacevln("doctor", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "renderer" in done.stdout
    forced = spacevln("doctor", cwd=tmp_path, SPACEVLN_RENDERER="raycast")
    assert "raycast" in forced.stdout


def test_interrupt_ends_quickly_with_a_complete_record(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [*COMMAND, "run", "--seed", "3", "--out", "out"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    events = tmp_path / "out/episodes/houses-vln-000003/events.jsonl"
    deadline = time.monotonic() + 120
    while not (events.exists() and events.read_text().count("step_taken") > 5):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=30)
    assert process.returncode == 130
    assert time.monotonic() - begin < 10  # 2 s on an idle machine; tests may share theirs
    result = json.loads((events.parent / "result.json").read_text())
    assert result["status"] == "interrupted"
    assert [event.event for event in read_events(events.parent)][-1] == "episode_ended"
