"""Habitat-Sim's stand-in in another interpreter, as the tests use it."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("msgpack", reason="`make test` installs it")

from spacevln.core import EpisodeSpec, InstructionTask
from spacevln.environments.bridge.frame import pose_from_habitat
from spacevln.environments.habitat.environment import HabitatEnvironment
from spacevln.environments.habitat.setup import HabitatSetup

HERE = Path(__file__).parent
DATA = HERE / "data"
SCENE = "synthetic/house/house.glb"
RECORDS: dict[str, Any] = json.loads(gzip.decompress((DATA / "records.json.gz").read_bytes()))
OLD = os.environ.get("SPACEVLN_TEST_PYTHON38") or shutil.which("python3.8") or ""
VERSIONS = ("0.2.2", "0.3.4")


@cache
def old_python() -> str:
    """A Python 3.8 with numpy and msgpack; the test is skipped where there is none."""
    wanted = "import sys, numpy, msgpack; sys.exit(sys.version_info[:2] != (3, 8))"
    if not OLD or subprocess.run([OLD, "-c", wanted], capture_output=True, check=False).returncode:
        pytest.skip("no Python 3.8 with numpy and msgpack: name one in SPACEVLN_TEST_PYTHON38")
    return OLD


def interpreter(which: str) -> str:
    return sys.executable if which == "current" else old_python()


def use_standin(monkeypatch: pytest.MonkeyPatch, version: str, fault: str = "") -> None:
    """Let workers find the stand-in, as that version."""
    import msgpack

    ours = [str(HERE / "standin")]
    if "site-packages" not in msgpack.__file__:  # a library folder of its own holds nothing else
        ours.append(str(Path(msgpack.__file__).parents[1]))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(ours))
    monkeypatch.setenv("HABITAT_STANDIN", version)
    monkeypatch.setenv("HABITAT_STANDIN_FAULT", fault)


def scenes(folder: Path) -> Path:
    """A folder of scenes with the house in it; the stand-in draws its own and only wants the file to be there."""
    path = folder / SCENE
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes((DATA / "house.npz").read_bytes())
    return folder


def setup(folder: Path, which: str = "current", **changed: Any) -> HabitatSetup:
    return HabitatSetup(**{"python": interpreter(which), "scenes": str(scenes(folder)), "gpu_device": -1, **changed})


def small(folder: Path, **changed: Any) -> HabitatEnvironment:
    times = {name: changed.pop(name) for name in ("answer_s", "open_s") if name in changed}
    return HabitatEnvironment(setup(folder, **{"width_px": 64, "height_px": 48, **changed}), **times)


def episode(position: Any = (3.5, 0.1, 1.5), rotation: Any = (0.0, 1.0, 0.0, 0.0)) -> EpisodeSpec:
    return EpisodeSpec("1", SCENE, pose_from_habitat(position, rotation), InstructionTask("go on"))
