"""How an episode ended and what it leaves behind (Algorithm 1, "Ensure")."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from spacevln.agent.body import Body, Phase
from spacevln.agent.world import World
from spacevln.core import EpisodeEnded, EpisodeStatus, Event, MapSaved, Pose, StopReason, Subtask
from spacevln.mapping import MetricMap
from spacevln.memory import SpatialCognitiveMemory


@dataclass(frozen=True, slots=True)
class Ending:
    """Status of an episode, what led to it, and a sentence about it."""

    status: EpisodeStatus
    reason: StopReason
    detail: str = ""


@dataclass(frozen=True, slots=True)
class EpisodeResult:
    """What an episode leaves behind.

    Args:
        status, stop_reason, detail: how it ended.
        stopped: the environment's STOP was issued.
        subtasks: the stage sequence sigma_0, sigma_1, ...
        memory: the final Spatial Cognitive Memory.
        metric_map: the final map that it stands on.
        pose: the last pose, episode frame.
        steps, lookaround_steps, align_steps: environment steps, of which in look-arounds and alignments.
        collisions: primitives that something shortened or deflected.
    """

    status: EpisodeStatus
    stop_reason: StopReason
    detail: str
    stopped: bool
    subtasks: tuple[Subtask, ...]
    memory: SpatialCognitiveMemory
    metric_map: MetricMap
    pose: Pose
    steps: int
    lookaround_steps: int
    align_steps: int
    collisions: int


def conclude(
    ending: Ending,
    body: Body,
    world: World,
    subtasks: tuple[Subtask, ...],
    seconds: float,
    emit: Callable[[Event], None],
) -> EpisodeResult:
    """Tell the listeners the final map and the end, and hand out the result."""
    emit(MapSaved(world.floor_maps()))
    emit(
        EpisodeEnded(
            status=ending.status,
            stop_reason=ending.reason,
            stopped=body.stopped,
            detail=ending.detail,
            pose=body.pose,
            steps=body.budget.taken,
            lookaround_steps=body.steps[Phase.LOOKAROUND],
            align_steps=body.steps[Phase.ALIGN],
            collisions=body.collisions,
            stages=len(subtasks),
            seconds=seconds,
        )
    )
    return EpisodeResult(
        status=ending.status,
        stop_reason=ending.reason,
        detail=ending.detail,
        stopped=body.stopped,
        subtasks=subtasks,
        memory=world.memory,
        metric_map=world.map,
        pose=body.pose,
        steps=body.budget.taken,
        lookaround_steps=body.steps[Phase.LOOKAROUND],
        align_steps=body.steps[Phase.ALIGN],
        collisions=body.collisions,
    )
