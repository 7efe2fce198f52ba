"""The material catalogue: a key such as ``"wood-oak"`` or ``"painting-3"`` names a finish and a colour, or a picture.

Flat colours share one palette texture, so that all flat parts of an item are drawn at once; patterns are grey and tinted
by colour, so that one texture serves every colour of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.materials.patterns import PATTERNS, SURFACES, paint_surface
from spacevln.environments.houses.materials.pictures import PICTURES

COLOURS: dict[str, tuple[int, int, int]] = {
    "white": (238, 236, 230),
    "ivory": (232, 222, 198),
    "cream": (236, 220, 180),
    "beige": (212, 192, 158),
    "tan": (192, 152, 104),
    "brown": (122, 78, 44),
    "chocolate": (78, 48, 30),
    "black": (34, 34, 36),
    "charcoal": (62, 64, 68),
    "gray": (138, 140, 144),
    "silver": (188, 192, 198),
    "red": (186, 38, 36),
    "burgundy": (124, 28, 44),
    "orange": (228, 124, 38),
    "yellow": (238, 200, 62),
    "gold": (206, 162, 62),
    "brass": (186, 148, 74),
    "green": (66, 128, 70),
    "olive": (118, 122, 66),
    "sage": (166, 184, 158),
    "mint": (188, 220, 204),
    "teal": (36, 128, 132),
    "blue": (46, 92, 176),
    "navy": (34, 48, 92),
    "sky": (166, 200, 228),
    "purple": (112, 66, 142),
    "lavender": (196, 186, 218),
    "pink": (228, 150, 166),
    "terracotta": (192, 104, 70),
    "oak": (186, 138, 86),
    "pine": (220, 180, 124),
    "walnut": (104, 66, 42),
    "cherry": (142, 70, 44),
    "mahogany": (96, 38, 28),
    "maple": (226, 194, 148),
    "steel": (168, 174, 180),
    "copper": (184, 108, 70),
    "skin": (220, 178, 148),
    "leaf": (62, 122, 48),
    "grass": (126, 166, 88),
    "glass": (176, 208, 214),
    "water": (96, 172, 206),
    "felt": (22, 112, 66),
    "soil": (66, 46, 34),
    "lamp": (255, 240, 206),
    "flame": (255, 150, 40),
    "sun": (255, 226, 110),
}
"""Colour words and the red, green and blue they mean, 0 to 255."""

PALETTE_SIDE = 16
_ORDER = {name: index for index, name in enumerate(COLOURS)}


@dataclass(frozen=True, slots=True)
class Material:
    """How a surface looks.

    Args:
        key: name in the catalogue.
        draw: parts with equal ``draw`` are drawn together; the name of the compiled material.
        texture: name of its texture.
        rgb: tint, 0 to 1, multiplied with the texture.
        scale_m: edge length that the texture covers; None = the picture is stretched over a face once.
        grain: the texture has a direction, laid along the longer side of a face.
        specular, shininess, emission: 0 to 1.
        palette_uv: texture coordinates of a flat colour, or None.
    """

    key: str
    draw: str
    texture: str
    rgb: tuple[float, float, float] = (1.0, 1.0, 1.0)
    scale_m: float | None = 1.0
    grain: bool = False
    specular: float = 0.05
    shininess: float = 0.1
    emission: float = 0.0
    palette_uv: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class _Finish:
    scale_m: float
    grain: bool = False
    specular: float = 0.05
    shininess: float = 0.1


_FLAT = {"plain": (0.06, 0.1, 0.0), "gloss": (0.45, 0.6, 0.0), "glow": (0.0, 0.0, 0.75), "lit": (0.0, 0.0, 0.42)}
_FINISHES = {
    "fabric": _Finish(0.22),
    "leather": _Finish(0.5, specular=0.3, shininess=0.4),
    "wood": _Finish(0.8, grain=True, specular=0.12, shininess=0.3),
    "planks": _Finish(1.6, specular=0.12, shininess=0.3),
    "deck": _Finish(1.2),
    "tile": _Finish(1.2, specular=0.2, shininess=0.5),
    "checker": _Finish(1.2, specular=0.2, shininess=0.5),
    "mosaic": _Finish(0.5, specular=0.2, shininess=0.5),
    "marble": _Finish(1.4, specular=0.3, shininess=0.6),
    "carpet": _Finish(0.8),
    "brick": _Finish(1.0),
    "stone": _Finish(1.4),
    "wicker": _Finish(0.2),
    "concrete": _Finish(2.0),
    "rubber": _Finish(1.0),
    "brushed": _Finish(0.5, grain=True, specular=0.5, shininess=0.6),
    "folds": _Finish(0.5),
    "towel": _Finish(0.2),
    "striped": _Finish(0.4),
    "plaid": _Finish(0.4),
    "floral": _Finish(0.5),
    "foliage": _Finish(0.3),
    "lawn": _Finish(3.0),
    "cardboard": _Finish(0.5),
    "slats": _Finish(0.4),
}


@lru_cache(maxsize=2048)
def material(key: str) -> Material:
    """Look a material up.

    Args:
        key: ``"<finish>-<colour>"`` (``"leather-black"``), ``"wall-<pattern>-<colour>"`` or ``"<picture>-<variant>"``.

    Raises:
        UnknownNameError: nothing of that name exists.
    """
    head, _, tail = key.partition("-")
    if head == "wall":
        pattern, _, colour = tail.partition("-")
        if pattern not in SURFACES:
            raise UnknownNameError("wall surface", pattern, SURFACES)
        _check_colour(colour)
        return Material(key, key, key, scale_m=SURFACES[pattern])
    if head in PICTURES and tail.isdigit():
        emission = 0.35 if head in {"sky", "screen", "exitsign", "fire"} else 0.0
        return Material(key, key, key, scale_m=None, emission=emission, specular=0.1)
    _check_colour(tail)
    if head in _FLAT:
        specular, shininess, emission = _FLAT[head]
        row, column = divmod(_ORDER[tail], PALETTE_SIDE)
        uv = ((column + 0.5) / PALETTE_SIDE, (row + 0.5) / PALETTE_SIDE)
        return Material(key, head, "palette", specular=specular, shininess=shininess, emission=emission, palette_uv=uv)
    if head not in _FINISHES:
        raise UnknownNameError("finish", head, [*_FLAT, *_FINISHES, *PICTURES, "wall"])
    finish = _FINISHES[head]
    red, green, blue = COLOURS[tail]
    rgb = (red / 255, green / 255, blue / 255)
    return Material(key, key, head, rgb, finish.scale_m, finish.grain, finish.specular, finish.shininess)


def _check_colour(name: str) -> None:
    if name not in COLOURS:
        raise UnknownNameError("colour", name, COLOURS)


@lru_cache(maxsize=512)
def texture(name: str) -> NDArray[np.uint8]:
    """Paint a texture.

    Args:
        name: ``Material.texture``.

    Returns:
        (height, width, 3) uint8, row 0 at the top, at most 256 px a side; equal for equal names.
    """
    if name == "palette":
        image = np.zeros((PALETTE_SIDE, PALETTE_SIDE, 3), np.uint8)
        for colour, index in _ORDER.items():
            image[divmod(index, PALETTE_SIDE)] = COLOURS[colour]
        # the palette is addressed by row from the bottom, as texture coordinates are
        return np.ascontiguousarray(image.repeat(4, 0).repeat(4, 1)[::-1])
    head, _, tail = name.partition("-")
    if head == "wall":
        pattern, _, colour = tail.partition("-")
        return paint_surface(pattern, COLOURS[colour])
    if tail.isdigit():
        return PICTURES[head](int(tail))
    return PATTERNS[name]()
