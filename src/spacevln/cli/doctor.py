"""``spacevln doctor``: what is installed, reachable, missing, and the command that mends it."""

from __future__ import annotations

import importlib.util
import os
import platform
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import click

from spacevln import __version__
from spacevln.cli.doctor_models import keys, model_findings
from spacevln.cli.findings import Finding
from spacevln.cli.habitat_options import habitat_options
from spacevln.cli.model_options import choice_options

BASE = ("mujoco", "numba", "numpy", "opencv-python-headless", "pydantic", "scipy")
EXTRAS = (
    ("openai", "vlm", "vision-language models as planner and executor"),
    ("transformers", "perception", "open-vocabulary detectors and segmenters"),
    ("onnxruntime", "onnx", "a segmenter without torch"),
    ("gymnasium", "gym", "the Gymnasium environment spacevln/Houses-v0"),
    ("spacevln_bridge", "habitat", "Habitat-Sim and GN-Bench, in a Python of their own"),
    ("trimesh", "export", "writing houses as .glb files"),
    ("rosbags", "robot", "ROS 2 robots without a ROS installation, and ROS 2 bags"),
)


@click.command()
@choice_options
@habitat_options
@click.option(
    "--suite",
    type=click.Choice(["r2r-ce", "rxr-ce", "hm3d-ovon", "gn-bench"]),
    default="r2r-ce",
    help="Of --data; gn-bench asks for its own simulator.",
)
@click.option("--data", type=click.Path(path_type=Path), default=None, help="A benchmark's episodes, to look into a building.")
def doctor(suite: str, data: Path | None, **options: Any) -> int:
    """Say what is installed, reachable and missing, and the command that mends it.

    With --model, the model is asked one small question with a picture. With --habitat-python, Habitat-Sim opens an embedded
    house, or with --scenes and --data a benchmark's building.
    """
    from spacevln.cli.doctor_habitat import habitat_findings

    findings = [*_python(), *_packages(), *_renderer(), *_storage(), *_extras(), *keys(), *model_findings(options)]
    findings += [] if options["habitat_python"] is None else habitat_findings(options, suite, data)
    marks = {"ok": click.style("ok     ", fg="green"), "note": click.style("note   ", fg="yellow")}
    missing = click.style("missing", fg="red")
    for finding in findings:
        click.echo(f"{marks.get(finding.state, missing)}  {finding.what}")
        if finding.mend:
            click.echo(f"         -> {finding.mend}")
    return 3 if any(finding.state == "missing" for finding in findings) else 0


def _python() -> Iterator[Finding]:
    yield Finding("ok", f"spacevln {__version__}, Python {platform.python_version()} on {platform.system()} {platform.machine()}")


def _packages() -> Iterator[Finding]:
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in BASE)
    yield Finding("ok", versions)


def _renderer() -> Iterator[Finding]:
    from spacevln.core import PrerequisiteError, UsageError
    from spacevln.environments.houses.rendering import renderer_info

    try:
        info = renderer_info()
    except (PrerequisiteError, UsageError) as error:
        yield Finding("missing", f"renderer: {error}")
        return
    yield Finding("note" if info.install else "ok", f"renderer {info.name}: {info.reason}", info.install)


def _storage() -> Iterator[Finding]:
    here = Path.cwd()
    if os.access(here, os.W_OK):
        yield Finding("ok", f"runs are written under {here / 'runs'}")
    else:
        yield Finding("note", f"{here} cannot be written", "give --out a directory that you may write")
    package = Path(sys.modules["spacevln"].__file__ or ".").parent
    if not (os.access(package, os.W_OK) or "NUMBA_CACHE_DIR" in os.environ):
        yield Finding("note", "compiled kernels are kept in your user cache, as the package folder cannot be written")


def _extras() -> Iterator[Finding]:
    for module, extra, purpose in EXTRAS:
        if importlib.util.find_spec(module) is None:
            yield Finding("note", f"extra {extra!r} is not installed: {purpose}", f'pip install "spacevln[{extra}]"')
        else:
            yield Finding("ok", f"extra {extra!r}: {purpose}")
