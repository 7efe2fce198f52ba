"""Options about Habitat-Sim: its Python, its scenes, and whose settings."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from spacevln.core import PrerequisiteError, UsageError

if TYPE_CHECKING:
    from spacevln.assembly import Configuration

F = TypeVar("F", bound=Callable[..., Any])
CONDA_S = 60


def habitat_options(command: F) -> F:
    """Where Habitat-Sim is and how it is set."""
    folder = click.Path(path_type=Path)
    for option in reversed(
        (
            click.option("--habitat-python", metavar="PATH|conda:NAME|tcp://H:P", default=None, help="Habitat-Sim's Python."),
            click.option("--scenes", type=folder, default=None, help="Folder of all scenes, the parent of mp3d/ or hm3d/."),
            click.option("--scene-dataset", type=folder, default=None, help="Scene dataset configuration, for HM3D's labels."),
            click.option("--settings", default="paper", show_default=True, help="Of Habitat-Sim: paper or official."),
            click.option(
                "--gpu-device", type=click.IntRange(min=-1), default=0, show_default=True, help="-1 for software rendering."
            ),
        )
    ):
        command = option(command)
    return command


def in_habitat(
    configuration: Configuration, suite: str, options: dict[str, Any], *, sliding: bool | None = None
) -> Configuration:
    """The configuration in Habitat-Sim, with the settings of a source written out.

    Args:
        configuration: everything else.
        suite: the benchmark.
        options: of :func:`habitat_options`.
        sliding: said by the user; None takes the source's.

    Raises:
        PrerequisiteError: no interpreter is named, or conda does not know it.
        UsageError: no scenes are named.
    """
    from spacevln.assembly import HabitatSettings, preset_of

    preset = preset_of(suite, options["settings"])
    if options["habitat_python"] is None:
        raise PrerequisiteError(
            f"Suite {suite!r} runs in Habitat-Sim: name a Python that has it with --habitat-python PATH (docs/habitat.md)."
        )
    if options["scenes"] is None:
        raise UsageError(f"Suite {suite!r} needs its buildings: name the folder that holds mp3d/ or hm3d/ with --scenes.")
    values = dict(preset.values) if sliding is None else {**preset.values, "sliding": sliding}
    dataset = options["scene_dataset"]
    settings = HabitatSettings(
        preset=options["settings"],
        python=python_of(options["habitat_python"]),
        scenes=str(options["scenes"].resolve()),
        scene_dataset="" if dataset is None else str(dataset.resolve()),
        cache=str(Path.home() / ".cache" / "spacevln" / "navmeshes"),
        gpu_device=options["gpu_device"],
        **values,
    )
    budget = configuration.step_budget or preset.step_budget
    return configuration.model_copy(update={"environment": settings, "step_budget": budget})


def python_of(name: str) -> str:
    """The interpreter that a path or ``conda:NAME`` stands for.

    Raises:
        PrerequisiteError: there is none.
    """
    kind, colon, environment = name.partition(":")
    if not (colon and kind == "conda"):
        return name
    conda = next(filter(None, map(shutil.which, ("conda", "mamba", "micromamba"))), None)
    if conda is None:
        raise PrerequisiteError(f"--habitat-python {name!r} needs conda on PATH: give the interpreter's path instead.")
    command = [conda, "run", "-n", environment, "python", "-c", "import sys; print(sys.executable)"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=CONDA_S, check=False)  # noqa: S603 - conda itself
    if done.returncode:
        raise PrerequisiteError(f"Conda has no usable environment {environment!r}: make it, or give the interpreter's path.")
    return done.stdout.strip().splitlines()[-1]
