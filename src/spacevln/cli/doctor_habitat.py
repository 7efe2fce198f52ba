"""What ``spacevln doctor --habitat-python`` finds: whether Habitat-Sim's worker starts there, and of which version it is."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator

from spacevln.cli.findings import Finding
from spacevln.cli.habitat_options import python_of
from spacevln.core import EnvironmentFailure, PrerequisiteError

PROBE_PX = (64, 48)


def habitat_findings(name: str) -> Iterator[Finding]:
    """Start a worker and let it say what it runs on."""
    if importlib.util.find_spec("spacevln_bridge") is None or importlib.util.find_spec("msgpack") is None:
        yield Finding("missing", "the bridge to Habitat-Sim", "pip install 'spacevln[habitat]'")
        return
    from spacevln.environments.habitat.process import Worker

    try:
        worker = Worker(python_of(name), PROBE_PX)
    except (PrerequisiteError, EnvironmentFailure) as error:
        yield Finding("missing", f"Habitat-Sim: {error}", "docs/habitat.md says how to install it")
        return
    welcome = worker.welcome
    worker.close()
    yield Finding("ok", f"Habitat-Sim {welcome.simulator} answers in Python {welcome.python}")
    yield Finding("note", "no scene was opened", "run `spacevln bench r2r-ce --driver oracle --episodes 1` too")
