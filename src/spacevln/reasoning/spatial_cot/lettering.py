"""Words as small pictures. The same words are drawn once: directions and rounded distances come again and again."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Colour = tuple[int, int, int]

INK: Colour = (28, 32, 44)
PAPER: Colour = (255, 255, 255)
PLATE: Colour = (0, 120, 220)
FONT_PX = 15
HEIGHT_PX = 20
MARGIN_PX = 5


@lru_cache(maxsize=1024)
def letters(words: str, colour: Colour, ground: Colour) -> NDArray[np.uint8]:
    """One line of words, (20, W, 3) RGB, to be copied and not written to."""
    font = ImageFont.load_default(FONT_PX)
    width = math.ceil(font.getlength(words)) + 2 * MARGIN_PX
    plate = Image.new("RGB", (width, HEIGHT_PX), ground)
    ImageDraw.Draw(plate).text((MARGIN_PX, HEIGHT_PX / 2), words, colour, font, anchor="lm", stroke_width=0.3)
    drawn = np.asarray(plate)
    drawn.flags.writeable = False
    return drawn
