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
    UsageError,
)
from spacevln.evaluation.episode import Episode, GroundTruth
from spacevln.evaluation.truth import MeasuredTruth

BLIND_FORWARDS = 37
"""Forward moves after which a blind walker stops: 9.25 m, the mean length of a route."""

BLIND_M = BLIND_FORWARDS * 0.25

FORWARD_SHARE = 0.68
"""Share of forward moves of the random walker, that of VLN-CE's ground-truth actions."""


PLACE_M = 0.5
"""How near a place of a reference path has to be passed: two steps, so that coarse turns do not make one circle it."""


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


class ReferenceWalker:
    """Walks a dataset's own path place by place: what its annotators' or its authors' agent did, at any size of step and turn.

    Args:
        truth: with a reference path, VLN-CE's ``_gt`` locations where they are there.
        start: pose in the scene frame.

    Raises:
        UsageError: there is no such path.
    """

    def __init__(self, truth: MeasuredTruth, start: Pose) -> None:
        if truth.reference_path is None:
            raise UsageError("The episode has no reference path: keep the dataset's _gt file beside it, or take --driver oracle.")
        self._truth, self._start = truth, start
        self._left = [np.asarray(place) for place in truth.reference_path[::-1]]

    def next(self, observation: Observation) -> Action:
        """Go on to the first place that is not yet near."""
        pose = self._start.compose(observation.pose)
        while len(self._left) > 1 and np.linalg.norm(self._left[-1] - pose.position_m) < PLACE_M:
            self._left.pop()
        action = self._truth.towards(pose, self._left[-1])
        while isinstance(action, Stop) and len(self._left) > 1:  # nothing leads nearer to this one
            self._left.pop()
            action = self._truth.towards(pose, self._left[-1])
        return action


def walk(
    walker: Walker, episode: Episode, environment: Environment, sinks: Sequence[EventSink], step_limit: int | None = None
) -> None:
    """Run a walker through an episode, with the agent's step budget unless another is given."""
    begin = time.perf_counter()
    budget = StepBudget(step_limit or default_step_limit(episode.spec.task))
    observation = environment.reset(episode.spec)
    _emit(sinks, EpisodeStarted(episode.spec, observation.pose, observation))
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
