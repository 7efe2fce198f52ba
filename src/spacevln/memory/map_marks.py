"""What is drawn on the rendered map: its colours, and names, rings and the legend as small ready pictures."""

from __future__ import annotations

import math
from functools import lru_cache

from PIL import Image, ImageDraw, ImageFont

SIZE_PX = 440  # [authors' code]
LEGEND_PX = 40

Colour = tuple[int, int, int]
Box = tuple[float, float, float, float]  # x0, y0, x1, y1

DIRECTION_BOXES: tuple[Box, ...] = (  # where the words at the borders stand
    (SIZE_PX / 2 - 18, 0, SIZE_PX / 2 + 18, 20),
    (SIZE_PX / 2 - 18, SIZE_PX - 20, SIZE_PX / 2 + 18, SIZE_PX),
    (0, SIZE_PX / 2 - 10, 34, SIZE_PX / 2 + 10),
    (SIZE_PX - 34, SIZE_PX / 2 - 10, SIZE_PX, SIZE_PX / 2 + 10),
    (SIZE_PX - 80, SIZE_PX - 28, SIZE_PX, SIZE_PX),  # scale
)

UNKNOWN: Colour = (238, 239, 243)
FREE: Colour = (214, 232, 208)
OBSTACLE: Colour = (38, 42, 54)
WALKED: Colour = (142, 52, 168)
AGENT: Colour = (218, 38, 38)
THRESHOLD: Colour = (201, 123, 30)
INK: Colour = (28, 32, 44)
FRAME: Colour = (120, 126, 140)
REGIONS: tuple[Colour, ...] = (
    (166, 206, 240), (250, 205, 160), (186, 172, 232), (244, 184, 200), (160, 222, 218),
    (248, 232, 150), (226, 190, 160), (190, 200, 222), (236, 176, 232), (240, 160, 150),
)  # fmt: skip


@lru_cache(maxsize=256)
def tag(label: str, colour: Colour) -> Image.Image:
    """A name on a rounded plate in the dark tone of its region."""
    font = _font(13)
    width = math.ceil(ImageDraw.Draw(Image.new("RGBA", (1, 1))).textlength(label, font)) + 12
    plate = Image.new("RGBA", (width, 19))
    draw = ImageDraw.Draw(plate)
    dark = tuple(round(channel * 0.42) for channel in colour)
    draw.rounded_rectangle((0, 0, width - 1, 18), 5, fill=(*dark, 255), outline=(255, 255, 255, 255))
    draw.text((width / 2, 9), label, (255, 255, 255, 255), font, anchor="mm")
    return plate


@lru_cache(maxsize=512)
def ring(number: int) -> Image.Image:
    """The mark of a waypoint; four times drawn, then reduced, so that it is round."""
    big = Image.new("RGBA", (64, 64))
    ImageDraw.Draw(big).ellipse((2, 2, 61, 61), fill=(255, 255, 255, 255), outline=(*WALKED, 255), width=8)
    ring = big.resize((16, 16), Image.Resampling.BOX)
    ImageDraw.Draw(ring).text((8, 8), str(number), (*INK, 255), _font(10 if number < 100 else 8), anchor="mm")
    return ring


@lru_cache(maxsize=8)
def outlined(text: str) -> Image.Image:
    """Text with a white outline."""
    font = _font(11)
    plate = Image.new("RGBA", (math.ceil(ImageDraw.Draw(Image.new("RGBA", (1, 1))).textlength(text, font)) + 4, 16))
    draw = ImageDraw.Draw(plate)
    draw.text((plate.width / 2, 8), text, (*INK, 255), font, anchor="mm", stroke_width=2, stroke_fill=(255, 255, 255, 255))
    return plate


@lru_cache(maxsize=1)
def directions() -> tuple[tuple[Image.Image, tuple[int, int]], ...]:
    """What lies beyond each border: words, and where their upper left corners stand."""
    placed, middle = [], SIZE_PX // 2
    for text, share_u, share_v in (("front", 0.5, 0.0), ("back", 0.5, 1.0), ("left", 0.0, 0.5), ("right", 1.0, 0.5)):
        word = outlined(text)
        u = 4 + round(share_u * (SIZE_PX - 8 - word.width))
        v = 2 + round(share_v * (SIZE_PX - 4 - word.height))
        placed.append((word, (u if share_u != 0.5 else middle - word.width // 2, v)))
    return tuple(placed)


@lru_cache(maxsize=1)
def legend() -> Image.Image:
    """The strip under the map; always the same."""
    strip = Image.new("RGB", (SIZE_PX, LEGEND_PX), (255, 255, 255))
    draw = ImageDraw.Draw(strip)
    font = _font(11)
    entries = (
        ("unexplored", UNKNOWN, "box"),
        ("obstacle", OBSTACLE, "box"),
        ("free floor", FREE, "box"),
        ("space", REGIONS[0], "box"),
        ("walked way", WALKED, "line"),
        ("doorway", THRESHOLD, "line"),
        ("waypoint", WALKED, "ring"),
        ("you, facing up", AGENT, "arrow"),
    )
    for index, (text, colour, mark) in enumerate(entries):
        x, y = 10 + index % 4 * 108, 11 + index // 4 * 18
        if mark == "box":
            draw.rectangle((x, y - 5, x + 14, y + 5), fill=colour, outline=FRAME)
        elif mark == "line":
            draw.line((x, y, x + 14, y), fill=colour, width=4)
        elif mark == "ring":
            draw.ellipse((x + 2, y - 5, x + 12, y + 5), fill=(255, 255, 255), outline=colour, width=2)
        else:
            draw.polygon(((x + 7, y - 7), (x + 13, y + 6), (x + 7, y + 3), (x + 1, y + 6)), fill=colour)
        draw.text((x + 20, y), text, INK, font, anchor="lm")
    draw.line((0, 0, SIZE_PX, 0), fill=FRAME)
    return strip


@lru_cache(maxsize=8)
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
