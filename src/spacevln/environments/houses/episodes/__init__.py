"""Episodes in houses: routes with instructions in R2R's manner, and object goals in OVON's."""

from spacevln.environments.houses.episodes.clauses import Clause
from spacevln.environments.houses.episodes.episode import EpisodeTags, HouseEpisode, NoEpisodeError, Split
from spacevln.environments.houses.episodes.generate import first_route_episode, route_episode
from spacevln.environments.houses.episodes.semantics import consistent_places

__all__ = [
    "Clause",
    "EpisodeTags",
    "HouseEpisode",
    "NoEpisodeError",
    "Split",
    "consistent_places",
    "first_route_episode",
    "route_episode",
]
