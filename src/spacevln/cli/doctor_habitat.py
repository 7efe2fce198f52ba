"""What ``spacevln doctor --habitat-python`` finds: whether the simulator starts there, what it shows, and what it measures."""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spacevln.cli.findings import Finding
from spacevln.cli.habitat_options import in_simulator, python_of
from spacevln.core import EnvironmentFailure, PrerequisiteError, UsageError

if TYPE_CHECKING:
    from spacevln.environments.bridge.simulator import Opened
    from spacevln.evaluation.episode import Episode, Points

PROBE_PX = (64, 48)
HOUSE_SEED = 9
FULL_SHARE = 0.2
"""Less of a frame with a depth is a sign of a wrong scene or driver."""
LENGTH_TOLERANCE = 0.1
NO_GPU = "without a graphics card add --gpu-device -1; docs/habitat.md lists the pitfalls"


def habitat_findings(options: dict[str, Any], suite: str, data: Path | None) -> Iterator[Finding]:
    """Start a worker, let it say what it runs on, and look into a building: the benchmark's, or an embedded house.

    Args:
        options: of :func:`~.habitat_options.habitat_options`; ``habitat_python`` is given.
        suite: whose settings, and whose episodes ``data`` holds.
        data: a benchmark's episodes; its buildings lie in ``scenes``.
    """
    if importlib.util.find_spec("spacevln_bridge") is None or importlib.util.find_spec("msgpack") is None:
        yield Finding("missing", "the bridge to simulators", "pip install 'spacevln[habitat]'")
        return
    from spacevln.environments.bridge.remote import connect

    splats = suite == "gn-bench"
    title, page = ("GN-Bench's simulator", "docs/benchmarks/gn-bench.md") if splats else ("Habitat-Sim", "docs/habitat.md")
    try:
        worker = connect(python_of(options["habitat_python"]), "gn-bench" if splats else "habitat", PROBE_PX)
    except (PrerequisiteError, EnvironmentFailure) as error:
        yield Finding("missing", f"{title}: {error}", f"{page} says how to install it")
        return
    welcome = worker.welcome
    worker.close()
    yield Finding("ok", f"{title} {welcome.simulator} answers in Python {welcome.python}")
    if data is not None:
        yield from _benchmark(options, suite, data)
    elif splats:
        yield Finding("note", "no building was opened", "give --scenes and --data: no house of ours is made of splats")
    else:
        yield from _own_house(options)


def _benchmark(options: dict[str, Any], suite: str, data: Path) -> Iterator[Finding]:
    """Episodes, how many of their buildings are here, and a look from the first that is."""
    from spacevln.evaluation.datasets import Filters, Selection

    if options["scenes"] is None:
        yield Finding("missing", f"the buildings of {suite}", "name the folder that holds them with --scenes")
        return
    try:
        episodes = Selection(suite=suite, path=data).load()
        yield Finding("ok", f"{len(episodes)} episodes of {suite} in {data}")
        here = Selection(suite=suite, path=data, filters=Filters(available_in=options["scenes"])).load()
    except (PrerequisiteError, UsageError) as error:
        yield Finding("missing", str(error), "docs/benchmarks/ says where to get the data of each benchmark")
        return
    absent = len(episodes) - len(here)
    scenes = options["scenes"]
    if absent:
        yield Finding("note", f"buildings of {len(here)} episodes are in {scenes}, of {absent} they are not")
    else:
        yield Finding("ok", f"the buildings of all are in {scenes}")
    first = here[0]
    targets = None if first.annotations is None else first.annotations.targets
    known_m = None if first.annotations is None else first.annotations.geodesic_m
    yield from _look(options, suite, first, targets, known_m)


def _own_house(options: dict[str, Any]) -> Iterator[Finding]:
    """An embedded house in Habitat-Sim: no licence is needed, and its true distances are known."""
    from spacevln.environments.houses.habitat_export import export_for_habitat
    from spacevln.environments.houses.house import build_house
    from spacevln.evaluation.houses import pick_episode

    with tempfile.TemporaryDirectory() as folder:
        try:
            path = export_for_habitat(build_house(HOUSE_SEED), Path(folder))
        except PrerequisiteError as error:
            yield Finding("note", f"no building was opened: {error}", "or give --scenes, --suite and --data")
            return
        episode = pick_episode("vln", HOUSE_SEED)
        truth = episode.truth
        goals = None if truth is None else truth.goals
        known_m = None if truth is None else float(truth.distances_m(episode.start.position_m[None])[0])
        placed = replace(episode, spec=replace(episode.spec, scene=str(path.relative_to(folder))))
        yield from _look({**options, "scenes": Path(folder)}, "r2r-ce", placed, goals, known_m)


def _look(
    options: dict[str, Any], suite: str, episode: Episode, targets: Points | None, known_m: float | None
) -> Iterator[Finding]:
    """One frame and one way from an episode's start."""
    from spacevln.assembly import Configuration, build_environment
    from spacevln.environments.bridge.environment import BridgedEnvironment
    from spacevln.evaluation.truth import Surveyed

    world = build_environment(in_simulator(Configuration(), suite, options))
    assert isinstance(world, BridgedEnvironment)  # noqa: S101 - what in_simulator configures
    try:
        seen = world.reset(episode.spec)
        yield Finding("ok", f"{episode.scene}: {_described(world.simulator.opened)}")
        full = float((seen.depth_m > 0).mean())
        state, mend = ("ok", "") if full >= FULL_SHARE and seen.rgb.any() else ("missing", NO_GPU)
        yield Finding(state, f"a frame of {seen.rgb.shape[1]}x{seen.rgb.shape[0]} pixels, {full:.0%} of them with a depth", mend)
        if targets is not None and isinstance(world, Surveyed):
            way_m = float(world.geodesics(episode.scene).distances_m(episode.start.position_m[None], targets)[0])
            yield _judged(way_m, known_m)
    except (PrerequisiteError, EnvironmentFailure) as error:
        yield Finding("missing", f"{episode.scene}: {error}", NO_GPU)
    finally:
        world.close()


def _described(opened: Opened | None) -> str:
    """What a simulator loaded."""
    from spacevln_bridge.messages import SplatsOpened

    if opened is None:
        return "not opened"
    if isinstance(opened, SplatsOpened):
        return f"{opened.gaussians:,} Gaussians"
    return f"navigation mesh of {opened.mesh_area_m2:.0f} m2, {opened.mesh_source}"


def _judged(way_m: float, known_m: float | None) -> Finding:
    if not np.isfinite(way_m):
        return Finding("missing", "no way leads from the start to the goal", "is its up axis right? see docs/habitat.md")
    if known_m is not None and abs(way_m - known_m) > LENGTH_TOLERANCE * known_m:
        mend = "another version of the data, or other settings of the navigation mesh, explain it"
        return Finding("note", f"the way to the goal is {way_m:.2f} m, the data say {known_m:.2f} m", mend)
    return Finding("ok", f"the way to the goal is {way_m:.2f} m")
