"""Navigation metrics, exactly as Habitat and VLN-CE define them (docs/metrics.md has the sources and the edge cases).

Positions are (N, 3) arrays in metres. A distance is geodesic, from the position to the nearest target; inf when there is no way.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from spacevln.core import UsageError

VLN_RADIUS_M = 3.0
"""Success radius of the instruction benchmarks (paper, appendix "Metrics")."""

OBJECT_GOAL_RADIUS_M = 1.0
"""Success radius of object goals (paper, appendix "Metrics"): to the goal object in the houses suites."""

VIEWPOINT_RADIUS_M = 0.25
"""Success radius of HM3D-OVON's own evaluation: geodesic, to the nearest view point of a goal object."""


def success(stopped: bool, distance_m: float, radius_m: float = VLN_RADIUS_M) -> bool:
    """SR of one episode: STOP was called and the distance is *strictly* below the radius; NaN and inf are failures."""
    return bool(stopped and distance_m < radius_m)


def success_without_stop(distance_m: float, radius_m: float = VLN_RADIUS_M) -> bool:
    """The rule of CA-Nav, Open-Nav and ETPNav, printed beside SR: the end lies within the radius, STOP or not."""
    return bool(distance_m <= radius_m)


def oracle_error_m(distances_m: ArrayLike) -> float:
    """Least distance to the nearest target at any time, the reset included; inf for no positions."""
    return float(np.min(np.asarray(distances_m, dtype=float), initial=math.inf))


def oracle_success(distances_m: ArrayLike, radius_m: float = VLN_RADIUS_M) -> bool:
    """OSR of one episode: strictly inside the radius at any time, the reset included; STOP is irrelevant."""
    return bool(np.any(np.asarray(distances_m, dtype=float) < radius_m))


def spl(success: bool, shortest_m: float, path_m: float) -> float:
    """Success weighted by path length, 0 to 1.

    Args:
        success: of the episode.
        shortest_m: geodesic distance from the start to the nearest target.
        path_m: length of the way that was gone.

    An unreachable start gives 0; a start on the target without motion gives the success itself.
    """
    if not success or not math.isfinite(shortest_m):
        return 0.0
    longest = max(shortest_m, path_m)
    return shortest_m / longest if longest > 0 else 1.0


def soft_spl(start_m: float, final_m: float, path_m: float) -> float:
    """Progress toward the target weighted by path length, 0 to 1; needs no STOP."""
    if not math.isfinite(start_m) or not math.isfinite(final_m):
        return 0.0
    if start_m <= 0:
        return float(final_m <= 0 and path_m <= 0)
    return max(0.0, 1.0 - final_m / start_m) * start_m / max(start_m, path_m)


def path_length_m(path: ArrayLike) -> float:
    """Sum of the Euclidean 3-D distances between successive positions; turns and blocked moves add nothing."""
    points = _positions(path)
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def ndtw(path: ArrayLike, reference: ArrayLike, radius_m: float = VLN_RADIUS_M) -> float:
    """Normalised dynamic time warping, 0 to 1: ``exp(-DTW / (len(reference) * radius))`` with exact DTW.

    A position that equals the one before it is dropped from ``path``, as VLN-CE does; revisits stay.
    """
    points, truth = _positions(path), _positions(reference)
    moved = np.ones(len(points), dtype=bool)
    moved[1:] = np.any(points[1:] != points[:-1], axis=1)
    cost = float(_dtw(np.ascontiguousarray(points[moved]), truth))
    return math.exp(-cost / (len(truth) * radius_m))


def sdtw(success: bool, path: ArrayLike, reference: ArrayLike, radius_m: float = VLN_RADIUS_M) -> float:
    """The nDTW of a successful episode, else 0."""
    return ndtw(path, reference, radius_m) if success else 0.0


def _positions(path: ArrayLike) -> NDArray[np.float64]:
    points = np.ascontiguousarray(path, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        raise UsageError(f"A path has shape {points.shape}, needed is (N, 3) with N >= 1: give x, y, z in metres per position.")
    return points


@njit("float64(float64[:, ::1], float64[:, ::1])", cache=True)
def _dtw(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:  # pragma: no cover - compiled
    previous = np.full(len(b) + 1, np.inf)
    current = np.full(len(b) + 1, np.inf)
    previous[0] = 0.0
    for i in range(len(a)):
        current[0] = np.inf
        for j in range(len(b)):
            dx, dy, dz = a[i, 0] - b[j, 0], a[i, 1] - b[j, 1], a[i, 2] - b[j, 2]
            cost = math.sqrt(dx * dx + dy * dy + dz * dz)
            current[j + 1] = cost + min(previous[j], previous[j + 1], current[j])
        previous, current = current, previous
    return float(previous[len(b)])
