"""Images with a simulator's labels for judging detectors: shortest ways to an object, with a look-around at both ends."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from spacevln.core import Environment, Observation, Stop, TurnLeft, UsageError
from spacevln.environments.houses.house import build_house, parse_scene_name
from spacevln.environments.houses.labels import house_labels
from spacevln.evaluation.episode import Episode
from spacevln.language import head_noun

LONGEST = 120
"""Primitives of a way, at most."""


@dataclass(frozen=True, slots=True)
class Walk:
    """A way through a house.

    Args:
        episode: whose truth leads it.
        vocabulary: what there is in the house, by canonical names: the phrases that a detector is asked, those that an image
            does not show included.
    """

    episode: Episode
    vocabulary: tuple[str, ...]

    @classmethod
    def of(cls, episode: Episode) -> Walk:
        """The walk to an episode's goal in an embedded house."""
        labels = house_labels(build_house(parse_scene_name(episode.scene)))
        return cls(episode, tuple(sorted({head_noun(label.category) for label in labels.values()})))

    def images(self, environment: Environment) -> Iterator[Observation]:
        """What the camera sees, one image after each primitive; poses are in the episode frame.

        Raises:
            UsageError: the episode has no truth to follow.
        """
        truth, start = self.episode.truth, self.episode.start
        if truth is None:
            raise UsageError(f"Episode {self.episode.episode_id!r} has no truth: give episodes of an embedded house.")
        environment.reset(self.episode.spec)
        yield from self._around(environment)
        for _ in range(LONGEST):
            action = truth.follow(start.compose(environment.observe().pose))
            if isinstance(action, Stop):
                break
            environment.execute(action)
            yield environment.observe()
        yield from self._around(environment)

    @staticmethod
    def _around(environment: Environment) -> Iterator[Observation]:
        for _ in range(environment.spec.lookaround_count):
            environment.execute(TurnLeft(environment.spec.turn_deg))
            yield environment.observe()
