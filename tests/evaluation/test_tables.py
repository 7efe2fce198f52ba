"""Tables: the published rows as printed, ours beside them, and every format."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np
import pytest
from made_runs import THREE, made_result, made_run

from spacevln.assembly import ABLATIONS, Configuration
from spacevln.core import EpisodeStatus, UnknownNameError, UsageError
from spacevln.evaluation.diagnosis import CLASSES, PAPER_KINDS, failure_class, failure_kind
from spacevln.evaluation.runs import read_run
from spacevln.evaluation.tables import FORMATS, SHAPES, build_table, render, shape_for
from spacevln.evaluation.tables.card import reproduction_card
from spacevln.evaluation.tables.published import published, source
from spacevln.recording import CallUsage, Diagnosis, write_file


def cell(text: str, method: str, header: str) -> str:
    """A cell of a Markdown table."""
    lines = [[part.strip() for part in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    row = next(line for line in lines if method in line[0])
    return row[lines[0].index(header)]


@pytest.mark.parametrize(
    ("shape", "rows", "method", "header", "printed"),
    [
        ("vln", 15, "SpaceVLN (Qwen3.5-Plus/Flash)", "R2R-CE SR ↑", "**53.3**"),
        ("vln", 15, "GTA", "RxR-CE SPL ↑", "**39.3**"),
        ("vln", 15, "GTA", "R2R-CE NE ↓", "<u>5.0</u>"),
        ("vln", 15, "SpatialNav", "R2R-CE SR ↑", "68.0"),
        ("vln", 15, "CMA", "RxR-CE OSR ↑", "--"),
        ("gn-bench", 8, "SpaceVLN", "SR ↑", "<u>39.3</u>"),
        ("gn-bench", 8, "NaVid", "ZS", "✗"),
        ("ovon", 8, "SpaceVLN", "SPL ↑", "**33.1**"),
        ("ovon", 8, "VLFM", "TF", "✓"),
        ("ablation", 9, "w/o HSM", "SR ↑", "37.3"),
        ("ablation", 9, "Full pipeline", "Steps ↓", "**171.7**"),
        ("robot", 5, "SpaceVLN", "Overall SR ↑", "**48 (24/50)**"),
        ("runtime", 4, "122B", "Time (min) ↓", "**3.4**"),
        ("deployment", 5, "Kimi", "Planner (s) ↓", "47.29"),
        ("deployment", 5, "Qwen3.5-Plus", "Cost (USD) ↓", "**0.010**"),
    ],
)
def test_published_rows_are_as_printed(shape: str, rows: int, method: str, header: str, printed: str) -> None:
    table = published(shape)
    assert table is not None
    assert len(table.rows) == rows
    text = render(build_table([], shape, with_published=True), "md")
    assert cell(text, method, header) == printed
    assert source() in text


def test_ours_stands_beside_the_published_rows_with_one_decimal() -> None:
    text = render(build_table([made_run("mine", THREE)], "vln", with_published=True), "md")
    assert cell(text, "mine", "R2R-CE SR ↑") == "**66.7**"
    assert cell(text, "mine", "R2R-CE NE ↓") == "**3.3**"
    assert cell(text, "Plus/Flash", "R2R-CE SR ↑") == "<u>53.3</u>"
    assert cell(text, "mine", "RxR-CE SR ↑") == "--"
    assert "mine: 3 episodes of r2r-ce val_unseen; 3 stopped" in text


def test_one_method_on_two_benchmarks_is_one_row() -> None:
    runs = [made_run("mine", THREE), made_run("mine", THREE[2:], "rxr-ce val_unseen language=en-US")]
    table = build_table(runs, shape_for(runs))
    assert [row.method for row in table.rows] == ["mine"]
    text = render(table, "md")
    assert (cell(text, "mine", "R2R-CE SR ↑"), cell(text, "mine", "RxR-CE SR ↑")) == ("66.7", "0.0")


def test_intervals_are_printed_when_asked_for() -> None:
    table = build_table([made_run("mine", THREE * 1 + [made_result("4", 0.0)])], "vln")
    assert cell(render(table, "md", intervals=True), "mine", "SR ↑") == "50.0 [0.0, 100.0]"
    assert cell(render(table, "md"), "mine", "SR ↑") == "50.0"


def test_ablations_are_named_and_flagged_by_their_configuration() -> None:
    runs = [made_run(name, THREE, configuration=Configuration(components=components)) for name, components in ABLATIONS.items()]
    table = build_table(runs, "ablation")
    assert [row.method for row in table.rows][::4] == ["w/o HSM+L-LM", "w/o P-SCoT+SC", "Full pipeline"]  # the paper's order
    text = render(table, "md")
    assert cell(text, "w/o HSM+L-LM", "HSM") == "✗"
    assert cell(text, "w/o P-SCoT+SC", "SC") == "✗"
    assert cell(text, "w/o P-SCoT+SC", "P-SCoT") == "n/a"  # rules have no prompt to leave fields out of


def test_robot_areas_come_from_tags() -> None:
    results = [made_result("1", tags={"area": "Hall"}), made_result("2", 0.0, tags={"area": "Office"})]
    text = render(build_table([made_run("mine", results, "robot")], "robot"), "md")
    assert cell(text, "mine", "Hall SR ↑") == "100 (1/1)"
    assert cell(text, "mine", "Overall SR ↑") == "50 (1/2)"
    assert cell(text, "mine", "Overall NE ↓") == "4.50"


def test_costs_and_rates() -> None:
    usage = {"planner": CallUsage(calls=4, unusable=1, usd=0.02), "executor": CallUsage(calls=16, usd=0.03)}
    paid = made_run("paid", [made_result("1", usage=usage)])
    unpriced = made_run("unpriced", [made_result("1", usage={"planner": CallUsage(calls=4, unpriced=4)})])
    text = render(build_table([paid, unpriced], "calls"), "md")
    assert cell(text, "paid", "Cost (USD) ↓") == "0.0500"
    assert cell(text, "unpriced", "Cost (USD) ↓") == "--"  # an unknown price is not zero
    assert cell(text, "paid", "unusable replies (%) ↓") == "<u>5.0</u>"
    assert cell(text, "paid", "Planner (s) ↓") == "2.50"
    deployment = render(build_table([paid], "deployment"), "md")
    assert cell(deployment, "paid", "Time (min) ↓") == "2.00"
    assert "GPU (GB)" not in render(build_table([paid], "runtime"), "md")  # nothing was measured there


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("form", FORMATS)
def test_every_shape_in_every_format(shape: str, form: str) -> None:
    run = made_run("a_b & 50%", [*THREE, made_result("4", tags={"area": "Hall"})])
    text = render(build_table([run], shape, with_published=True), form, intervals=True)
    assert text.endswith("\n")
    if form == "csv":
        rows = list(csv.reader(io.StringIO(text)))
        assert len({len(row) for row in rows}) == 1
    elif form == "md":
        assert len({line.count("|") for line in text.splitlines() if line.startswith("|")}) == 1
    else:
        body = [line for line in text.splitlines() if not line.startswith("%")]
        assert shape == "ablation" or any(r"a\_b \& 50\%" in line for line in body)
        assert text.count(r"\begin{") == text.count(r"\end{")
        assert len({line.count(" & ") for line in body if line.endswith(r"\\") and "multicolumn" not in line}) == 1


def test_unknown_shapes_and_formats_are_named() -> None:
    with pytest.raises(UnknownNameError, match="ablation"):
        build_table([], "abblation")
    with pytest.raises(UnknownNameError, match="latex"):
        render(build_table([], "vln"), "tex")


def test_failures_are_told_apart() -> None:
    diagnosis = Diagnosis(name="budget", paper="outside the paper", reason="It ran out of steps.")
    failed = made_result("1", 0.0).model_copy(update={"diagnosis": diagnosis})
    assert (failure_class(failed), failure_kind(failed)) == ("budget", "outside the paper")
    assert failure_class(made_result("2", 0.0)) == "not diagnosed"  # a result of format 1.1
    assert failure_class(made_result("3")) is None
    run = made_run("x", [failed, made_result("2", 0.0), made_result("3")])
    for names, shape in ((CLASSES, "failures"), (PAPER_KINDS, "errors")):
        shares = {name: np.mean(list(run.values(name).values())) for name in names}
        assert sum(shares.values()) == pytest.approx(200 / 3)
        assert shares["not diagnosed"] == pytest.approx(100 / 3)
        assert "not diagnosed (%)" in render(build_table([run], shape), "md")


def test_runs_are_read_back(tmp_path: Path) -> None:
    run = made_run("x", THREE)
    write_file(tmp_path / "run.json", run.file)
    with pytest.raises(UsageError, match="no result"):
        read_run(str(tmp_path))
    for result in [*THREE, made_result("9", status=EpisodeStatus.INTERRUPTED)]:
        folder = tmp_path / "episodes" / result.episode_id
        folder.mkdir(parents=True)
        write_file(folder / "result.json", result)
    write_file(tmp_path / "episodes/1/resources.json", run.resources["1"])
    read = read_run(f"name={tmp_path}")
    assert read.label == "name"
    assert list(read.results) == ["1", "2", "3"]
    assert read.values("SR") == {"1": 100.0, "2": 100.0, "3": 0.0}
    assert read.values("planner_s") == {"1": 2.5}
    with pytest.raises(UsageError, match="Unknown metric"):
        read.values("beauty")
    card = reproduction_card(read)
    for fact in ("c0ffee", "f00d", "numpy 2", "abc", "2026-01-01", "rules reason", "hardware: P"):
        assert fact in card
    assert not math.isnan(sum(read.values("NE").values()))
