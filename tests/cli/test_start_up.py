"""What ``spacevln --help`` loads: the command line, and nothing that takes time."""

from __future__ import annotations

import json
import subprocess
import sys

HEAVY = {
    "av", "cv2", "matplotlib", "mujoco", "numba", "numpy", "onnxruntime", "openai", "pydantic", "ray", "rerun", "scipy", "torch",
    "transformers", "OpenGL", "PIL", "pyarrow", "zenoh",
}  # fmt: skip


def loaded_by(*words: str) -> set[str]:
    """Top-level packages in a fresh interpreter after a command."""
    code = (
        "import contextlib, io, json, sys\n"
        "from spacevln.cli.app import cli\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        f"    cli({list(words)!r}, standalone_mode=False)\n"
        "print(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout))


def test_help_loads_nothing_heavy() -> None:
    assert not loaded_by("--help") & HEAVY
    for command in ("run", "bench", "detect", "models", "bench-perception"):
        assert not loaded_by(command, "--help") & {
            "torch",
            "transformers",
            "onnxruntime",
            "ray",
            "numba",
            "mujoco",
            "scipy",
            "cv2",
        }
