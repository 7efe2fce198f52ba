"""Pages of a run and of an episode: what is in the files."""

from __future__ import annotations

import filecmp
import json
import re
import shutil
from pathlib import Path

import pytest
from small_records import PAYLOAD, write_episode, write_run

from spacevln.core import Pose, RecordError, UsageError
from spacevln.viewer import write_comparison, write_site
from spacevln.viewer.pages.charts import histogram


def data_of(page: Path) -> dict[str, object]:
    text = page.read_text()
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found
    return json.loads(found[1])


def test_every_episode_has_a_page_and_the_run_links_to_it(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    page = write_site(run)
    text = page.read_text()
    assert page == run / "index.html"
    assert text.count('href="episodes/e-') >= 3
    assert "10.0 to 90.0" in text
    assert "outside the paper" in text
    for number in range(3):
        assert (run / "episodes" / f"e-{number:03d}" / "index.html").exists()


def test_the_page_holds_the_story(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 1)
    write_site(run)
    story = data_of(run / "episodes/e-000/index.html")
    assert [step["stage"] for step in story["steps"]] == [0, 0, 0, 1, 1, 1]
    assert [step["decision"] for step in story["steps"]] == [0, 0, 0, 1, 1, 1]
    assert story["goals"] == [[1.0, 0.0, 0.0]]  # the scene's (6, 5) seen from the start (5, 5)
    assert story["stages"][0]["subtask"]["chain"][1]["status"] == "pending"
    assert story["decisions"][0]["obstacles"] == [0.4, 1.0, None]


def test_pages_of_a_copied_record_are_identical(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run")
    shutil.copytree(run, tmp_path / "copy")
    write_site(run)
    write_site(tmp_path / "copy")
    pages = [path.relative_to(run) for path in run.rglob("*.html")]
    assert len(pages) == 4
    assert not filecmp.cmpfiles(run, tmp_path / "copy", [str(page) for page in pages], shallow=False)[1]


def test_pages_elsewhere_bring_their_pictures(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 1)
    write_site(run, tmp_path / "pages")
    assert not (run / "index.html").exists()
    story = data_of(tmp_path / "pages/episodes/e-000/index.html")
    assert all((tmp_path / "pages/episodes/e-000" / step["rgb"]).exists() for step in story["steps"])


def test_a_killed_run_still_shows(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 1)
    folder = run / "episodes/e-000"
    (folder / "result.json").unlink()
    (run / "summary.json").unlink()
    events = (folder / "events.jsonl").read_text()
    (folder / "events.jsonl").write_text(events[: len(events) // 2])
    write_site(run)
    assert "no result" in (run / "index.html").read_text()
    assert data_of(folder / "index.html")["floors"] == []


def test_a_result_of_format_1_0_still_shows(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 2)
    path = run / "episodes/e-001/result.json"
    old = json.loads(path.read_text())
    del old["diagnosis"], old["usage"]
    path.write_text(json.dumps({**old, "format": "spacevln-record/1.0"}))
    summary = json.loads((run / "summary.json").read_text())
    for name in ("intervals", "diagnoses", "diagnoses_paper"):
        del summary[name]
    (run / "summary.json").write_text(json.dumps(summary))
    write_site(run)
    assert "Why episodes failed" not in (run / "index.html").read_text()


def test_the_page_names_the_decisive_step_and_both_shares(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 4)
    text = write_site(run).read_text()
    assert data_of(run / "episodes/e-001/index.html")["decisive"] == 4  # step 5
    assert data_of(run / "episodes/e-000/index.html")["decisive"] is None
    assert "100 %" in text
    assert "50 %" in text


def test_text_of_the_record_is_never_markup(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 2, PAYLOAD)
    write_site(run)
    for page in run.rglob("*.html"):
        text = page.read_text()
        assert "<img src=x" not in text
        assert "<svg onload" not in text
        assert text.count("<script") == (1 if page.parent == run else 2)


def test_missing_only_leaves_what_is_new(tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 1)
    write_site(run)
    page = run / "episodes/e-000/index.html"
    page.write_text("kept")
    write_site(run, missing_only=True)
    assert page.read_text() == "kept"


def test_the_first_differing_decision_is_named(tmp_path: Path) -> None:
    write_episode(tmp_path / "a/episodes/e", "Go.", good=True)
    write_episode(tmp_path / "b/episodes/e", "Go.", good=True, direction="left 30")
    page = write_comparison(tmp_path / "a/episodes/e", tmp_path / "b/episodes/e", tmp_path / "both")
    assert data_of(page)["differing"] == {
        "decision": None,
        "stage": 0,
        "what": "planner: direction",
        "values": ["front", "left 30"],
        "steps": [0, 0],
    }
    same = write_comparison(tmp_path / "a/episodes/e", tmp_path / "a/episodes/e", tmp_path / "same")
    assert data_of(same)["differing"] is None


def test_records_of_different_tasks_are_refused(tmp_path: Path) -> None:
    write_episode(tmp_path / "a/episodes/e", "Go.", good=True)
    write_episode(tmp_path / "b/episodes/e", "Stay.", good=True)
    with pytest.raises(UsageError, match="different tasks"):
        write_comparison(tmp_path / "a/episodes/e", tmp_path / "b/episodes/e", tmp_path / "both")


def test_no_record_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="give the directory of a run"):
        write_site(tmp_path)


@pytest.mark.parametrize("count", [1, 7, 400])
def test_a_histogram_counts_every_value(count: int) -> None:
    chart = histogram([0.37 * k for k in range(count)], "c", "s")
    assert chart is not None
    tips = re.findall(r"<title>.*?: (\d+)</title>", str(chart.svg))
    assert sum(map(int, tips)) == count


def test_poses_are_read_in_the_episode_frame() -> None:
    from spacevln.viewer.pages.story import to_episode

    assert to_episode([(6.0, 5.0, 0.0)], Pose(5.0, 5.0, 0.0, 1.5707963267948966)) == [[0.0, -1.0, 0.0]]
