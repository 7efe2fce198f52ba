"""Where a flight of stairs is entered and where it leads, from the surface points that were seen of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core import SpatialMap
from spacevln.reasoning.rules.sightings import XY, Thing

Float = NDArray[np.float64]

BEFORE_M = 0.45  # one stands this far before the first step
BEYOND_M = 0.9  # and is off the flight this far behind the last one
USUAL_RUN_M = 4.2  # of a storey; a flight seen from above shows its first steps only
LEAST_RUN_M = 1.8  # a shorter stretch may be the breadth of the steps
LEAST_POINTS = 4


@dataclass(frozen=True, slots=True)
class Flight:
    """A straight flight.

    Args:
        entry: where one stands before its first step.
        far: where one stands behind its last step, at least.
    """

    entry: XY
    far: XY


def flight_of(stairs: Thing, space: SpatialMap, pose_xy: XY) -> Flight | None:
    """The flight that was seen, entered at the end that is open; None when its direction cannot be told.

    Args:
        stairs: with its surface points.
        space: the map of this floor; the closed end of a flight is an obstacle.
        pose_xy: where the agent stands; of two open ends the nearer one is taken.
    """
    points = np.asarray(stairs.surface, dtype=float)
    if len(points) < LEAST_POINTS:
        return None
    middle = points.mean(axis=0)
    _, _, axes = np.linalg.svd(points - middle)
    axis = axes[0]
    along = (points - middle) @ axis
    across = (points - middle) @ np.array([-axis[1], axis[0]])
    if np.ptp(along) < max(1.2 * np.ptp(across), LEAST_RUN_M):  # only its first steps were seen: it leads away from the eye
        axis = middle - np.array(stairs.seen_from)
        axis = _square(axis / max(float(np.linalg.norm(axis)), 1e-6), axes)
        along = (points - middle) @ axis
    side = np.array([-axis[1], axis[0]])
    centre = middle + side * (np.ptp((points - middle) @ side) / 2 + ((points - middle) @ side).min())
    ends = [(centre + along.min() * axis, axis), (centre + along.max() * axis, -axis)]
    open_ends = [(end, inward) for end, inward in ends if _open(end, inward, space)]
    if not open_ends:
        return None
    end, inward = min(open_ends, key=lambda e: math.dist(e[0], pose_xy))
    run = max(float(np.ptp(along)), USUAL_RUN_M)
    entry, far = end - BEFORE_M * inward, end + (run + BEYOND_M) * inward
    return Flight((float(entry[0]), float(entry[1])), (float(far[0]), float(far[1])))


def _square(direction: Float, axes: Float) -> Float:
    """The one of the two axes, with its sign, that is nearest to a direction."""
    best = max(axes, key=lambda axis: abs(float(axis @ direction)))
    return np.asarray(best if float(best @ direction) > 0 else -best)


def _open(end: Float, inward: Float, space: SpatialMap) -> bool:
    """Whether nothing stands where one would step onto the flight."""
    before = end + np.linspace(-BEFORE_M, -0.1, 6)[:, None] * inward
    return bool(space.is_explored(before[:1])[0]) and not bool(space.is_obstacle(before).any())
