"""Every seam of the system on one page.

An :class:`Environment` yields observations and executes primitives. A :class:`Detector` grounds phrases. A :class:`Planner`
and an :class:`Executor` reason, some of them by a :class:`ChatModel`. A :class:`SpatialMap` answers questions about known
space. An :class:`EventSink` listens.
Implementations need not inherit; ``spacevln.testing`` has a conformance suite for each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core.actions import Action, Motion
from spacevln.core.sensing import Camera, Detection, Observation
from spacevln.core.task import EpisodeSpec, Task

if TYPE_CHECKING:
    from spacevln.core.chat import ChatReply, ChatRequest
    from spacevln.core.contexts import ExecutorContext, ExecutorReply, PlannerContext, PlannerReply
    from spacevln.core.events import Event


@dataclass(frozen=True, slots=True)
class EnvironmentSpec:
    """What a body can do and see.

    Args:
        camera: of every observation.
        step_m: length of one forward primitive.
        turn_deg: angle of one turn primitive; divides 360.
        max_forward_m: longest forward an executor may ask for in one decision.
        body_radius_m: of the disc that the body is seen from above.
    """

    camera: Camera
    step_m: float = 0.25
    turn_deg: float = 30.0
    max_forward_m: float = 1.25
    body_radius_m: float = 0.1

    @property
    def lookaround_count(self) -> int:
        """Turns of a full look-around: 12 in simulation, 8 on a robot."""
        return round(360 / self.turn_deg)


class Environment(Protocol):
    """A world with one body in it. Poses are in the episode frame: the start pose is the origin."""

    @property
    def spec(self) -> EnvironmentSpec:
        """What the body can do and see; constant."""

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Put the body at the episode's start. May be called again at any time.

        Raises:
            UsageError: the scene is unknown.
            EnvironmentFailure: the world broke.
        """

    def observe(self) -> Observation:
        """What the camera sees now. Called after reset; does not move anything."""

    def execute(self, action: Action) -> Motion:
        """Carry out one primitive and report what really happened.

        Called with exactly ``MoveForward(spec.step_m)``, ``TurnLeft(spec.turn_deg)``, ``TurnRight(spec.turn_deg)`` or ``Stop()``.
        ``Stop`` never moves; after it only ``reset`` and ``close`` are called.

        Raises:
            EnvironmentFailure: the world broke.
            SafetyStop: a safety rule ended the motion.
        """

    def close(self) -> None:
        """Free everything. May be called twice."""


class Detector(Protocol):
    """Grounds phrases in images."""

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        """Detections of any of the queries, one tuple per observation, in order.

        Args:
            observations: a batch, e.g. the 12 views.
            queries: landmark terms (``language.grounding_terms``), e.g. ``("white sofa", "sofa", "couch")``; none = nothing is
                sought.
        """


class SpatialMap(Protocol):
    """Questions about the known part of the current floor; metric points in the episode frame."""

    def is_explored(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        """Whether each of the (N, 2) points was seen."""

    def is_free(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        """Whether each of the (N, 2) points is known free floor."""

    def is_obstacle(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        """Whether each of the (N, 2) points is a known obstacle."""

    def line_of_sight(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> bool:
        """Whether known free space joins two points in a straight line."""

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        """Shortest way on known free space inflated by the agent's radius [m]; inf when unknown or cut off."""

    def path(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> NDArray[np.float64]:
        """That way as (N, 2) points, both ends included; (0, 2) when there is none."""


class Planner(Protocol):
    """pi_P: reasons at planning boundaries (paper Sec. 3.1)."""

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        """Terms that the look-around should detect beside the last stage's landmark; none for a VLM."""

    def reset(self) -> None:
        """A new episode begins."""

    def plan(self, context: PlannerContext) -> PlannerReply:
        """The next subtask.

        Raises:
            ReplyRejected: the reply could not be parsed; asked again with the reason, at most N_retry times.
            ModelError: no reply can be had; the episode ends in a controlled way.
        """


class Executor(Protocol):
    """pi_E: turns a subtask into primitive actions, one decision at a time."""

    def reset(self) -> None:
        """A new episode begins."""

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """The next action.

        Raises:
            ReplyRejected: the reply could not be parsed; asked again with the reason, at most N_retry times.
            ModelError: no reply can be had; the stage goes back to the planner.
        """


class ChatModel(Protocol):
    """Answers one complete request at a time (DESIGN 5.5). Retries, rate limit, cost and recording happen behind it."""

    @property
    def name(self) -> str:
        """What it is called in records and tables, e.g. ``"qwen3.5-plus"``."""

    def complete(self, request: ChatRequest) -> ChatReply:
        """Answer, in the shape that ``request.reply_schema`` asks for as far as the server can promise it: parse the text anyway.

        Raises:
            ReplyRejected: a reply came but is unusable as it is (empty, cut off at ``max_tokens``, too long, withheld by a
                content filter); let it pass, so that the loop asks again with the reason.
            ModelError: no reply can be had; let it pass.
            SpendingLimit: the run has spent what it may; let it pass.
        """


class EventSink(Protocol):
    """Listens to the agent loop: records, shows progress. Never changes anything."""

    def emit(self, event: Event) -> None:
        """Take note of an event."""
