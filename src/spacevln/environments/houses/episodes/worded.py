"""One route in several wordings, as robots are tried in the paper."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from spacevln.environments.houses.episodes.episode import HouseEpisode, Split
from spacevln.environments.houses.episodes.generate import Candidate, episode_of, instructions, sample_route, with_exact_path
from spacevln.environments.houses.episodes.grounds import Grounds

_STREAM: dict[Split, int] = {"dev": 73, "test": 74}


def worded_routes(grounds: Grounds, split: Split, wordings: int, attempts: int) -> Iterator[tuple[HouseEpisode, ...]]:
    """Routes of a house, each said in as many different ways as wanted; every instruction leads nowhere else.

    Args:
        grounds: of the house.
        split: whose phrases.
        wordings: of a route; one that cannot be said so often is left out.
        attempts: routes that are tried.
    """
    topology, rng = grounds.topology, np.random.default_rng([grounds.house.seed, _STREAM[split]])
    for attempt in range(attempts):
        found = sample_route(topology, rng)
        if found is None:
            continue
        said: dict[str, Candidate] = {}
        for candidate in instructions(topology, *found, split, rng):
            said.setdefault(candidate.text.text, candidate)
        exact = [with_exact_path(grounds, candidate) for candidate in list(said.values())[:wordings]]
        episodes = tuple(episode_of(topology, candidate, attempt, split) for candidate in exact if candidate is not None)
        if len(episodes) == wordings:
            yield episodes
