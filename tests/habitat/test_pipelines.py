"""R2R-CE, RxR-CE and HM3D-OVON from file to table, through the bridge, on the recorded house."""

from __future__ import annotations

import gzip
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from bridge_world import DATA, RECORDS, interpreter, scenes, use_standin


def rxr(folder: Path) -> Path:
    """The recorded routes as RxR-CE writes them."""
    content = json.loads(gzip.decompress((DATA / "val_unseen.json.gz").read_bytes()))
    paths = json.loads(gzip.decompress((DATA / "val_unseen_gt.json.gz").read_bytes()))
    for each in content["episodes"]:
        words = each["instruction"]["instruction_text"]
        each.update(episode_id=str(each["episode_id"]), trajectory_id=str(each["trajectory_id"]), info={"role": "guide"})
        said = {"instruction_id": each["episode_id"], "language": "en-US", "annotator_id": "0", "edit_distance": 0.1}
        each["instruction"] = {"instruction_text": words, "timed_instruction": [], **said}
    where = folder / "val_unseen"
    where.mkdir(parents=True)
    (where / "val_unseen_guide.json.gz").write_bytes(gzip.compress(json.dumps({"episodes": content["episodes"]}).encode()))
    (where / "val_unseen_guide_gt.json.gz").write_bytes(gzip.compress(json.dumps(paths).encode()))
    return folder


def spacevln(*words: str) -> str:
    paths = os.pathsep.join([*filter(None, sys.path), os.environ["PYTHONPATH"]])
    command = [sys.executable, "-m", "spacevln", *words]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=280, env={**os.environ, "PYTHONPATH": paths}, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def place(tmp_path: Path) -> list[str]:
    """Options that say where Habitat-Sim is."""
    folder = str(scenes(tmp_path / "scenes"))
    return ["--habitat-python", interpreter("current"), "--scenes", folder, "--gpu-device", "-1"]


def run(suite: str, data: Path, tmp_path: Path, *more: str) -> dict[str, Any]:
    out = tmp_path / f"out-{suite}"
    spacevln("bench", suite, "--data", str(data), *place(tmp_path), "--out", str(out), *more)
    assert "SR" in spacevln("table", str(out))
    found: dict[str, Any] = json.loads((out / "summary.json").read_text())
    return found


@pytest.fixture(autouse=True)
def _standin(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    monkeypatch.setenv("HABITAT_STANDIN_COARSE", "8")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


@pytest.mark.slow
def test_the_reference_follower_reaches_every_goal_of_r2r_ce(tmp_path: Path) -> None:
    found = run("r2r-ce", DATA, tmp_path, "--driver", "oracle", "--episodes", "4")
    assert found["metrics"]["SR"] == 100
    assert found["metrics"]["SPL"] > 90
    assert found["metrics"]["nDTW"] > 80
    configuration = json.loads((tmp_path / "out-r2r-ce" / "run.json").read_text())["configuration"]
    assert configuration["environment"]["agent_radius_m"] == 0.1
    assert configuration["step_budget"] == 260
    first = json.loads((tmp_path / "out-r2r-ce" / "episodes" / "1" / "result.json").read_text())
    recorded = RECORDS["traces"]["034"]["d01/r010/slide"]["metrics"]["start_distance"]
    assert first["truth"]["geodesic_m"] == pytest.approx(recorded, rel=1e-3)


@pytest.mark.slow
def test_the_recorded_paths_lead_to_every_goal_and_one_episode_runs_by_itself(tmp_path: Path) -> None:
    found = run("r2r-ce", DATA, tmp_path, "--driver", "reference", "--episodes", "4")
    assert found["metrics"]["SR"] == 100
    assert found["metrics"]["nDTW"] > 80
    one = ["--suite", "r2r-ce", "--data", str(DATA), "--id", "3", "--steps", "30", "--out", str(tmp_path / "one")]
    said = spacevln("run", *one, *place(tmp_path))
    assert "from the goal" in said
    assert (tmp_path / "one" / "episodes" / "3" / "topdown.png").exists()


@pytest.mark.slow
def test_doctor_looks_into_a_building(tmp_path: Path) -> None:
    said = spacevln("doctor", *place(tmp_path), "--data", str(DATA))
    assert "Habitat-Sim 0.3.3 answers" in said
    assert "12 episodes of r2r-ce" in said
    assert "navigation mesh of 59 m2, computed" in said
    assert "a frame of 640x480 pixels" in said
    assert "the way to the goal is 8.6" in said


@pytest.mark.slow
def test_the_reference_follower_reaches_goals_of_rxr_ce(tmp_path: Path) -> None:
    assert run("rxr-ce", rxr(tmp_path / "rxr"), tmp_path, "--driver", "oracle", "--episodes", "1")["metrics"]["SR"] == 100


@pytest.mark.slow
def test_the_reference_follower_reaches_goals_of_ovon(tmp_path: Path) -> None:
    found = run("hm3d-ovon", DATA / "ovon", tmp_path, "--driver", "oracle", "--episodes", "1")
    assert found["metrics"]["SR"] == 100
    assert found["episodes"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("suite", ["r2r-ce", "rxr-ce", "hm3d-ovon"])
def test_the_agent_runs(suite: str, tmp_path: Path) -> None:
    data = {"r2r-ce": DATA, "rxr-ce": rxr(tmp_path / "rxr"), "hm3d-ovon": DATA / "ovon"}[suite]
    found = run(suite, data, tmp_path, "--episodes", "1", "--steps", "40")
    assert found["episodes"] == 1
    assert set(found["statuses"]) <= {"stopped", "step_limit"}
