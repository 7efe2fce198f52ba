"""What episodes of one house share: its walkable space, geodesics and topology, built once."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from spacevln.environments.houses.episodes.topology import Topology
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.plan import House
from spacevln.environments.houses.walking.geodesics import Geodesics


class Grounds:
    """A house with its spaces.

    Args:
        house: the house.
    """

    def __init__(self, house: House) -> None:
        self.house = house
        self.walkable = Walkable(house)

    @cached_property
    def geodesics(self) -> Geodesics:
        """Exact distances."""
        return Geodesics(self.walkable)

    @cached_property
    def topology(self) -> Topology:
        """Rooms, portals and what is seen on the way."""
        return Topology(self.house, self.walkable)

    @cached_property
    def start_cells(self) -> NDArray[np.int64]:
        """Cells (N, 3: floor, i, j) of the topology's grid where an episode may start: in a room, not on stairs."""
        space = self.topology.space
        return np.argwhere(space.walkable & (space.room >= 0))
