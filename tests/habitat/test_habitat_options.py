"""Which interpreter, whose settings: what the command line makes of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from spacevln.assembly import Configuration, HabitatSettings
from spacevln.assembly.benchmark_presets import PRESETS
from spacevln.cli.habitat_options import in_simulator, python_of
from spacevln.core import PrerequisiteError, UnknownNameError, UsageError


def conda(folder: Path, monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    """A conda that does one thing."""
    folder.mkdir(exist_ok=True)
    (folder / "conda").write_text(f"#!/bin/sh\n{line}\n")
    (folder / "conda").chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/bin:/usr/bin")


def test_a_path_or_an_address_is_taken_as_it_is() -> None:
    assert python_of("/opt/habitat/bin/python") == "/opt/habitat/bin/python"
    assert python_of("tcp://there:5000") == "tcp://there:5000"


def test_a_conda_environment_is_asked_for_its_interpreter(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    conda(tmp_path, monkeypatch, 'echo "a banner"; test "$3" = habitat && echo /envs/habitat/bin/python')
    assert python_of("conda:habitat") == "/envs/habitat/bin/python"
    with pytest.raises(PrerequisiteError, match=r"no usable environment 'other'"):
        python_of("conda:other")
    monkeypatch.setenv("PATH", str(tmp_path / "none"))
    with pytest.raises(PrerequisiteError, match=r"needs conda on PATH"):
        python_of("conda:habitat")


@pytest.mark.parametrize(("suite", "steps"), [("r2r-ce", 260), ("rxr-ce", 260), ("hm3d-ovon", 280)])
def test_the_papers_budgets_and_the_official_ones(suite: str, steps: int) -> None:
    assert PRESETS[suite]["paper"].step_budget == steps
    assert PRESETS[suite]["official"].step_budget == 500


def test_the_source_fills_the_settings_and_the_user_goes_first(tmp_path: Path) -> None:
    options: dict[str, Any] = {
        "habitat_python": sys.executable,
        "scenes": tmp_path,
        "scene_dataset": None,
        "settings": "official",
        "gpu_device": -1,
    }
    found = in_simulator(Configuration(), "rxr-ce", options)
    assert isinstance(found.environment, HabitatSettings)
    assert (found.environment.sliding, found.environment.agent_radius_m, found.step_budget) == (False, 0.18, 500)
    found = in_simulator(Configuration(step_budget=7), "rxr-ce", options, sliding=True)
    assert isinstance(found.environment, HabitatSettings)
    assert (found.environment.sliding, found.step_budget) == (True, 7)
    with pytest.raises(UnknownNameError):
        in_simulator(Configuration(), "rxr-ce", {**options, "settings": "offical"})
    with pytest.raises(PrerequisiteError, match=r"--habitat-python"):
        in_simulator(Configuration(), "rxr-ce", {**options, "habitat_python": None})
    with pytest.raises(UsageError, match=r"--scenes"):
        in_simulator(Configuration(), "rxr-ce", {**options, "scenes": None})
