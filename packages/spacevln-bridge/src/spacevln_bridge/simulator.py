"""What a session asks of a simulator, and which ones there are; what differs between their packages is in their own modules."""

from __future__ import annotations

import importlib
from abc import ABC, abstractmethod
from typing import Any, Dict, Tuple

from spacevln_bridge.messages import Vector, View


class SimulatorError(Exception):
    """A request that a simulator cannot serve; ``kind`` as in :class:`~.messages.Failed`."""

    def __init__(self, kind: str, sentence: str) -> None:
        super().__init__(sentence)
        self.kind = kind


class Simulator(ABC):
    """One simulator, reused over scenes. Positions, rotations: :mod:`.messages`."""

    @abstractmethod
    def open(self, asked: Any) -> Any:
        """Load a scene; the answer to the message that asked for it.

        Raises:
            SimulatorError: it cannot be loaded.
        """

    @abstractmethod
    def place(self, position: Vector, rotation: Vector) -> View:
        """Put the body somewhere and look."""

    @abstractmethod
    def act(self, action: str) -> View:
        """One primitive."""

    @abstractmethod
    def draw(self, rgba: Any, depth: Any, labels: Any) -> None:
        """Copy what was seen last into arrays."""

    @abstractmethod
    def close(self) -> None:
        """Free everything."""


class MeasuringSimulator(Simulator):
    """A simulator that knows the ways in its scenes."""

    @abstractmethod
    def distances(self, positions: Any, targets: Any) -> Vector:
        """Geodesic distance of each position to its nearest target."""

    @abstractmethod
    def path(self, start: Vector, targets: Any) -> Any:
        """Points of the shortest way to the nearest target, (M, 3)."""

    @abstractmethod
    def moves(self, start: Vector, ends: Any, targets: Any) -> Vector:
        """Distance to the nearest target after a straight move to each end."""


PACKAGES: Dict[str, Tuple[str, str, str]] = {
    "habitat": ("habitat_sim", "spacevln_bridge.habitat", "HabitatSim"),
    "gn-bench": ("GN_Bench", "spacevln_bridge.gn_bench", "GNBenchSim"),
}
"""By name: the package that must be in this interpreter, and where our class for it is."""


def load_package(name: str) -> Any:
    """The simulator's own package.

    Raises:
        SimulatorError: it is not in this interpreter, or nothing is known by this name.
    """
    if name not in PACKAGES:
        raise SimulatorError("usage", f"The worker knows no simulator {name!r}: {', '.join(sorted(PACKAGES))}.")
    package = PACKAGES[name][0]
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise SimulatorError(
            "prerequisite",
            f"{package} cannot be imported ({error}): give the Python of an environment that has it; "
            "docs/habitat.md and docs/benchmarks/gn-bench.md say how to make one.",
        ) from error


def simulator_of(name: str, package: Any) -> Simulator:
    """The simulator of a loaded package."""
    _, module, kind = PACKAGES[name]
    found: Simulator = getattr(importlib.import_module(module), kind)(package)
    return found
