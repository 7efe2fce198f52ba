"""The one place that moves the environment: executes a primitive, observes, integrates, counts, tells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from enum import StrEnum

from spacevln.agent.world import World
from spacevln.control import StepBudget
from spacevln.core import (
    Action,
    ContractError,
    Environment,
    EnvironmentSpec,
    EpisodeSpec,
    EpisodeStarted,
    Event,
    Motion,
    Observation,
    Pose,
    Sighting,
    StepTaken,
    Stop,
)


class Phase(StrEnum):
    """What an environment step is for."""

    LOOKAROUND = "lookaround"
    ALIGN = "align"
    EXECUTE = "execute"
    STOP = "stop"


class Body:
    """The agent's body in one episode.

    Args:
        environment: moved by nothing else.
        world: told of every observation.
        budget: of the episode; every step is paid here.
        emit: takes every :class:`StepTaken`.
    """

    def __init__(self, environment: Environment, world: World, budget: StepBudget, emit: Callable[[Event], None]) -> None:
        self._environment = environment
        self._world = world
        self._emit = emit
        self.budget = budget
        self.observation: Observation | None = None
        self.stage = 0
        self.steps: Counter[Phase] = Counter()
        self.collisions = 0

    @property
    def spec(self) -> EnvironmentSpec:
        """What the body can do and see."""
        return self._environment.spec

    @property
    def view(self) -> Observation:
        """What the camera sees now."""
        if self.observation is None:
            raise ContractError("The body was asked for its view before reset: the loop must reset it first.")
        return self.observation

    @property
    def pose(self) -> Pose:
        """Live pose, episode frame; the origin before the reset."""
        return Pose(0.0, 0.0) if self.observation is None else self.observation.pose

    def reset(self, episode: EpisodeSpec) -> None:
        """Put the body at the episode's start and take the first image."""
        self.observation = self._environment.reset(episode)
        self._emit(EpisodeStarted(episode, self.pose, self.observation))
        self._world.integrate(self.observation)

    def step(self, action: Action, phase: Phase, terms: tuple[str, ...] = ()) -> tuple[Motion, tuple[Sighting, ...]]:
        """One primitive, the image after it, and the sightings of ``terms`` in that image.

        Raises:
            EnvironmentFailure, SafetyStop: of the environment.
        """
        motion = self._environment.execute(action)
        self._count(phase, motion)
        self.observation = self._environment.observe()
        (sightings,) = self._world.perceive([self.observation], terms)
        self._world.integrate(self.observation, sightings)
        self._emit(StepTaken(self.budget.taken, self.stage, phase, action, motion, self.pose, self.observation, sightings))
        return motion, sightings

    def stop(self) -> None:
        """The environment's STOP, the last step of an episode."""
        motion = self._environment.execute(Stop())
        self._count(Phase.STOP, motion)
        self._emit(StepTaken(self.budget.taken, self.stage, Phase.STOP, Stop(), motion, self.pose, None))

    @property
    def stopped(self) -> bool:
        """Whether the environment's STOP was issued."""
        return self.steps[Phase.STOP] > 0

    def _count(self, phase: Phase, motion: Motion) -> None:
        self.budget.spend()
        self.steps[phase] += 1
        self.collisions += motion.collided
