"""The run directory that ``run`` and ``bench`` write into."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

from spacevln import __version__
from spacevln.assembly import Configuration
from spacevln.core import UsageError
from spacevln.evaluation.datasets import Source
from spacevln.recording import RunFile

PACKAGES = ("click", "mujoco", "numba", "numpy", "opencv-python-headless", "pillow", "pydantic", "rich", "scipy")


def prepare(directory: Path | None) -> Path:
    """The run directory, created; by default a new one under ``runs/`` named by the time.

    Raises:
        UsageError: it cannot be written.
    """
    chosen = directory or Path("runs") / datetime.now().astimezone().strftime("%Y-%m-%d-%H%M%S")
    try:
        chosen.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(
            f"--out {str(chosen)!r} cannot be made ({error.strerror}): give a directory that you may write."
        ) from error
    if not os.access(chosen, os.W_OK):
        raise UsageError(f"--out {str(chosen)!r} cannot be written: give a directory that you may write.")
    return chosen


def describe_run(suite: str, configuration: Configuration, source: Source | None = None) -> RunFile:
    """What ``run.json`` says of this run; ``source`` names the files that its episodes were read from."""
    return RunFile(
        version=__version__,
        suite=suite,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        command=("spacevln", *sys.argv[1:]),
        configuration=configuration.model_dump(mode="json"),
        configuration_hash=configuration.hash,
        packages={name: metadata.version(name) for name in PACKAGES},
        python=platform.python_version(),
        platform=platform.platform(),
        git_revision=_git_revision(),
        dataset={} if source is None else dict(source.files),
    )


def _git_revision() -> str | None:
    """The revision of a source checkout; None for an installed package."""
    here = Path(__file__).resolve().parent
    command = ["git", "-C", str(here), "rev-parse", "HEAD"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=5, check=False)  # noqa: S603 - a fixed command
    except (OSError, subprocess.TimeoutExpired):
        return None
    inside = done.returncode == 0 and "site-packages" not in here.parts
    return done.stdout.strip() if inside else None
