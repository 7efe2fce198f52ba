"""What builders of furniture work with: a kit of primitives, looks, and the register of categories."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.furniture.mesh import part_triangles
from spacevln.environments.houses.plan import Part, PartShape

Stand = Literal["floor", "top", "wall", "ceiling", "flat"]
"""Where a category belongs: on the floor, on top of a support, on a wall, under the ceiling, flat on the floor (walked over)."""

Size = tuple[float, float, float]
_Z: Size = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Look:
    """A variant of a category.

    Args:
        words: attributes, colour first, then material, then shape.
        main, trim: material keys.
        variant: number of the picture or form.
    """

    words: tuple[str, ...]
    main: str
    trim: str = "plain-black"
    variant: int = 0


@dataclass(slots=True)
class Kit:
    """Collects the parts of one item; lengths are full sizes, ``z`` is the lower edge, ``rng`` chooses proportions."""

    rng: np.random.Generator
    parts: list[Part] = field(default_factory=list)

    def _add(self, shape: PartShape, stuff: str, size: Size, x: float, y: float, z: float, turn: Size, mesh: str = "") -> None:
        self.parts.append(Part(shape, size, (x, y, z), stuff, turn, mesh))

    def box(self, stuff: str, w: float, d: float, h: float, x: float = 0, y: float = 0, z: float = 0, turn: Size = _Z) -> None:
        """A box."""
        self._add("box", stuff, (w / 2, d / 2, h / 2), x, y, z + h / 2, turn)

    def rod(self, stuff: str, r: float, h: float, x: float = 0, y: float = 0, z: float = 0, turn: Size = _Z) -> None:
        """An upright cylinder (before ``turn`` about its centre)."""
        self._add("cylinder", stuff, (r, h / 2, 0.0), x, y, z + h / 2, turn)

    def bar(self, stuff: str, r: float, w: float, x: float = 0, y: float = 0, z: float = 0, along: str = "x") -> None:
        """A lying cylinder whose middle line is at height ``z``."""
        turn = (0.0, math.pi / 2, 0.0) if along == "x" else (math.pi / 2, 0.0, 0.0)
        self._add("cylinder", stuff, (r, w / 2, 0.0), x, y, z, turn)

    def ball(self, stuff: str, w: float, d: float, h: float, x: float = 0, y: float = 0, z: float = 0, turn: Size = _Z) -> None:
        """An ellipsoid."""
        self._add("ellipsoid", stuff, (w / 2, d / 2, h / 2), x, y, z + h / 2, turn)

    def mesh(
        self, name: str, stuff: str, w: float, d: float, h: float, x: float = 0, y: float = 0, z: float = 0, turn: Size = _Z
    ) -> None:
        """A self-made mesh scaled to w, d, h."""
        self._add("mesh", stuff, (w / 2, d / 2, h / 2), x, y, z + h / 2, turn, name)

    def legs(self, stuff: str, w: float, d: float, h: float, t: float = 0.05, x: float = 0, y: float = 0, z: float = 0) -> None:
        """Four square legs under the corners of w by d."""
        for sx in (-1, 1):
            for sy in (-1, 1):
                self.box(stuff, t, t, h, x + sx * (w - t) / 2, y + sy * (d - t) / 2, z)

    def fronts(
        self, stuff: str, knob: str, w: float, h: float, y: float, z: float, columns: int, rows: int, gap: float = 0.015
    ) -> None:
        """Doors or drawers with knobs on the front plane ``y``."""
        cell_w, cell_h = w / columns, h / rows
        for i in range(columns):
            for j in range(rows):
                x = -w / 2 + (i + 0.5) * cell_w
                self.box(stuff, cell_w - gap, 0.016, cell_h - gap, x, y, z + j * cell_h + gap / 2)
                tall = cell_h > cell_w * 1.2
                side = (1 if i % 2 == 0 else -1) * (cell_w / 2 - 0.05)
                if tall:
                    self.box(knob, 0.018, 0.03, 0.12, x + side, y + 0.02, z + (j + 0.5) * cell_h - 0.06)
                else:
                    self.box(knob, min(0.14, cell_w * 0.3), 0.03, 0.018, x, y + 0.02, z + (j + 0.5) * cell_h)


Builder = Callable[[Kit, Look], None]


@dataclass(frozen=True, slots=True)
class Kind:
    """A category of the catalogue.

    Args:
        category: its name.
        build: adds parts to a kit.
        looks: its variants.
        stand: where it belongs.
        top_m: height of the surface that carries things, or None.
    """

    category: str
    build: Builder
    looks: tuple[Look, ...]
    stand: Stand
    top_m: float | None

    @property
    def solid(self) -> bool:
        """Whether it blocks the agent where it stands."""
        return self.stand == "floor"


CATALOGUE: dict[str, Kind] = {}


def kind(
    category: str, looks: tuple[Look, ...], stand: Stand = "floor", top_m: float | None = None
) -> Callable[[Builder], Builder]:
    """Register a builder under its category."""

    def register(build: Builder) -> Builder:
        CATALOGUE[category] = Kind(category, build, looks, stand, top_m)
        return build

    return register


@dataclass(frozen=True, slots=True)
class Design:
    """A built item without a place.

    Args:
        category, attributes, size, parts: as of ``Item``.
    """

    category: str
    attributes: tuple[str, ...]
    size: Size
    parts: tuple[Part, ...]


@lru_cache(maxsize=4096)
def design(category: str, look: int, form: int = 0) -> Design:
    """Build an item, centred over its footprint and with its base at height 0.

    Args:
        category: of the catalogue.
        look: index of its variant, taken modulo their number.
        form: seed of its proportions.

    Raises:
        UnknownNameError: the catalogue has no such category.
    """
    if category not in CATALOGUE:
        raise UnknownNameError("furniture category", category, CATALOGUE)
    made = CATALOGUE[category]
    variant = made.looks[look % len(made.looks)]
    kit = Kit(np.random.default_rng([form, 5]))
    made.build(kit, variant)
    points = [part_triangles(part).points for part in kit.parts]
    low = np.min([p.min(axis=0) for p in points], axis=0)
    high = np.max([p.max(axis=0) for p in points], axis=0)
    dx, dy, dz = (-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2])
    parts = tuple(
        replace(
            part, position=(round(part.position[0] + dx, 5), round(part.position[1] + dy, 5), round(part.position[2] + dz, 5))
        )
        for part in kit.parts
    )
    width, depth, height = (round(float(extent), 4) for extent in high - low)
    return Design(category, variant.words, (width, depth, height), parts)


def looks(*rows: tuple[str, str] | tuple[str, str, str] | tuple[str, str, str, int]) -> tuple[Look, ...]:
    """Rows of (words, main material, trim material, variant) as looks."""
    return tuple(Look(tuple(row[0].split()), *row[1:]) for row in rows)


def fabrics(*colours: str, trim: str = "wood-walnut", material: str = "fabric") -> tuple[Look, ...]:
    """One look per colour of a fabric."""
    return tuple(Look((colour,), f"{material}-{colour}", trim) for colour in colours)


def woods(*names: str, word: str = "wooden") -> tuple[Look, ...]:
    """Looks in wood (``oak`` is brown wooden), or painted in a colour."""
    timber = {"oak": "brown", "walnut": "brown", "pine": "beige", "cherry": "red", "mahogany": "brown", "maple": "beige"}
    made = []
    for name in names:
        if name in timber:
            made.append(Look((timber[name], word), f"wood-{name}", f"wood-{name}"))
        else:
            made.append(Look((name,), f"plain-{name}", f"plain-{name}"))
    return tuple(made)
