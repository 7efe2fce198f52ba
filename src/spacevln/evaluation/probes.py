"""Does the agent read its instruction? The same episode with another instruction, judged by the same goal."""

from __future__ import annotations

from dataclasses import replace

from spacevln.core import InstructionTask, UsageError
from spacevln.environments.houses.episodes import NoEpisodeError, route_episode
from spacevln.environments.houses.house import build_house, parse_scene_name
from spacevln.evaluation.datasets.selection import Probe
from spacevln.evaluation.datasets.sequence import EpisodeSequence
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.houses import split_of
from spacevln.language import parse

OTHER_SEEDS = range(100, 112)
"""Episode seeds of the other instructions; the suites' own episodes use 0 to 11."""


def probed(episodes: EpisodeSequence, kind: Probe) -> EpisodeSequence:
    """The same episodes with the instructions of a probe."""
    return episodes if kind == "none" else episodes.mapped(lambda episode: probe(episode, kind))


def probe(episode: Episode, kind: Probe) -> Episode:
    """The episode with the instruction of a probe.

    Args:
        episode: a route in an embedded house.
        kind: ``swapped`` gives another episode's instruction of the same house; ``last-noun`` says "Walk to the X." of the last
            noun that the instruction names.
    """
    if kind == "none":
        return episode
    if episode.instruction is None:
        raise UsageError(f"Probe {kind!r} needs a route instruction, and {episode.episode_id!r} has none: use houses-vln.")
    text = _other_instruction(episode) if kind == "swapped" else f"Walk to the {_last_noun(episode.instruction)}."
    return replace(episode, spec=replace(episode.spec, task=InstructionTask(text)))


def _other_instruction(episode: Episode) -> str:
    house = build_house(parse_scene_name(episode.scene))
    for seed in OTHER_SEEDS:
        try:
            task = route_episode(house, seed, split_of(house.seed)).spec.task
        except NoEpisodeError:
            continue
        assert isinstance(task, InstructionTask)  # noqa: S101 - route episodes have instructions
        if task.instruction != episode.instruction:
            return task.instruction
    raise UsageError(f"{episode.scene} has only one instruction: leave its seed out.")


def _last_noun(instruction: str) -> str:
    places = [clause.place for clause in parse(instruction) if clause.place is not None]
    if not places:
        raise UsageError(f"The instruction {instruction!r} names nothing: it cannot be probed by its last noun.")
    return places[-1].phrase or places[-1].region
