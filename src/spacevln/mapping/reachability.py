"""Where the body may be, and where the known ends: derived from the cells, brought up to date only where they changed."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from spacevln.mapping import wavefront
from spacevln.mapping.cells import UNDER
from spacevln.mapping.tiles import TILE_CELLS, TiledLayer


@dataclass(slots=True, eq=False)
class Reachability:
    """Two layers that follow ``seen``, ``solid`` and ``ground``, tile by tile.

    Args:
        passable: 1 where the centre of the body may be.
        border: 1 where it may be and a neighbouring cell is unknown.
        radius_cells: of the body.
        changed: keys of the tiles in or near which cells have changed since.
    """

    radius_cells: float
    passable: TiledLayer = field(default_factory=TiledLayer)
    border: TiledLayer = field(default_factory=TiledLayer)
    changed: set[tuple[int, int]] = field(default_factory=set)

    @property
    def nbytes(self) -> int:
        """Bytes of both layers."""
        return self.passable.nbytes + self.border.nbytes

    @property
    def _reach(self) -> int:
        return math.ceil(self.radius_cells) + 1

    def touch(self, i0: int, j0: int, i1: int, j1: int) -> None:
        """Cells of a window, ends exclusive, have changed."""
        reach = self._reach
        rows = range((i0 - reach) // TILE_CELLS, (i1 - 1 + reach) // TILE_CELLS + 1)
        columns = range((j0 - reach) // TILE_CELLS, (j1 - 1 + reach) // TILE_CELLS + 1)
        self.changed.update(itertools.product(rows, columns))

    def refresh(self, seen: TiledLayer, solid: TiledLayer, ground: TiledLayer) -> None:
        """Bring both layers up to date."""
        reach = self._reach
        span, inner = TILE_CELLS + 2 * reach, slice(reach, -reach)
        for ti, tj in sorted(self.changed):
            if (ti, tj) not in seen.tiles:
                continue  # nothing is known to be free there
            i0, j0 = ti * TILE_CELLS, tj * TILE_CELLS
            flags, blocks, heights = (layer.window(i0 - reach, j0 - reach, span, span) for layer in (seen, solid, ground))
            grid = wavefront.passable(flags, blocks, heights, self.radius_cells)
            self.passable.write(i0, j0, grid[inner, inner])
            self.border.write(i0, j0, _border(grid, flags)[inner, inner])
        self.changed.clear()


@numba.njit(cache=True)
def _border(grid: NDArray[np.uint8], seen: NDArray[np.uint8]) -> Any:  # pragma: no cover - compiled
    """1 where the grid is passable and one of the four neighbours is unknown.

    At the side of an image a row of cells shows the floor, and not the space over it: the unknown begins right behind it.
    """
    out = np.zeros_like(grid)
    for i in range(2, grid.shape[0] - 2):
        for j in range(2, grid.shape[1] - 2):
            if grid[i, j] == 0:
                continue
            for a, b in ((-1, 0), (1, 0), (0, -1), (0, 1)):
                beside = seen[i + a, j + b]
                if beside == 0 or (beside == UNDER and seen[i + 2 * a, j + 2 * b] == 0):
                    out[i, j] = 1
    return out
