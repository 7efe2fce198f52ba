"""From the record of an attempt and the truth to its result."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from spacevln.core import EpisodeStatus, StopReason
from spacevln.evaluation import metrics
from spacevln.evaluation.episode import Episode, GroundTruth, Points
from spacevln.recording import Metrics, ResultFile, Truth, read_events, task_fields, usage_of
from spacevln.recording.schema import EpisodeEndedLine, EpisodeStartedLine, FallbackUsedLine, ReplyRefusedLine, StepTakenLine


def score(episode: Episode, directory: Path, *, restarts: int = 0) -> ResultFile:
    """Judge an attempt by its record.

    Args:
        episode: with its truth.
        directory: of the episode's record, complete up to its ``episode_ended`` line.
        restarts: how often the episode was begun before.

    Returns:
        The result; metrics that need a truth are null without one.

    Raises:
        RecordError: the record is damaged.
    """
    walked, origin = [episode.start], episode.start
    rejections = fallbacks = 0
    end: EpisodeEndedLine | None = None
    lines = list(read_events(directory))
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
    return result.model_copy(update={"usage": usage_of(lines)})


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
    return _result(episode, walked, end, rejections=0, fallbacks=0, restarts=restarts)


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
    distances = truth.distances_m(positions)
    start_m, final_m = float(distances[0]), float(distances[-1])
    succeeded = stopped and truth.reached(positions[-1])
    reference = truth.reference_path
    scored = counts.model_copy(
        update={
            "SR": float(succeeded),
            "SPL": round(metrics.spl(succeeded, start_m, counts.path_length), 6),
            "OSR": float(any(truth.reached(position) for position in np.unique(positions, axis=0))),
            "NE": round(final_m, 4) if math.isfinite(final_m) else None,
            "nDTW": None if reference is None else round(metrics.ndtw(positions, reference), 6),
            "SDTW": None if reference is None else round(metrics.sdtw(succeeded, positions, reference), 6),
            "SoftSPL": round(metrics.soft_spl(start_m, final_m, counts.path_length), 6),
        }
    )
    known = Truth(
        goals=_rounded(truth.goals),
        shortest_path=_rounded(truth.shortest_path),
        geodesic_m=start_m,
        final_distance_m=final_m,
    )
    return scored, known


def _rounded(points: Points) -> tuple[tuple[float, float, float], ...]:
    return tuple((round(float(x), 3), round(float(y), 3), round(float(z), 3)) for x, y, z in points)
