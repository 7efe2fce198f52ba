"""Does the agent read its instruction? The same episode with another instruction, judged by the same goal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spacevln.core import InstructionTask, UsageError
from spacevln.environments.houses.episodes import Grounds, NoEpisodeError, route_episode
from spacevln.environments.houses.house import build_house, parse_scene_name
from spacevln.evaluation.datasets.selection import Probe
from spacevln.evaluation.datasets.sequence import EpisodeSequence
from spacevln.evaluation.episode import Episode, GroundTruth
from spacevln.evaluation.houses import split_of
from spacevln.evaluation.metrics import VLN_RADIUS_M
from spacevln.language import parse

OTHER_SEEDS = range(100, 130)
"""Episode seeds of the other instructions; the suites' own episodes use 0 to 11."""


def probed(episodes: EpisodeSequence, kind: Probe) -> EpisodeSequence:
    """The same episodes with the instructions of a probe."""
    return episodes if kind == "none" else episodes.mapped(lambda episode: probe(episode, kind))


def probe(episode: Episode, kind: Probe) -> Episode:
    """The episode with the instruction of a probe.

    Args:
        episode: a route in an embedded house.
        kind: ``swapped`` gives another episode's instruction of the same house, wherever it leads; ``elsewhere`` the first that
            leads out of this goal's radius, so that to follow it is no success; ``last-noun`` says "Walk to the X." of the last
            noun that the instruction names.
    """
    if kind == "none":
        return episode
    if episode.instruction is None or episode.truth is None:
        raise UsageError(f"Probe {kind!r} needs a route instruction, and {episode.episode_id!r} has none: use houses-vln.")
    match kind:
        case "swapped":
            text = next((text for text, _ in _others(episode)), None)
        case "elsewhere":
            text = next((text for text, goal in _others(episode) if _apart_m(episode.truth, goal) > VLN_RADIUS_M), None)
        case "last-noun":
            text = f"Walk to the {_last_noun(episode.instruction)}."
    if text is None:
        raise UsageError(f"{episode.scene} has no other instruction for the probe {kind!r}: leave its seed out.")
    return replace(episode, spec=replace(episode.spec, task=InstructionTask(text)))


def _others(episode: Episode) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Instructions and goals (3,) of other episodes in the house."""
    grounds = Grounds(build_house(parse_scene_name(episode.scene)))
    for seed in OTHER_SEEDS:
        try:
            other = route_episode(grounds, seed, split_of(grounds.house.seed))
        except NoEpisodeError:
            continue
        task = other.spec.task
        assert isinstance(task, InstructionTask)  # noqa: S101 - route episodes have instructions
        if task.instruction != episode.instruction:
            yield task.instruction, np.asarray(other.goals[0], np.float64)


def _apart_m(truth: GroundTruth, goal: NDArray[np.float64]) -> float:
    return float(truth.distances_m(goal[None])[0])


def _last_noun(instruction: str) -> str:
    places = [clause.place for clause in parse(instruction) if clause.place is not None]
    if not places:
        raise UsageError(f"The instruction {instruction!r} names nothing: it cannot be probed by its last noun.")
    return places[-1].phrase or places[-1].region
