"""By which turns a look-around is made: once around, or only as far as something is left to see."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Action, EnvironmentSpec, TurnLeft, TurnRight

EDGE_DEG = 1.0  # of the image, that shows nothing for sure


def whole_turn(spec: EnvironmentSpec) -> tuple[Action, ...]:
    """Once around to the left, which restores the heading (paper Sec. 3.1: 12 views)."""
    return (TurnLeft(spec.turn_deg),) * spec.lookaround_count


def turns_to_see(bearings_rad: NDArray[np.float64], spec: EnvironmentSpec) -> tuple[Action, ...]:
    """The fewest turns whose images, with the present one, show every bearing; never more than once around.

    To one side, or to one side and from there to the other.

    Args:
        bearings_rad: (N,) egocentric, left positive.
        spec: of the body.
    """
    left, right = TurnLeft(spec.turn_deg), TurnRight(spec.turn_deg)
    ways = [whole_turn(spec)]
    ways += [(left,) * first + (right,) * then for first, then in _sweeps(bearings_rad, spec)]
    ways += [(right,) * first + (left,) * then for first, then in _sweeps(-bearings_rad, spec)]
    return min(ways, key=len)


def _sweeps(bearings_rad: NDArray[np.float64], spec: EnvironmentSpec) -> Iterator[tuple[int, int]]:
    """Turns to the left, then to the right, that show every bearing: one pair for each number of the former."""
    half, turn = math.radians(spec.camera.hfov_deg / 2 - EDGE_DEG), math.radians(spec.turn_deg)
    to_left, to_right = np.mod(bearings_rad, 2 * math.pi), np.mod(-bearings_rad, 2 * math.pi)
    hidden = (to_left > half) & (to_right > half)
    for first in reversed(range(spec.lookaround_count)):
        rest = to_right[hidden & (to_left > first * turn + half)]
        back = math.ceil((rest.max() - half) / turn) if rest.size else 0
        yield first, first + back if back else 0
