"""Polylines at equal steps, their directions and their bends."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import wrap_angle

Float = NDArray[np.float64]
STEP_M = 0.2
TURN_RAD = math.radians(40)
_CHORD_M = 1.2


def resampled(path: Float, step_m: float = STEP_M) -> tuple[Float, float]:
    """A polyline at equal steps, and its length; a path shorter than a step keeps its two ends."""
    seg = np.hypot(*np.diff(path, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(seg)])
    length = float(arc[-1])
    s = np.append(np.arange(0.0, max(length - 0.05, 1e-9), step_m), length)
    return np.stack([np.interp(s, arc, path[:, 0]), np.interp(s, arc, path[:, 1])], axis=1), length


def directions(points: Float, half: int = 2) -> Float:
    """Direction of walking (N,) at each of some points (N, 2)."""
    n = len(points)
    lo, hi = np.maximum(np.arange(n) - half, 0), np.minimum(np.arange(n) + half, n - 1)
    d = points[hi] - points[lo]
    return np.asarray(np.arctan2(d[:, 1], d[:, 0]))


def _chord(points: Float, a: int, b: int) -> float | None:
    d = points[b] - points[a]
    return math.atan2(d[1], d[0]) if math.hypot(d[0], d[1]) > 0.3 else None


def turns_of(points: Float, length: float, in_yaw: float, out_yaw: float | None) -> tuple[tuple[float, float], ...]:
    """Bends of a leg; a short leg has only its net turn, so that a step aside is no turn."""
    n, chord = len(points), round(_CHORD_M / STEP_M)
    first, last = _chord(points, 0, min(chord, n - 1)), _chord(points, max(0, n - 1 - chord), n - 1)
    if length < 1.1 or first is None or last is None:
        end = out_yaw if out_yaw is not None else (first if first is not None else in_yaw)
        return ((0.0, wrap_angle(end - in_yaw)),)
    turns = [(0.0, wrap_angle(first - in_yaw))]
    k = chord
    while k < n - chord:
        angle = _bend(points, k, chord)
        if abs(angle) >= TURN_RAD:
            best = max(range(k, min(k + chord, n - chord)), key=lambda i: abs(_bend(points, i, chord)))
            turns.append((best * STEP_M, _bend(points, best, chord)))
            k = best + chord
        else:
            k += 1
    if out_yaw is not None:
        turns.append((length, wrap_angle(out_yaw - last)))
    return tuple(turns)


def _bend(points: Float, k: int, chord: int) -> float:
    before, after = _chord(points, k - chord, k), _chord(points, k, k + chord)
    return 0.0 if before is None or after is None else wrap_angle(after - before)
