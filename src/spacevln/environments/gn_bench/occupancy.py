"""An InteriorGS building's occupancy map: what is free, and where its pixels are in the world.

Files and rules: ``occupancy.json`` and ``occupancy.png`` of InteriorGS as GN-Bench's simulator reads them. World coordinates are
those of the episodes, z-up; both axes of the picture run against them.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import PrerequisiteError
from spacevln.core.geometry import Float
from spacevln.environments.gn_bench.search import Grid, Pixels

FREE_GRAY = 200
"""A pixel is free from this brightness on."""
MARGINS_PX = (7, 6, 5, 4)
"""By which obstacles are grown for a way, in turn until there is one; by the last for the body's own motion."""


@dataclass(frozen=True, slots=True, eq=False)
class Occupancy:
    """A building from above.

    Args:
        free: by margin of :data:`MARGINS_PX`, (H, W).
        lower_m, upper_m: corners of the picture in its own frame, x and y.
    """

    free: dict[int, Grid]
    lower_m: tuple[float, float]
    upper_m: tuple[float, float]

    @property
    def walkable(self) -> Grid:
        """Where the simulator lets the body be, (H, W)."""
        return self.free[MARGINS_PX[-1]]

    @property
    def pixel_m(self) -> Float:
        """Size of a pixel along x and y, (2,)."""
        height, width = self.walkable.shape
        return np.asarray((np.array(self.upper_m) - self.lower_m) / (width, height))

    def pixels_of(self, points: Float) -> Pixels:
        """Pixels (N, 2) of world points (N, >= 2); outside of the picture, the nearest of its edge."""
        x, y = points[:, 0], points[:, 1]
        size_x, size_y = self.pixel_m
        place = np.column_stack([(-x - self.lower_m[0]) / size_x - 0.5, (self.upper_m[1] + y) / size_y - 0.5])
        height, width = self.walkable.shape
        pixels: Pixels = np.clip(np.rint(place).astype(np.int64), 0, (width - 1, height - 1))
        return pixels

    def points_of(self, pixels: Pixels) -> Float:
        """World points (N, 3) of the middles of pixels (N, 2), on the floor."""
        size_x, size_y = self.pixel_m
        x = -(self.lower_m[0] + (pixels[:, 0] + 0.5) * size_x)
        y = -(self.upper_m[1] - (pixels[:, 1] + 0.5) * size_y)
        return np.column_stack([x, y, np.zeros(len(pixels))])

    def walkable_near(self, pixel: tuple[int, int]) -> tuple[int, int]:
        """The pixel itself if the body can be there, else the first on the smallest square around it.

        A square is looked at as GN-Bench does: column by column its upper and lower side, then row by row its left and right.
        """
        free = self.walkable
        height, width = free.shape
        squares = (_square(pixel, r, width, height) for r in range(max(width, height) + 1))
        return next((u, v) for u, v in itertools.chain.from_iterable(squares) if free[v, u])


def _square(pixel: tuple[int, int], r: int, width: int, height: int) -> Iterator[tuple[int, int]]:
    x, y = pixel
    left, right, top, bottom = max(x - r, 0), min(x + r, width - 1), max(y - r, 0), min(y + r, height - 1)
    yield from ((u, v) for u in range(left, right + 1) for v in (top, bottom))
    yield from ((u, v) for v in range(top + 1, bottom) for u in (left, right))


def load_occupancy(scene: Path) -> Occupancy:
    """The map of a building's folder.

    Raises:
        PrerequisiteError: its files are missing or damaged.
    """
    try:
        place = json.loads((scene / "occupancy.json").read_text(encoding="utf-8"))
        lower, upper = (tuple(map(float, place[name][:2])) for name in ("lower", "upper"))
        data = (scene / "occupancy.png").read_bytes()
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise PrerequisiteError(
            f"The occupancy map of {str(scene)!r} cannot be read ({type(error).__name__}: {error}): "
            "get InteriorGS with occupancy.json and occupancy.png in every building's folder."
        ) from error
    gray = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    if gray is None or gray.ndim != 2 or gray.dtype != np.uint8:
        raise PrerequisiteError(f"{str(scene / 'occupancy.png')!r} is no picture of 8-bit grays: get InteriorGS again.")
    free = gray >= FREE_GRAY
    found = Occupancy({margin: _grown(free, margin) for margin in MARGINS_PX}, (lower[0], lower[1]), (upper[0], upper[1]))
    if not found.walkable.any():
        raise PrerequisiteError(f"The occupancy map of {str(scene)!r} has no floor to walk on: get InteriorGS again.")
    return found


def _grown(free: NDArray[np.bool_], margin: int) -> Grid:
    """What stays free when obstacles grow by a disc."""
    along = np.arange(-margin, margin + 1)
    disc = (along[:, None] ** 2 + along**2 <= margin**2).astype(np.uint8)
    blocked = cv2.dilate((~free).astype(np.uint8), disc, borderType=cv2.BORDER_CONSTANT, borderValue=0)
    return np.asarray(blocked == 0)
