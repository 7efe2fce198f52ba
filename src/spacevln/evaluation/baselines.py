"""Walkers that see nothing, and one that knows everything: the floor and the ceiling of every table.

They write the same record as the agent and are judged by the same code.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from spacevln.control import StepBudget, default_step_limit
from spacevln.core import (
    Action,
    Environment,
    EpisodeEnded,
    EpisodeStarted,
    EpisodeStatus,
    Event,
    EventSink,
    Motion,
    MoveForward,
    Observation,
    Pose,
    StepTaken,
    Stop,
    StopReason,
    TurnLeft,
    TurnRight,
)
from spacevln.evaluation.episode import Episode, GroundTruth

BLIND_FORWARDS = 37
"""Forward moves after which a blind walker stops: 9.25 m, the mean length of a route."""

BLIND_M = BLIND_FORWARDS * 0.25

FORWARD_SHARE = 0.68
"""Share of forward moves of the random walker, that of VLN-CE's ground-truth actions."""


class Walker(Protocol):
    """Chooses primitives."""

    def next(self, observation: Observation) -> Action:
        """The next primitive at an observation, whose pose is in the episode frame."""


class RandomWalker:
    """Forwards and turns at random; stops after :data:`BLIND_FORWARDS` forwards."""

    def __init__(self, seed: Sequence[int]) -> None:
        self._rng = np.random.default_rng(list(seed))
        self._forwards = 0

    def next(self, observation: Observation) -> Action:
        """Draw."""
        del observation
        if self._forwards == BLIND_FORWARDS:
            return Stop()
        if self._rng.random() < FORWARD_SHARE:
            self._forwards += 1
            return MoveForward()
        return TurnLeft() if self._rng.random() < 0.5 else TurnRight()


class ForwardWalker:
    """Straight ahead, whatever happens; stops after :data:`BLIND_FORWARDS` forwards."""

    def __init__(self) -> None:
        self._forwards = 0

    def next(self, observation: Observation) -> Action:
        """Go on."""
        del observation
        self._forwards += 1
        return MoveForward() if self._forwards <= BLIND_FORWARDS else Stop()


class OracleWalker:
    """The shortest way to the goal, by the ground truth."""

    def __init__(self, truth: GroundTruth, start: Pose) -> None:
        self._truth, self._start = truth, start

    def next(self, observation: Observation) -> Action:
        """Follow the shortest path."""
        return self._truth.follow(self._start.compose(observation.pose))


def walk(
    walker: Walker, episode: Episode, environment: Environment, sinks: Sequence[EventSink], step_limit: int | None = None
) -> None:
    """Run a walker through an episode, with the agent's step budget unless another is given."""
    begin = time.perf_counter()
    budget = StepBudget(step_limit or default_step_limit(episode.spec.task))
    observation = environment.reset(episode.spec)
    _emit(sinks, EpisodeStarted(episode.spec, observation.pose))
    collisions = 0
    action: Action = MoveForward()
    while not isinstance(action, Stop):
        action = walker.next(observation) if budget.can_move else Stop()
        motion: Motion = environment.execute(action)
        budget.spend()
        collisions += motion.collided
        observation = observation if isinstance(action, Stop) else environment.observe()
        phase = "stop" if isinstance(action, Stop) else "execute"
        _emit(sinks, StepTaken(budget.taken, 0, phase, action, motion, observation.pose, None))
    forced = budget.left == 0
    ended = EpisodeEnded(
        status=EpisodeStatus.STEP_LIMIT if forced else EpisodeStatus.STOPPED,
        stop_reason=StopReason.BUDGET if forced else StopReason.GATE,
        stopped=True,
        detail="",
        pose=observation.pose,
        steps=budget.taken,
        lookaround_steps=0,
        align_steps=0,
        collisions=collisions,
        stages=0,
        seconds=time.perf_counter() - begin,
    )
    _emit(sinks, ended)


def _emit(sinks: Sequence[EventSink], event: Event) -> None:
    for sink in sinks:
        sink.emit(event)
