"""Tiling patterns (grey, tinted later) and wall surfaces (as high as the wall, with a skirting board)."""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.float64]
Image = NDArray[np.uint8]


def rng_for(name: str) -> np.random.Generator:
    """A generator that depends on nothing but the name."""
    return np.random.default_rng([zlib.crc32(name.encode()), 7])


def noise(size: int, cells_y: int, cells_x: int, rng: np.random.Generator) -> Grey:
    """Tiling smooth noise, (size, size), -1 to 1."""
    grid = rng.uniform(-1, 1, (cells_y, cells_x))
    y, x = np.arange(size) * cells_y / size, np.arange(size) * cells_x / size
    y0, x0 = y.astype(int), x.astype(int)
    fy, fx = y - y0, x - x0
    fy, fx = (fy * fy * (3 - 2 * fy))[:, None], (fx * fx * (3 - 2 * fx))[None, :]
    y1, x1 = (y0 + 1) % cells_y, (x0 + 1) % cells_x
    top = grid[np.ix_(y0, x0)] * (1 - fx) + grid[np.ix_(y0, x1)] * fx
    bottom = grid[np.ix_(y1, x0)] * (1 - fx) + grid[np.ix_(y1, x1)] * fx
    return np.asarray(top * (1 - fy) + bottom * fy)


def to_image(grey: Grey) -> Image:
    """Grey 0 to 1 as an RGB image."""
    channel = (np.clip(grey, 0, 1) * 255).astype(np.uint8)
    return np.ascontiguousarray(np.repeat(channel[:, :, None], 3, axis=2))


def _fabric() -> Image:
    rng = rng_for("fabric")
    y, x = np.mgrid[0:64, 0:64]
    weave = 0.05 * np.where((x // 2 + y // 2) % 2 == 0, 1.0, -1.0)
    return to_image(0.92 + weave + 0.05 * rng.uniform(-1, 1, (64, 64)))


def _leather() -> Image:
    rng = rng_for("leather")
    return to_image(0.95 + 0.02 * noise(128, 8, 8, rng) + 0.04 * noise(128, 64, 64, rng))


def _wood() -> Image:
    rng = rng_for("wood")
    grain = noise(128, 24, 3, rng) * 0.1 + noise(128, 64, 2, rng) * 0.06 + noise(128, 4, 1, rng) * 0.06
    return to_image(0.88 + grain)


def _planks() -> Image:
    rng, size, rows = rng_for("planks"), 256, 10
    value = 0.86 + 0.05 * noise(size, 128, 4, rng)
    edges = np.linspace(0, size, rows + 1).astype(int)
    for top, bottom in itertools.pairwise(edges.tolist()):
        joint = int(rng.integers(size))
        tones = rng.uniform(-0.1, 0.1, 2)
        column = (np.arange(size) - joint) % size
        value[top:bottom] += np.where(column < size * 0.55, tones[0], tones[1])[None, :]
        value[top:bottom, [joint, (joint + int(size * 0.55)) % size]] = 0.5
        value[top, :] = 0.55
    return to_image(value)


def _deck() -> Image:
    rng, size = rng_for("deck"), 128
    value = 0.88 + 0.06 * noise(size, 64, 3, rng)
    for row in range(8):
        value[row * 16 : row * 16 + 16] += rng.uniform(-0.06, 0.06)
        value[row * 16 : row * 16 + 2] = 0.3
    return to_image(value)


def _grid(size: int, cells: int, grout: int, spread: float, grout_value: float, rng: np.random.Generator) -> Grey:
    cell = size // cells
    tones = 0.95 + spread * rng.uniform(-1, 1, (cells, cells))
    value = tones.repeat(cell, 0).repeat(cell, 1)
    index = np.arange(size) % cell < grout
    value[index, :] = grout_value
    value[:, index] = grout_value
    return np.asarray(value)


def _tile() -> Image:
    rng = rng_for("tile")
    return to_image(_grid(256, 4, 3, 0.03, 0.62, rng) + 0.015 * noise(256, 16, 16, rng))


def _checker() -> Image:
    rng = rng_for("checker")
    value = _grid(256, 4, 2, 0.02, 0.5, rng)
    cell = np.arange(256) // 64
    dark = (cell[:, None] + cell[None, :]) % 2 == 1
    return to_image(np.where(dark, value * 0.2, value))


def _mosaic() -> Image:
    return to_image(_grid(128, 8, 2, 0.12, 0.98, rng_for("mosaic")) * 0.95)


def _marble() -> Image:
    rng, size = rng_for("marble"), 256
    warp = noise(size, 4, 4, rng) * 1.5 + noise(size, 12, 12, rng) * 0.6
    y, x = np.mgrid[0:size, 0:size] / size
    veins = np.abs(np.sin(np.pi * (2 * x + 2 * y + warp)))
    return to_image(0.97 - 0.32 * np.exp(-veins * 9) - 0.05 * (noise(size, 6, 6, rng) + 1) / 2)


def _carpet() -> Image:
    rng = rng_for("carpet")
    return to_image(0.88 + 0.13 * rng.uniform(-1, 1, (128, 128)) + 0.04 * noise(128, 8, 8, rng))


def _brick() -> Image:
    rng, size = rng_for("brick"), 256
    value, mortar = np.full((size, size), 0.0), 1.35
    height, width = size // 12, size // 4
    for row in range(12):
        shift = (row % 2) * width // 2
        tones = np.roll(rng.uniform(0.74, 1.0, 4).repeat(width), shift)
        bottom = size if row == 11 else (row + 1) * height
        value[row * height : bottom] = tones[None, :]
        value[row * height : row * height + 3] = mortar
        seams = (np.arange(4) * width + shift) % size
        for offset in range(3):
            value[row * height : bottom, (seams + offset) % size] = mortar
    value += 0.05 * rng.uniform(-1, 1, (size, size))
    return to_image(value / 1.35)


def _stone() -> Image:
    rng, size = rng_for("stone"), 192
    points, tones = rng.uniform(0, size, (28, 2)), rng.uniform(0.62, 0.95, 28)
    along = np.arange(size)
    away_y = np.abs(along[None, :, None] - points[:, 0, None, None])
    away_x = np.abs(along[None, None, :] - points[:, 1, None, None])
    squared = np.minimum(away_y, size - away_y) ** 2 + (np.minimum(away_x, size - away_x) * 0.7) ** 2
    nearest, first = squared.argmin(axis=0)[None], np.sqrt(squared.min(axis=0))
    np.put_along_axis(squared, nearest, np.inf, axis=0)
    value = tones[nearest[0]] + 0.05 * noise(size, 32, 32, rng)
    return to_image(np.where(np.sqrt(squared.min(axis=0)) - first < 3, 0.42, value))


def _wicker() -> Image:
    y, x = np.mgrid[0:64, 0:64]
    over = ((x // 8) + (y // 8)) % 2 == 0
    ridge = np.where(over, np.abs(np.sin(np.pi * x / 4)), np.abs(np.sin(np.pi * y / 4)))
    return to_image(0.55 + 0.42 * ridge)


def _concrete() -> Image:
    rng = rng_for("concrete")
    return to_image(0.88 + 0.06 * noise(128, 5, 5, rng) + 0.04 * noise(128, 40, 40, rng) + 0.02 * rng.uniform(-1, 1, (128, 128)))


def _rubber() -> Image:
    rng = rng_for("rubber")
    value = np.full((128, 128), 0.8)
    value[rng.random((128, 128)) < 0.06] = 1.0
    value[:2, :] = 0.55
    value[:, :2] = 0.55
    return to_image(value)


def _brushed() -> Image:
    rng = rng_for("brushed")
    return to_image(0.9 + 0.07 * noise(128, 128, 2, rng))


def _folds() -> Image:
    x = np.arange(128) / 128
    value = 0.84 + 0.14 * np.sin(2 * np.pi * 4 * x) + 0.03 * np.sin(2 * np.pi * 9 * x)
    return to_image(np.tile(value, (16, 1)))


def _towel() -> Image:
    y = np.arange(64)
    value = 0.9 + 0.08 * np.sin(2 * np.pi * y / 8)
    return to_image(np.tile(value[:, None], (1, 16)) + 0.04 * rng_for("towel").uniform(-1, 1, (64, 16)))


def _striped() -> Image:
    x = np.arange(128)
    return to_image(np.tile(np.where((x // 16) % 2 == 0, 1.0, 0.55), (16, 1)))


def _plaid() -> Image:
    x = np.arange(128)
    band = np.where((x // 32) % 2 == 0, 0.25, 0.0) + np.where(x % 32 < 3, 0.15, 0.0)
    return to_image(0.98 - band[None, :] - band[:, None])


def _floral() -> Image:
    rng, size = rng_for("floral"), 128
    value = np.full((size, size), 0.95)
    y, x = np.mgrid[0:size, 0:size]
    for _ in range(16):
        cy, cx, petals = rng.uniform(0, size), rng.uniform(0, size), int(rng.integers(5, 8))
        dy, dx = (y - cy + size / 2) % size - size / 2, (x - cx + size / 2) % size - size / 2
        reach, distance = rng.uniform(7, 12), np.hypot(dy, dx)
        near = np.nonzero(distance < reach)
        petal = distance[near] < reach * (0.65 + 0.35 * np.cos(petals * np.arctan2(dy[near], dx[near])))
        value[near[0][petal], near[1][petal]] = 0.5
        value[distance < 2.5] = 1.0
    return to_image(value)


def _foliage() -> Image:
    rng = rng_for("foliage")
    return to_image(0.7 + 0.3 * noise(64, 16, 16, rng) + 0.1 * noise(64, 32, 32, rng))


def _lawn() -> Image:
    rng = rng_for("lawn")
    return to_image(0.8 + 0.1 * noise(128, 6, 6, rng) + 0.14 * rng.uniform(-1, 1, (128, 128)))


def _cardboard() -> Image:
    rng = rng_for("cardboard")
    return to_image(0.9 + 0.04 * noise(64, 4, 32, rng))


def _slats() -> Image:
    y = np.arange(128)
    value = np.where(y % 16 < 3, 0.55, 0.95 - 0.02 * (y % 16))
    return to_image(np.tile(value[:, None], (1, 16)))


PATTERNS: dict[str, Callable[[], Image]] = {
    "fabric": _fabric,
    "leather": _leather,
    "wood": _wood,
    "planks": _planks,
    "deck": _deck,
    "tile": _tile,
    "checker": _checker,
    "mosaic": _mosaic,
    "marble": _marble,
    "carpet": _carpet,
    "brick": _brick,
    "stone": _stone,
    "wicker": _wicker,
    "concrete": _concrete,
    "rubber": _rubber,
    "brushed": _brushed,
    "folds": _folds,
    "towel": _towel,
    "striped": _striped,
    "plaid": _plaid,
    "floral": _floral,
    "foliage": _foliage,
    "lawn": _lawn,
    "cardboard": _cardboard,
    "slats": _slats,
}
"""Texture name to painter; grey, tiling."""

SURFACES: dict[str, float] = {
    "paint": 2.0,
    "stripes": 0.6,
    "damask": 0.5,
    "tile": 0.8,
    "panel": 0.8,
    "brick": 1.0,
    "concrete": 2.0,
    "siding": 2.0,
}
"""Wall pattern to the length of wall [m] that its texture covers; its height is the wall's."""

_ROWS = 256


def paint_surface(pattern: str, colour: tuple[int, int, int]) -> Image:
    """A wall of one colour, (256, 8 or 128, 3): darker towards floor and ceiling, with a white skirting board."""
    rng = rng_for("wall" + pattern)
    columns = 8 if pattern in {"paint"} else 128
    tone = np.ones((_ROWS, columns))
    height = np.arange(_ROWS)[::-1] / _ROWS
    rgb = np.array(colour) / 255
    if pattern == "stripes":
        tone[:, :64] = 0.9
    elif pattern == "damask":
        motif = noise(128, 6, 6, rng)
        motif = np.where(motif + motif[:, ::-1] > 0.25, 0.9, 1.0)
        tone = np.tile(motif, (2, 1))
    elif pattern == "tile":
        x, y = np.arange(128), np.arange(_ROWS)
        tone[:, x % 32 < 2] = 0.78
        tone[y % 21 < 1, :] = 0.78
    elif pattern == "panel":
        x = np.arange(128)
        tone[:, x % 32 < 2] = 0.72
        tone *= 1 + 0.05 * noise(256, 2, 64, rng)[:, :128]
    elif pattern == "brick":
        brick = _brick()[:, :, 0] / 255
        tone = np.vstack([brick, brick, brick])[::3][:, ::2] * 1.25
    elif pattern == "siding":
        tone[np.arange(_ROWS) % 14 < 2, :] = 0.75
    else:
        tone = tone + 0.02 * noise(256, 16, 16, rng)[:, :columns]
    shade = 1.0 - 0.12 * np.exp(-height / 0.1) - 0.1 * np.exp(-(1 - height) / 0.06)
    value = np.clip(tone * shade[:, None], 0, 1)[:, :, None] * rgb
    if pattern not in {"tile", "concrete", "siding", "brick"}:
        board = height < 0.045
        value[board] = np.array([0.93, 0.92, 0.9]) * np.where(height[board] > 0.039, 0.7, 0.97)[:, None, None]
    return np.ascontiguousarray((np.clip(value, 0, 1) * 255).astype(np.uint8))
