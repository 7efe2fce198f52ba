"""What a cell stores: flags of how it was seen, height bins of what stands in it, the height of a stair's tread.

The ``solid`` byte is a coarse voxel column: bit *b* says that something stands ``0.15 + 0.15 b`` to ``0.30 + 0.15 b`` metres
over the local floor. Keeping the heights lets a later ray clear exactly what it passes through: seeing the floor under a
table does not remove the table.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FLOOR = 1  # the floor was seen here, and the space over it
SWEPT = 2  # below the image, under rays that reach the floor or a wall beyond; or an obstacle that was seen through
HIT = 4  # something stood here once
STAIR = 8  # a tread connected with the floor by steps of at most 0.2 m; the ``ground`` layer has its height
BODY = 16  # the agent stood here
UNDER = 32  # the floor was seen, the space over it was not: under a cabinet on legs
FREE_EVIDENCE = FLOOR | SWEPT | STAIR | BODY

OBSTACLE_FROM_M = 0.15
OBSTACLE_TO_M = 1.30
DEPTH_FROM_M = 0.5
DEPTH_TO_M = 5.0

# Heights of one frame are collected in 32 bins of 5 cm, from 0.30 m below the feet to 1.30 m above.
HEIGHT_BIN_M = 0.05
LOWEST_BIN_M = -0.30
GROUND_BIN = 6  # bin that starts at the feet
OBSTACLE_BIN = 9  # bin that starts at 0.15 m
FLOOR_BINS = 0b1_1111_0000  # -0.10 to 0.15 m

CLIMB_BINS = 4  # 0.20 m, the highest step that is climbed
STEEPEST = 0.95  # of a flight, height bins per cell


def free_of(seen: NDArray[np.uint8], solid: NDArray[np.uint8]) -> NDArray[Any]:
    """Known free floor."""
    return np.asarray(((seen & FREE_EVIDENCE) != 0) & (solid == 0))
