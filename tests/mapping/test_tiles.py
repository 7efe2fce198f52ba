"""Tiled layers answer for any cells, near or far apart."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from spacevln.mapping.tiles import TiledLayer


@given(seed=st.integers(0, 2**32 - 1), spread=st.sampled_from([3, 300, 20_000]), count=st.integers(0, 200))
def test_at_reads_what_was_written(seed: int, spread: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    layer, window = TiledLayer(), rng.integers(0, 255, (310, 270)).astype(np.uint8)
    corner = rng.integers(-500, 500, 2)
    layer.write(int(corner[0]), int(corner[1]), window)
    cells = corner + rng.integers(-spread, spread + 1, (count, 2))
    inside = ((cells >= corner) & (cells < corner + window.shape)).all(axis=1)
    expected = np.zeros(count, np.uint8)
    expected[inside] = window[tuple((cells[inside] - corner).T)]
    np.testing.assert_array_equal(layer.at(cells), expected)
