"""``table``, ``compare`` and ``ablate`` as a user types them, on records that were made up."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from spacevln.assembly import ABLATIONS, Configuration
from spacevln.cli.ablate import distinct_presets
from spacevln.cli.compare import compare
from spacevln.cli.table import table
from spacevln.core import EpisodeStatus, StopReason
from spacevln.recording import Metrics, ResultFile, RunFile, write_file


def write_run(folder: Path, successes: dict[str, float]) -> Path:
    run = RunFile(
        version="1",
        suite="houses-vln seeds 0:4",
        created="2026-01-01",
        command=("spacevln", "bench"),
        configuration=Configuration().model_dump(mode="json"),
        configuration_hash="c0ffee",
        packages={},
        python="3.12",
        platform="x",
        git_revision=None,
    )
    folder.mkdir(parents=True)
    write_file(folder / "run.json", run)
    for name, success in successes.items():
        metrics = Metrics(
            SR=success,
            SPL=success,
            OSR=success,
            NE=0.0 if success else 9.0,
            path_length=1.0,
            steps=9,
            lookaround_steps=0,
            align_steps=0,
            collisions=0,
            stages=1,
            rejections=0,
            fallbacks=0,
        )
        result = ResultFile(
            episode_id=name,
            scene="house-000001",
            task_kind="vln",
            task_text="Leave the room.",
            status=EpisodeStatus.STOPPED,
            stop_reason=StopReason.GATE,
            forced_stop=False,
            detail="",
            metrics=metrics,
            truth=None,
            tags={"length_bin": "10-14" if success else "4-7"},
            timing_s=1.0,
        )
        (folder / "episodes" / name).mkdir(parents=True)
        write_file(folder / "episodes" / name / "result.json", result)
    return folder


def test_table_prints_rows_parts_and_a_card(tmp_path: Path) -> None:
    run = write_run(tmp_path / "a", {"e1": 1.0, "e2": 0.0})
    done = CliRunner().invoke(table, [f"mine={run}", "--by", "length_bin", "--card"], catch_exceptions=False)
    lines = [line for line in done.output.splitlines() if line.startswith("| **mine")]
    assert ["4-7" in lines[0], "10-14" in lines[1]] == [True, True]
    assert "c0ffee" in done.output
    written = CliRunner().invoke(table, [str(run), "--format", "csv", "--out", str(tmp_path / "t.csv")], catch_exceptions=False)
    assert written.exit_code == 0
    assert "houses-vln:SR" in (tmp_path / "t.csv").read_text()


def test_compare_lists_what_flipped(tmp_path: Path) -> None:
    a = write_run(tmp_path / "a", {"e1": 1.0, "e2": 0.0, "e3": 0.0})
    b = write_run(tmp_path / "b", {"e1": 0.0, "e2": 1.0, "e4": 1.0})
    done = CliRunner().invoke(compare, [str(a), str(b)], catch_exceptions=False)
    assert "2 common episodes; only in a: 1, only in b: 1" in done.output
    assert "won by b: 1\n  e2" in done.output
    assert "lost by b: 1\n  e1" in done.output
    assert "not diagnosed, 9.0 m -> success, 0.0 m" in done.output


@pytest.mark.parametrize("words", [("table", "nowhere"), ("table", "."), ("compare", ".", "nowhere")])
def test_what_is_no_run_is_one_sentence(words: tuple[str, ...], tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-m", "spacevln", *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "run" in done.stderr


def test_rules_run_each_program_once_and_models_all_nine() -> None:
    presets, same = distinct_presets(Configuration())
    assert list(presets) == ["full", "-HSM-LLM", "-HSM", "-LLM", "-P-E-SC"]
    assert same == {"-P-SC": "-P-E-SC", "-P-E": "full", "-P": "full", "-E": "full"}
    assert not presets["-P-E-SC"].components.stagewise
    written, none = distinct_presets(
        Configuration.model_construct(**{**dict(Configuration()), "planner": "vlm", "executor": "vlm"})
    )
    assert list(written) == list(ABLATIONS)
    assert none == {}
