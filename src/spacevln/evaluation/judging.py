"""The verdict on an attempt: positions and a ground truth in, metrics out (docs/metrics.md)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacevln.evaluation import metrics
from spacevln.evaluation.episode import GroundTruth, Points

PAPER_VIEWPOINT_RADIUS_M = metrics.OBJECT_GOAL_RADIUS_M
"""Radius to a view point under which the authors' evaluation of HM3D-OVON counts a success."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Metrics that need the truth; shares are 0 to 1, distances metres, infinite where there is no way.

    Args:
        SR, SPL, OSR, SoftSPL, NE: the strict definitions of Habitat and VLN-CE, the headline.
        oracle_NE: least distance on the way.
        nDTW, SDTW: None where there is no reference path.
        SR_no_stop, SPL_no_stop: CA-Nav's rule, which needs no STOP; printed beside, never instead.
        SR_viewpoint, SR_viewpoint_1m: STOP within 0.25 m (HM3D-OVON's own) and within 1 m of a view point; None for routes.
        start_m: distance at the start, L of SPL.
    """

    SR: float
    SPL: float
    OSR: float
    NE: float
    oracle_NE: float
    SoftSPL: float
    nDTW: float | None
    SDTW: float | None
    SR_no_stop: float
    SPL_no_stop: float
    SR_viewpoint: float | None
    SR_viewpoint_1m: float | None
    start_m: float


def judge(truth: GroundTruth, positions: Points, *, stopped: bool) -> Verdict:
    """Judge where an agent went.

    Args:
        truth: of the episode.
        positions: (N, 3) in the scene frame, the start first, one for every step.
        stopped: the environment's STOP was issued at the last of them.
    """
    distances = truth.distances_m(positions)
    start_m, final_m = float(distances[0]), float(distances[-1])
    path_m = metrics.path_length_m(positions)
    succeeded = stopped and truth.reached(positions[-1])
    near = metrics.success_without_stop(final_m, truth.radius_m)
    viewpoint_m = truth.viewpoint_m(positions[-1])
    reference = truth.reference_path
    return Verdict(
        SR=float(succeeded),
        SPL=metrics.spl(succeeded, start_m, path_m),
        OSR=float(any(truth.reached(position) for position in np.unique(positions, axis=0))),
        NE=final_m,
        oracle_NE=metrics.oracle_error_m(distances),
        SoftSPL=metrics.soft_spl(start_m, final_m, path_m),
        nDTW=None if reference is None else metrics.ndtw(positions, reference),
        SDTW=None if reference is None else metrics.sdtw(succeeded, positions, reference),
        SR_no_stop=float(near),
        SPL_no_stop=metrics.spl(near, start_m, path_m),
        SR_viewpoint=_within(viewpoint_m, metrics.VIEWPOINT_RADIUS_M, stopped=stopped),
        SR_viewpoint_1m=_within(viewpoint_m, PAPER_VIEWPOINT_RADIUS_M, stopped=stopped),
        start_m=start_m,
    )


def _within(distance_m: float | None, radius_m: float, *, stopped: bool) -> float | None:
    return None if distance_m is None else float(metrics.success(stopped, distance_m, radius_m))


def finite(value: float, digits: int) -> float | None:
    """A rounded number for a record, None where there is no way."""
    return round(value, digits) if math.isfinite(value) else None
