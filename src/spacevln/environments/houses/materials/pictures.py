"""Pictures that are stretched over a face once: paintings, screens, books, rugs, clock faces."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.environments.houses.materials.patterns import noise, rng_for

Image = NDArray[np.uint8]
Rgb = tuple[int, int, int]


def _canvas(height: int, width: int, rgb: Rgb) -> Image:
    image = np.empty((height, width, 3), np.uint8)
    image[:] = rgb
    return image


def _gradient(height: int, width: int, top: Rgb, bottom: Rgb) -> Image:
    t = np.linspace(0, 1, height)[:, None, None]
    row = np.array(top) * (1 - t) + np.array(bottom) * t
    return np.ascontiguousarray(np.broadcast_to(row, (height, width, 3)).astype(np.uint8))


def _hills(image: Image, base: float, height: float, rgb: Rgb, rng: np.random.Generator) -> None:
    rows, columns = image.shape[:2]
    line = base - height * np.abs(noise(columns, 1, int(rng.integers(2, 6)), rng)[0])
    mask = np.arange(rows)[:, None] / rows > line[None, :]
    image[mask] = rgb


def _painting(variant: int) -> Image:
    rng = rng_for(f"painting{variant}")
    painters = (_landscape, _sea, _abstract_blocks, _abstract_circles, _flowers, _portrait)
    return painters[variant % len(painters)](rng)


def _landscape(rng: np.random.Generator) -> Image:
    image = _gradient(128, 160, (120, 170, 220), (236, 220, 190))
    cv2.circle(image, (int(rng.integers(20, 140)), 26), 10, (255, 240, 180), -1)
    for base, height, rgb in ((0.6, 0.35, (110, 120, 150)), (0.7, 0.25, (80, 120, 90)), (0.82, 0.15, (60, 110, 50))):
        _hills(image, base, height, rgb, rng)
    for _ in range(6):
        x = int(rng.integers(0, 160))
        cv2.fillPoly(image, [np.array([[x - 7, 120], [x + 7, 120], [x, 88]])], (24, 66, 34))
    return image


def _sea(rng: np.random.Generator) -> Image:
    image = _gradient(128, 160, (250, 150, 70), (255, 216, 130))
    image[70:] = _gradient(58, 160, (60, 110, 160), (20, 50, 90))
    cv2.circle(image, (80, 66), 16, (255, 246, 190), -1)
    image[72:] = np.minimum(image[72:], _gradient(56, 160, (90, 130, 170), (30, 60, 100)))
    x = int(rng.integers(30, 120))
    cv2.fillPoly(image, [np.array([[x, 92], [x + 26, 92], [x + 20, 100], [x + 5, 100]])], (70, 40, 30))
    cv2.fillPoly(image, [np.array([[x + 13, 88], [x + 13, 56], [x + 28, 86]])], (245, 240, 230))
    return image


_MODERN: tuple[Rgb, ...] = ((200, 40, 40), (30, 70, 160), (240, 200, 50), (245, 242, 235), (30, 30, 34), (40, 140, 130))


def _abstract_blocks(rng: np.random.Generator) -> Image:
    image = _canvas(128, 128, (245, 242, 235))
    xs, ys = np.sort(rng.integers(10, 118, 3)), np.sort(rng.integers(10, 118, 3))
    columns, rows = [0, *map(int, xs), 128], [0, *map(int, ys), 128]
    for x0, x1 in itertools.pairwise(columns):
        for y0, y1 in itertools.pairwise(rows):
            cv2.rectangle(image, (x0, y0), (x1, y1), _MODERN[int(rng.integers(len(_MODERN)))], -1)
            cv2.rectangle(image, (x0, y0), (x1, y1), (20, 20, 20), 3)
    return image


def _abstract_circles(rng: np.random.Generator) -> Image:
    image = _canvas(128, 128, (226, 214, 190))
    for _ in range(9):
        centre = (int(rng.integers(10, 118)), int(rng.integers(10, 118)))
        cv2.circle(image, centre, int(rng.integers(6, 28)), _MODERN[int(rng.integers(len(_MODERN)))], -1)
        cv2.line(image, centre, (int(rng.integers(128)), int(rng.integers(128))), (30, 30, 30), 2)
    return image


def _flowers(rng: np.random.Generator) -> Image:
    image = _gradient(160, 128, (208, 196, 170), (150, 130, 100))
    cv2.ellipse(image, (64, 130), (20, 26), 0, 0, 360, (60, 90, 150), -1)
    for _ in range(12):
        x, y = int(rng.normal(64, 22)), int(rng.normal(66, 20))
        cv2.line(image, (64, 112), (x, y), (50, 100, 50), 2)
        cv2.circle(image, (x, y), 9, ((220, 60, 80), (240, 200, 80), (235, 235, 235))[int(rng.integers(3))], -1)
        cv2.circle(image, (x, y), 3, (250, 220, 90), -1)
    return image


def _portrait(rng: np.random.Generator) -> Image:
    image = _gradient(160, 128, (70, 60, 46), (40, 34, 30))
    coat = ((120, 30, 40), (30, 60, 90), (40, 80, 50))[int(rng.integers(3))]
    cv2.ellipse(image, (64, 160), (50, 56), 0, 0, 360, coat, -1)
    cv2.ellipse(image, (64, 60), (28, 34), 0, 0, 360, (60, 40, 26), -1)
    cv2.ellipse(image, (64, 70), (22, 29), 0, 0, 360, (222, 178, 146), -1)
    for x in (55, 73):
        cv2.circle(image, (x, 66), 3, (30, 24, 20), -1)
    cv2.ellipse(image, (64, 84), (8, 3), 0, 0, 180, (160, 70, 70), 2)
    return image


def _books(variant: int) -> Image:
    rng = rng_for(f"books{variant}")
    image = _canvas(64, 256, (40, 30, 24))
    x = 0
    shades: tuple[Rgb, ...] = (
        (150, 40, 40), (40, 80, 130), (50, 110, 70), (200, 170, 90), (90, 60, 110), (220, 210, 190), (60, 60, 66), (190, 100, 50)
    )  # fmt: skip
    while x < 250:
        width, top = int(rng.integers(7, 18)), int(rng.integers(2, 20))
        rgb = shades[int(rng.integers(len(shades)))]
        cv2.rectangle(image, (x, top), (x + width - 2, 63), rgb, -1)
        cv2.rectangle(image, (x, top + 8), (x + width - 2, top + 12), (230, 210, 150), -1)
        x += width + (int(rng.integers(8, 16)) if rng.random() < 0.08 else 0)
    return image


def _rug(variant: int) -> Image:
    rng = rng_for(f"rug{variant}")
    themes: tuple[tuple[Rgb, Rgb, Rgb], ...] = (
        ((150, 34, 34), (232, 206, 150), (30, 44, 80)),
        ((40, 70, 130), (230, 226, 214), (190, 150, 80)),
        ((214, 206, 192), (120, 116, 112), (60, 60, 64)),
        ((60, 110, 90), (234, 224, 196), (190, 110, 60)),
    )
    base, second, third = themes[variant % len(themes)]
    image = _canvas(192, 256, base)
    for inset, rgb, width in ((6, second, 5), (18, third, 9), (32, second, 3)):
        cv2.rectangle(image, (inset, inset), (255 - inset, 191 - inset), rgb, width)
    if variant % 3 == 2:
        for k in range(-192, 256, 32):
            cv2.line(image[36:156, 36:220], (k, 0), (k + 120, 120), second, 4)
            cv2.line(image[36:156, 36:220], (k + 120, 0), (k, 120), second, 4)
        return image
    for radius, rgb in ((52, second), (44, third), (34, base), (22, second), (12, third)):
        diamond = np.array([[128 - radius * 1.4, 96], [128, 96 - radius], [128 + radius * 1.4, 96], [128, 96 + radius]])
        cv2.fillPoly(image, [diamond.astype(np.int32)], rgb)
    for x in (52, 204):
        for y in (48, 144):
            cv2.circle(image, (x, y), 12, second, -1)
            cv2.circle(image, (x, y), 6, third, -1)
    speckle = rng.normal(0, 7, image.shape[:2])[:, :, None]
    return np.ascontiguousarray(np.clip(image + speckle, 0, 255).astype(np.uint8))


def _runner(variant: int) -> Image:
    """A long rug of the colours of ``_rug``, with borders of one width on all sides."""
    themes: tuple[tuple[Rgb, Rgb, Rgb], ...] = (
        ((150, 34, 34), (232, 206, 150), (30, 44, 80)),
        ((40, 70, 130), (230, 226, 214), (190, 150, 80)),
        ((214, 206, 192), (120, 116, 112), (60, 60, 64)),
    )
    base, second, third = themes[variant % len(themes)]
    image = _canvas(96, 256, base)
    for inset, rgb, width in ((3, second, 4), (10, third, 5), (18, second, 2)):
        cv2.rectangle(image, (inset, inset), (255 - inset, 95 - inset), rgb, width)
    for x in (56, 128, 200):
        for radius, rgb in ((26, second), (21, third), (14, base), (7, second)):
            diamond = np.array([[x - radius * 1.2, 48], [x, 48 - radius], [x + radius * 1.2, 48], [x, 48 + radius]])
            cv2.fillPoly(image, [diamond.astype(np.int32)], rgb)
    speckle = rng_for(f"runner{variant}").normal(0, 7, image.shape[:2])[:, :, None]
    return np.ascontiguousarray(np.clip(image + speckle, 0, 255).astype(np.uint8))


def _roundrug(variant: int) -> Image:
    themes: tuple[tuple[Rgb, Rgb], ...] = (((60, 90, 140), (228, 222, 208)), ((170, 60, 50), (236, 214, 160)))
    base, second = themes[variant % len(themes)]
    image = _canvas(192, 192, base)
    for index, radius in enumerate(range(92, 6, -14)):
        cv2.circle(image, (96, 96), radius, second if index % 2 else base, -1)
    return image


def _sky(variant: int) -> Image:
    rng = rng_for(f"sky{variant}")
    image = _gradient(192, 192, (120, 178, 236), (222, 236, 246))
    for _ in range(7):
        centre = (int(rng.integers(192)), int(rng.integers(10, 90)))
        cv2.ellipse(image, centre, (int(rng.integers(14, 34)), int(rng.integers(5, 11))), 0, 0, 360, (246, 249, 252), -1)
    image = np.asarray(cv2.GaussianBlur(image, (9, 9), 0), np.uint8)
    _hills(image, 0.72, 0.14, (146, 172, 170), rng)
    _hills(image, 0.8, 0.14, (110, 154, 96), rng)
    image[166:] = _gradient(26, 192, (128, 170, 92), (112, 158, 80))
    for _ in range(5):
        x, size = int(rng.integers(192)), int(rng.integers(9, 18))
        cv2.rectangle(image, (x - 2, 150), (x + 2, 168), (92, 66, 46), -1)
        cv2.circle(image, (x, 146), size, (70, 126, 62), -1)
        cv2.circle(image, (x - 4, 142), size // 2, (92, 148, 78), -1)
    return np.asarray(image)


def _mirror(variant: int) -> Image:
    image = _gradient(128, 128, (206, 224, 232), (158, 182, 194))
    shine = _canvas(128, 128, (0, 0, 0))
    for offset, width in ((10 + 4 * variant, 16), (46, 7)):
        corners = [[offset, 127], [offset + width, 127], [offset + width + 70, 0], [offset + 70, 0]]
        cv2.fillPoly(shine, [np.array(corners)], (34, 30, 26))
    return np.asarray(cv2.add(image, shine))


def _tv(variant: int) -> Image:
    image = _gradient(96, 160, (34, 38, 46), (12, 13, 16))
    corners = [[20 + 8 * variant, 95], [60 + 8 * variant, 95], [120, 0], [80, 0]]
    shine = _canvas(96, 160, (0, 0, 0))
    cv2.fillPoly(shine, [np.array(corners)], (22, 24, 28))
    return np.asarray(cv2.add(image, shine))


def _screen(variant: int) -> Image:
    image = _gradient(96, 144, (36, 92, 168), (96, 168, 214))
    cv2.rectangle(image, (12, 10), (84, 66), (246, 246, 248), -1)
    cv2.rectangle(image, (12, 10), (84, 18), (70, 76, 90), -1)
    for row in range(6):
        cv2.line(image, (18, 26 + row * 6), (48 + (row * 37 + 11 * variant) % 30, 26 + row * 6), (120, 124, 132), 2)
    cv2.rectangle(image, (72, 34), (132, 80), (252, 244, 224), -1)
    cv2.rectangle(image, (72, 34), (132, 42), (200, 90, 60), -1)
    cv2.rectangle(image, (0, 88), (143, 95), (24, 30, 44), -1)
    return image


def _keyboard(variant: int) -> Image:
    back: Rgb = ((44, 44, 48), (214, 214, 218))[variant % 2]
    key: Rgb = ((92, 92, 98), (250, 250, 250))[variant % 2]
    image = _canvas(48, 128, back)
    for row in range(4):
        for column in range(14):
            x, y = 4 + column * 9 - (row % 2) * 2, 4 + row * 9
            cv2.rectangle(image, (x, y), (x + 6, y + 6), key, -1)
    cv2.rectangle(image, (34, 40), (90, 45), key, -1)
    return image


def _pianokeys(variant: int) -> Image:
    image = _canvas(32, 256, (246, 244, 236))
    for k in range(36):
        x = int(k * 256 / 36)
        cv2.line(image, (x, 0), (x, 31), (120, 120, 120), 1)
        if (k + variant) % 7 not in (2, 6):
            cv2.rectangle(image, (x + 5, 0), (x + 9, 19), (16, 16, 18), -1)
    return image


def _clock(variant: int) -> Image:
    image = _canvas(128, 128, (250, 248, 240))
    for k in range(12):
        angle = k * np.pi / 6
        tip = (64 + 56 * np.sin(angle), 64 - 56 * np.cos(angle))
        root = (64 + 46 * np.sin(angle), 64 - 46 * np.cos(angle))
        cv2.line(image, (int(root[0]), int(root[1])), (int(tip[0]), int(tip[1])), (20, 20, 20), 5 if k % 3 == 0 else 3)
    hour, minute = (variant * 1.3 + 1.9), 0.7
    cv2.line(image, (64, 64), (int(64 + 28 * np.sin(hour)), int(64 - 28 * np.cos(hour))), (20, 20, 20), 6)
    cv2.line(image, (64, 64), (int(64 + 44 * np.sin(minute)), int(64 - 44 * np.cos(minute))), (20, 20, 20), 4)
    cv2.circle(image, (64, 64), 5, (180, 30, 30), -1)
    return image


def _calendar(variant: int) -> Image:
    image = _canvas(160, 112, (250, 250, 248))
    image[:70] = cv2.resize(_landscape(rng_for(f"calendar{variant}")), (112, 70), interpolation=cv2.INTER_AREA)
    cv2.rectangle(image, (0, 70), (111, 82), (190, 40, 40), -1)
    for row in range(5):
        for column in range(7):
            rgb = (200, 50, 50) if column == 6 else (70, 70, 76)
            cv2.rectangle(image, (8 + column * 14, 90 + row * 14), (15 + column * 14, 97 + row * 14), rgb, -1)
    return image


def _exitsign(variant: int) -> Image:
    del variant
    image = _canvas(64, 128, (196, 24, 24))
    cv2.rectangle(image, (3, 3), (124, 60), (250, 250, 250), 3)
    cv2.putText(image, "EXIT", (15, 46), cv2.FONT_HERSHEY_SIMPLEX, 1.25, (255, 255, 255), 5, cv2.LINE_AA)
    return image


def _globe(variant: int) -> Image:
    rng = rng_for(f"globe{variant}")
    land = noise(128, 5, 6, rng) + 0.5 * noise(128, 14, 14, rng) > 0.15
    image = _canvas(128, 128, (52, 112, 186))
    image[land] = (96, 150, 70)
    image[:8] = image[-8:] = (240, 244, 248)
    return image


def _aquarium(variant: int) -> Image:
    rng = rng_for(f"aquarium{variant}")
    image = _gradient(96, 192, (120, 206, 232), (34, 110, 176))
    image[84:] = (206, 182, 128)
    for _ in range(9):
        x = int(rng.integers(192))
        cv2.line(image, (x, 86), (x + int(rng.integers(-8, 8)), int(rng.integers(36, 66))), (40, 140, 70), 4)
    for _ in range(8):
        x, y = int(rng.integers(16, 176)), int(rng.integers(14, 70))
        rgb = ((250, 130, 40), (250, 220, 70), (220, 60, 90))[int(rng.integers(3))]
        cv2.ellipse(image, (x, y), (10, 5), 0, 0, 360, rgb, -1)
        cv2.fillPoly(image, [np.array([[x - 9, y], [x - 16, y - 6], [x - 16, y + 6]])], rgb)
        cv2.circle(image, (x + 6, y - 1), 1, (10, 10, 10), -1)
    return image


def _fire(variant: int) -> Image:
    rng = rng_for(f"fire{variant}")
    image = _canvas(96, 128, (24, 18, 16))
    for rgb, height, count in (((214, 70, 20), 70, 11), ((246, 150, 30), 52, 9), ((255, 226, 110), 32, 7)):
        for k in range(count):
            x = int(64 + (k - count / 2) * 9 + rng.integers(-3, 3))
            tip = 88 - int(height * rng.uniform(0.6, 1.0))
            cv2.fillPoly(image, [np.array([[x - 8, 88], [x + 8, 88], [x + int(rng.integers(-5, 5)), tip]])], rgb)
    cv2.rectangle(image, (18, 82), (110, 92), (90, 56, 34), -1)
    cv2.rectangle(image, (18, 90), (110, 95), (64, 40, 26), -1)
    return image


def _dartboard(variant: int) -> Image:
    image = _canvas(128, 128, (30, 30, 30))
    for k in range(20):
        rgb = (236, 224, 190) if (k + variant) % 2 else (24, 24, 24)
        cv2.ellipse(image, (64, 64), (52, 52), 0, k * 18, k * 18 + 18, rgb, -1)
        ring = (190, 40, 36) if k % 2 else (36, 130, 66)
        cv2.ellipse(image, (64, 64), (50, 50), 0, k * 18, k * 18 + 18, ring, 4)
        cv2.ellipse(image, (64, 64), (31, 31), 0, k * 18, k * 18 + 18, ring, 4)
    cv2.circle(image, (64, 64), 8, (36, 130, 66), -1)
    cv2.circle(image, (64, 64), 4, (190, 40, 36), -1)
    return image


def _poster(variant: int) -> Image:
    image = _canvas(160, 112, ((36, 52, 92), (206, 66, 50), (40, 120, 110))[variant % 3])
    cv2.circle(image, (56, 66), 34, (246, 210, 90), -1)
    cv2.fillPoly(image, [np.array([[0, 130], [40, 70], [76, 130]])], (30, 34, 46))
    cv2.fillPoly(image, [np.array([[50, 130], [86, 84], [112, 130]])], (60, 66, 84))
    cv2.rectangle(image, (14, 138), (98, 148), (245, 242, 235), -1)
    return image


def _cooktop(variant: int) -> Image:
    del variant
    image = _canvas(128, 128, (26, 26, 28))
    for x in (36, 92):
        for y in (38, 92):
            cv2.circle(image, (x, y), 22, (110, 112, 116), 3)
            cv2.circle(image, (x, y), 13, (170, 60, 40), 4)
            cv2.circle(image, (x, y), 4, (90, 92, 96), -1)
    return image


PICTURES: dict[str, Callable[[int], Image]] = {
    "painting": _painting,
    "books": _books,
    "rug": _rug,
    "roundrug": _roundrug,
    "runner": _runner,
    "sky": _sky,
    "mirror": _mirror,
    "tv": _tv,
    "screen": _screen,
    "keyboard": _keyboard,
    "pianokeys": _pianokeys,
    "clock": _clock,
    "calendar": _calendar,
    "exitsign": _exitsign,
    "globe": _globe,
    "aquarium": _aquarium,
    "fire": _fire,
    "dartboard": _dartboard,
    "poster": _poster,
    "cooktop": _cooktop,
}
"""Picture name to painter of a variant."""
