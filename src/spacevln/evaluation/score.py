"""From the record of an attempt and the truth to its result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from spacevln.core import EpisodeStatus, StopReason
from spacevln.evaluation import metrics
from spacevln.evaluation.diagnosis import diagnose
from spacevln.evaluation.episode import Episode, GroundTruth, Points
from spacevln.evaluation.judging import finite, judge
from spacevln.recording import EventLine, Metrics, ResultFile, Truth, task_fields, usage_of
from spacevln.recording.schema import EpisodeEndedLine, EpisodeStartedLine, FallbackUsedLine, ReplyRefusedLine, StepTakenLine

DIGITS = {"NE": 4, "oracle_NE": 4}
"""Decimals of metres in a result; shares have six."""


def score(episode: Episode, lines: Sequence[EventLine], *, restarts: int = 0) -> ResultFile:
    """Judge an attempt by its record.

    Args:
        episode: with its truth.
        lines: of the episode's record, complete up to its ``episode_ended`` line.
        restarts: how often the episode was begun before.

    Returns:
        The result; metrics that need a truth are null without one.
    """
    walked, origin = [episode.start], episode.start
    rejections = fallbacks = 0
    end: EpisodeEndedLine | None = None
    for line in lines:
        match line:
            case EpisodeStartedLine():
                origin = line.T_scene_episode
            case StepTakenLine(pose=pose):
                walked.append(origin.compose(pose))
            case ReplyRefusedLine():
                rejections += 1
            case FallbackUsedLine():
                fallbacks += 1
            case EpisodeEndedLine():
                end = line
            case _:
                pass
    positions = np.array([pose.position_m for pose in walked])
    if end is None:
        return environment_failure(episode, "the attempt ended without a status", positions, restarts=restarts)
    result = _result(episode, positions, end, rejections=rejections, fallbacks=fallbacks, restarts=restarts)
    truth = episode.truth
    reason = None if truth is None else diagnose(lines, end, result.metrics, truth, positions, origin)
    return result.model_copy(update={"usage": usage_of(lines), "diagnosis": reason})


def environment_failure(episode: Episode, detail: str, positions: Points | None = None, *, restarts: int = 0) -> ResultFile:
    """The result of an episode whose world broke for good: a failure that stays in the denominator."""
    walked = episode.start.position_m[None] if positions is None else positions
    end = EpisodeEndedLine(
        time_s=0.0,
        status=EpisodeStatus.ENVIRONMENT_FAILURE,
        stop_reason=StopReason.ENVIRONMENT,
        stopped=False,
        detail=detail,
        pose=episode.start,
        steps=len(walked) - 1,
        lookaround_steps=0,
        align_steps=0,
        collisions=0,
        stages=0,
        seconds=0.0,
    )
    result = _result(episode, walked, end, rejections=0, fallbacks=0, restarts=restarts)
    if episode.truth is None:
        return result
    reason = diagnose((), end, result.metrics, episode.truth, walked, episode.start)
    return result.model_copy(update={"diagnosis": reason})


def _result(
    episode: Episode, positions: Points, end: EpisodeEndedLine, *, rejections: int, fallbacks: int, restarts: int
) -> ResultFile:
    counts = Metrics(
        path_length=round(metrics.path_length_m(positions), 4),
        steps=end.steps,
        lookaround_steps=end.lookaround_steps,
        align_steps=end.align_steps,
        collisions=end.collisions,
        stages=end.stages,
        rejections=rejections,
        fallbacks=fallbacks,
    )
    kind, text = task_fields(episode.spec.task)
    scored, truth = _judge(episode.truth, positions, counts, stopped=end.stopped) if episode.truth else (counts, None)
    return ResultFile(
        episode_id=episode.episode_id,
        scene=episode.scene,
        task_kind=kind,
        task_text=text,
        status=end.status,
        stop_reason=end.stop_reason,
        forced_stop=end.stopped and end.stop_reason.forced,
        detail=end.detail,
        metrics=scored,
        truth=truth,
        tags=dict(episode.tags),
        timing_s=round(end.seconds, 3),
        restarts=restarts,
    )


def _judge(truth: GroundTruth, positions: Points, counts: Metrics, *, stopped: bool) -> tuple[Metrics, Truth]:
    verdict = judge(truth, positions, stopped=stopped)
    values = {name: value for name, value in asdict(verdict).items() if name != "start_m"}
    scored = counts.model_copy(
        update={name: None if value is None else finite(value, DIGITS.get(name, 6)) for name, value in values.items()}
    )
    known = Truth(
        goals=_rounded(truth.goals),
        shortest_path=_rounded(truth.shortest_path),
        geodesic_m=verdict.start_m,
        final_distance_m=verdict.NE,
    )
    return scored, known


def _rounded(points: Points) -> tuple[tuple[float, float, float], ...]:
    return tuple((round(float(x), 3), round(float(y), 3), round(float(z), 3)) for x, y, z in points)
