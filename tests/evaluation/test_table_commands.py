"""``table``, ``compare`` and ``ablate`` as a user types them, on records that were made up."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from made_runs import made_result, write_run

from spacevln.assembly import ABLATIONS, Configuration, same_programs
from spacevln.cli.bench import bench
from spacevln.cli.compare import compare
from spacevln.cli.table import table
from spacevln.evaluation.tables.ablation import ABLATION_WORDS
from spacevln.recording import ResultFile


def made(**successes: float) -> list[ResultFile]:
    return [made_result(name, success, tags={"length_bin": "10-14" if success else "4-7"}) for name, success in successes.items()]


def test_table_prints_rows_parts_and_a_card(tmp_path: Path) -> None:
    run = write_run(tmp_path / "a", made(e1=1.0, e2=0.0))
    done = CliRunner().invoke(table, [f"mine={run}", "--by", "length_bin", "--card"], catch_exceptions=False)
    lines = [line for line in done.output.splitlines() if line.startswith("| **mine")]
    assert ["4-7" in lines[0], "10-14" in lines[1]] == [True, True]
    assert "c0ffee" in done.output
    written = CliRunner().invoke(table, [str(run), "--format", "csv", "--out", str(tmp_path / "t.csv")], catch_exceptions=False)
    assert written.exit_code == 0
    assert "houses-vln:SR" in (tmp_path / "t.csv").read_text()


def test_compare_lists_what_flipped(tmp_path: Path) -> None:
    a = write_run(tmp_path / "a", made(e1=1.0, e2=0.0, e3=0.0))
    b = write_run(tmp_path / "b", made(e1=0.0, e2=1.0, e4=1.0))
    done = CliRunner().invoke(compare, [str(a), str(b)], catch_exceptions=False)
    assert "2 common episodes; only in a: 1, only in b: 1" in done.output
    assert "won by b: 1\n  e2" in done.output
    assert "lost by b: 1\n  e1" in done.output
    assert "not diagnosed, 8.0 m -> success, 1.0 m" in done.output


@pytest.mark.parametrize("words", [("table", "nowhere"), ("table", "."), ("compare", ".", "nowhere")])
def test_what_is_no_run_is_one_sentence(words: tuple[str, ...], tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-m", "spacevln", *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "run" in done.stderr


def test_rules_run_each_program_once_and_models_all_nine() -> None:
    same = {"-P-SC": "-P-E-SC", "-P-E": "full", "-P": "full", "-E": "full"}
    assert same_programs("rules", "rules") == same
    assert same_programs("rules", "vlm") == {"-P": "full", "-E": "-P-E"}
    assert same_programs("vlm", "vlm") == {}


@pytest.mark.parametrize("form", ["md", "latex", "csv"])
def test_ablations_of_rules_are_the_papers_rows_and_those_of_text_do_not_apply(form: str, tmp_path: Path) -> None:
    same = same_programs("rules", "rules")
    runs = [
        str(write_run(tmp_path / f"without{name}", made(e1=1.0), Configuration(components=components)))
        for name, components in ABLATIONS.items()
        if name not in same
    ]
    words = [*runs, "--shape", "ablation", "--published", "--format", form]
    text = CliRunner().invoke(table, words, catch_exceptions=False).output
    mark = {"md": "|", "latex": "&", "csv": ","}[form]
    lines = [line for line in text.splitlines() if line.count(mark) > 5]
    longest_first = sorted(ABLATION_WORDS.values(), key=len, reverse=True)
    assert {next((name for name in longest_first if name in line), "") for line in lines} >= set(longest_first)
    ours = [line for line in lines if line.count("n/a") > 2]
    assert len(ours) == 4
    if form != "csv":
        assert text.count("does not apply, rules have no reasoning text") == 4


def test_ids_may_stand_in_a_file(tmp_path: Path) -> None:
    (tmp_path / "ids.txt").write_text("houses-vln-000004\n\nhouses-vln-000003\n")
    words = ["houses-vln", "--seeds", "3:6", "--dry-run", "--ids", f"@{tmp_path / 'ids.txt'}", "--ids", "houses-vln-000005"]
    assert "episodes 3 to run of 3" in CliRunner().invoke(bench, words, catch_exceptions=False).output
    refused = CliRunner().invoke(bench, ["houses-vln", "--ids", "@nowhere"])
    assert refused.exit_code == 2
    assert "one id a line" in refused.output


def test_detectors_are_shared_on_a_cluster_only(tmp_path: Path) -> None:
    words = ["houses-vln", "--seeds", "3:4", "--ray-detectors", "2", "--out", str(tmp_path / "run")]
    done = CliRunner().invoke(bench, words)
    assert done.exit_code == 2
    assert "--ray-detectors needs --ray" in done.output
