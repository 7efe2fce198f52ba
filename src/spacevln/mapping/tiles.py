"""Sparse square tiles of cells, allocated on touch (DESIGN 5.2).

A cell ``(i, j)`` covers ``[i, i + 1) x [j, j + 1)`` resolutions along x and y. Indices may be negative; a map around a
point kilometres away costs what a map around the origin costs.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

_DENSE = 100  # cells of a box per asked cell
TILE_CELLS = 240


class TiledLayer:
    """One value per cell, 0 where nothing was ever written.

    Args:
        dtype: of a cell; one byte in every layer of the map.
    """

    def __init__(self, dtype: DTypeLike = np.uint8) -> None:
        self.dtype = np.dtype(dtype)
        self.tiles: dict[tuple[int, int], NDArray[Any]] = {}

    @property
    def nbytes(self) -> int:
        """Bytes held by the allocated tiles."""
        return sum(tile.nbytes for tile in self.tiles.values())

    def read(self, i0: int, j0: int, out: NDArray[Any]) -> None:
        """Copy the window whose first cell is ``(i0, j0)`` into ``out`` (rows along i, columns along j)."""
        out.fill(0)
        for key, inner, outer in _overlaps(i0, j0, out.shape[0], out.shape[1]):
            tile = self.tiles.get(key)
            if tile is not None:
                out[outer] = tile[inner]

    def window(self, i0: int, j0: int, rows: int, columns: int) -> NDArray[Any]:
        """A fresh copy of a window."""
        out = np.empty((rows, columns), self.dtype)
        self.read(i0, j0, out)
        return out

    def write(self, i0: int, j0: int, window: NDArray[Any]) -> None:
        """Store a window; a tile is allocated only when the window holds something for it."""
        for key, inner, outer in _overlaps(i0, j0, window.shape[0], window.shape[1]):
            part = window[outer]
            tile = self.tiles.get(key)
            if tile is None:
                if not part.any():
                    continue
                tile = self.tiles[key] = np.zeros((TILE_CELLS, TILE_CELLS), self.dtype)
            tile[inner] = part

    def at(self, ij: NDArray[np.int64]) -> NDArray[Any]:
        """Values of (N, 2) cells, shape (N,)."""
        out = np.zeros(len(ij), self.dtype)
        if not self.tiles or not len(ij):
            return out
        (i0, j0), (i1, j1) = ij.min(axis=0).tolist(), ij.max(axis=0).tolist()
        if (i1 - i0 + 1) * (j1 - j0 + 1) <= _DENSE * len(ij):  # one copy of what lies between is cheaper than sorting by tile
            return np.asarray(self.window(i0, j0, i1 - i0 + 1, j1 - j0 + 1)[ij[:, 0] - i0, ij[:, 1] - j0])
        keys, inner = np.divmod(ij, TILE_CELLS)
        for key in map(tuple, np.unique(keys, axis=0).tolist()):
            tile = self.tiles.get(key)
            if tile is not None:
                here = (keys[:, 0] == key[0]) & (keys[:, 1] == key[1])
                out[here] = tile[inner[here, 0], inner[here, 1]]
        return out


def _overlaps(
    i0: int, j0: int, rows: int, columns: int
) -> Iterator[tuple[tuple[int, int], tuple[slice, slice], tuple[slice, slice]]]:
    """Per tile that a window touches: its key, the slices inside the tile, the slices inside the window."""
    for ti in range(i0 // TILE_CELLS, (i0 + rows - 1) // TILE_CELLS + 1):
        a, b = max(i0, ti * TILE_CELLS), min(i0 + rows, (ti + 1) * TILE_CELLS)
        for tj in range(j0 // TILE_CELLS, (j0 + columns - 1) // TILE_CELLS + 1):
            c, d = max(j0, tj * TILE_CELLS), min(j0 + columns, (tj + 1) * TILE_CELLS)
            inner = slice(a - ti * TILE_CELLS, b - ti * TILE_CELLS), slice(c - tj * TILE_CELLS, d - tj * TILE_CELLS)
            yield (ti, tj), inner, (slice(a - i0, b - i0), slice(c - j0, d - j0))
