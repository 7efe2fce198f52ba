"""Options about a simulator behind the bridge, Habitat-Sim or GN-Bench's: its Python, its scenes, and whose settings."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from spacevln.assembly import Configuration, GNBenchSettings, HabitatSettings

F = TypeVar("F", bound=Callable[..., Any])
CONDA_S = 60


def habitat_options(command: F) -> F:
    """Where the simulator is and how it is set."""
    folder = click.Path(path_type=Path)
    for option in reversed(
        (
            click.option(
                "--habitat-python",
                "--simulator-python",
                "habitat_python",
                metavar="PATH|conda:NAME|tcp://H:P",
                default=None,
                help="Python of Habitat-Sim, or of GN-Bench's simulator.",
            ),
            click.option(
                "--scenes", type=folder, default=None, help="Folder of all scenes: parent of mp3d/ or hm3d/; InteriorGS."
            ),
            click.option("--scene-dataset", type=folder, default=None, help="Scene dataset configuration, for HM3D's labels."),
            click.option("--settings", default="paper", show_default=True, help="Of the simulator: paper or official."),
            click.option(
                "--gpu-device", type=click.IntRange(min=-1), default=0, show_default=True, help="-1 for software rendering."
            ),
        )
    ):
        command = option(command)
    return command


def in_simulator(
    configuration: Configuration, suite: str, options: dict[str, Any], *, sliding: bool | None = None
) -> Configuration:
    """The configuration in the simulator of a benchmark, with the settings of a source written out.

    Args:
        configuration: everything else.
        suite: the benchmark.
        options: of :func:`habitat_options`.
        sliding: said by the user; None takes the source's.

    Raises:
        PrerequisiteError: no interpreter is named, or conda does not know it.
        UsageError: no scenes are named, or an option is of another simulator.
    """
    from spacevln.assembly import GNBenchSettings, preset_of
    from spacevln.core import PrerequisiteError, UsageError

    preset = preset_of(suite, options["settings"])
    if options["habitat_python"] is None:
        where = "GN-Bench's simulator" if suite == "gn-bench" else "Habitat-Sim"
        raise PrerequisiteError(
            f"Suite {suite!r} runs in {where}: name a Python that has it with --habitat-python PATH (docs/benchmarks/{suite}.md)."
        )
    if options["scenes"] is None:
        raise UsageError(f"Suite {suite!r} needs its buildings: name the folder that holds them with --scenes.")
    common = {
        "preset": options["settings"],
        "python": python_of(options["habitat_python"]),
        "scenes": str(options["scenes"].resolve()),
        "gpu_device": options["gpu_device"],
        **preset.values,
    }
    if suite == "gn-bench":
        if sliding is not None or options["scene_dataset"] is not None:
            raise UsageError("GN-Bench has neither sliding nor scene datasets: leave --sliding and --scene-dataset out.")
        settings: HabitatSettings | GNBenchSettings = GNBenchSettings(**common)
    else:
        settings = _habitat(common, options["scene_dataset"], sliding)
    budget = configuration.step_budget or preset.step_budget
    return configuration.model_copy(update={"environment": settings, "step_budget": budget})


def _habitat(common: dict[str, Any], dataset: Path | None, sliding: bool | None) -> HabitatSettings:
    from spacevln.assembly import HabitatSettings

    return HabitatSettings(
        scene_dataset="" if dataset is None else str(dataset.resolve()),
        cache=str(Path.home() / ".cache" / "spacevln" / "navmeshes"),
        **common if sliding is None else {**common, "sliding": sliding},
    )


def python_of(name: str) -> str:
    """The interpreter that a path or ``conda:NAME`` stands for.

    Raises:
        PrerequisiteError: there is none.
    """
    from spacevln.core import PrerequisiteError

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
