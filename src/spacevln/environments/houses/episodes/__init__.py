"""Episodes in houses: routes with instructions in R2R's manner, and object goals in OVON's."""

from spacevln.environments.houses.episodes.catalogue import checked_goal, goal_categories
from spacevln.environments.houses.episodes.clauses import Clause
from spacevln.environments.houses.episodes.episode import EpisodeTags, HouseEpisode, NoEpisodeError, Split
from spacevln.environments.houses.episodes.generate import first_route_episode, route_episode
from spacevln.environments.houses.episodes.grounds import Grounds
from spacevln.environments.houses.episodes.object_goals import ObjectGoal, object_goal_episode, reachable_categories
from spacevln.environments.houses.episodes.semantics import consistent_places
from spacevln.environments.houses.episodes.worded import worded_routes

__all__ = [
    "Clause",
    "EpisodeTags",
    "Grounds",
    "HouseEpisode",
    "NoEpisodeError",
    "ObjectGoal",
    "Split",
    "checked_goal",
    "consistent_places",
    "first_route_episode",
    "goal_categories",
    "object_goal_episode",
    "reachable_categories",
    "route_episode",
    "worded_routes",
]
