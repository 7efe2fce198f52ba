"""From the record of an attempt and the truth to its result."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from spacevln.core import EpisodeStatus, StopReason
from spacevln.evaluation import metrics
from spacevln.evaluation.episode import Episode, Points
from spacevln.recording import Metrics, ResultFile, Truth, read_events, task_fields
from spacevln.recording.schema import EpisodeEndedLine, FallbackUsedLine, ReplyRefusedLine, StepTakenLine


def score(episode: Episode, directory: Path, *, restarts: int = 0) -> ResultFile:
    """Judge an attempt by its record.

    Args:
        episode: with its truth.
        directory: of the episode's record, complete up to its ``episode_ended`` line.
        restarts: how often a worker died in this episode before.

    Returns:
        The result; metrics that need a truth are null without one.

    Raises:
        RecordError: the record is damaged.
    """
    walked = [episode.start]
    rejections = fallbacks = 0
    end: EpisodeEndedLine | None = None
    for line in read_events(directory):
        match line:
            case StepTakenLine(pose=pose):
                walked.append(episode.start.compose(pose))
            case ReplyRefusedLine():
                rejections += 1
            case FallbackUsedLine():
                fallbacks += 1
            case EpisodeEndedLine():
                end = line
            case _:
                pass
    positions = np.array([pose.position_m for pose in walked])
    kind, text = task_fields(episode.spec.task)
    if end is None:
        return environment_failure(episode, "the attempt ended without a status", positions, restarts=restarts)
    counts = _Counts(end, rejections, fallbacks)
    scored, truth = _judge(episode, positions, stopped=end.stopped, counts=counts)
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


def environment_failure(episode: Episode, detail: str, positions: Points | None = None, *, restarts: int = 0) -> ResultFile:
    """The result of an episode whose world broke for good: a failure that stays in the denominator."""
    kind, text = task_fields(episode.spec.task)
    where = positions if positions is not None else episode.start.position_m[None]
    scored, truth = _judge(episode, where, stopped=False, counts=None)
    return ResultFile(
        episode_id=episode.episode_id,
        scene=episode.scene,
        task_kind=kind,
        task_text=text,
        status=EpisodeStatus.ENVIRONMENT_FAILURE,
        stop_reason=StopReason.ENVIRONMENT,
        forced_stop=False,
        detail=detail,
        metrics=scored,
        truth=truth,
        tags=dict(episode.tags),
        timing_s=0.0,
        restarts=restarts,
    )


class _Counts:
    """What the record counted."""

    def __init__(self, end: EpisodeEndedLine, rejections: int, fallbacks: int) -> None:
        self.fields = {
            "steps": end.steps,
            "lookaround_steps": end.lookaround_steps,
            "align_steps": end.align_steps,
            "collisions": end.collisions,
            "stages": end.stages,
            "rejections": rejections,
            "fallbacks": fallbacks,
        }


NO_COUNTS = dict.fromkeys(("steps", "lookaround_steps", "align_steps", "collisions", "stages", "rejections", "fallbacks"), 0)


def _judge(episode: Episode, positions: Points, *, stopped: bool, counts: _Counts | None) -> tuple[Metrics, Truth | None]:
    walked_m = metrics.path_length_m(positions)
    counted = counts.fields if counts else {**NO_COUNTS, "steps": len(positions) - 1}
    truth = episode.truth
    if truth is None:
        return Metrics(path_length=round(walked_m, 4), **counted), None
    distances = truth.distances_m(positions)
    start_m, final_m = float(distances[0]), float(distances[-1])
    succeeded = stopped and truth.reached(positions[-1])
    reference = truth.reference_path
    scored = Metrics(
        SR=float(succeeded),
        SPL=round(metrics.spl(succeeded, start_m, walked_m), 6),
        OSR=float(any(truth.reached(position) for position in np.unique(positions, axis=0))),
        NE=round(final_m, 4) if math.isfinite(final_m) else None,
        nDTW=None if reference is None else round(metrics.ndtw(positions, reference), 6),
        SDTW=None if reference is None else round(metrics.sdtw(succeeded, positions, reference), 6),
        SoftSPL=round(metrics.soft_spl(start_m, final_m, walked_m), 6),
        path_length=round(walked_m, 4),
        **counted,
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
