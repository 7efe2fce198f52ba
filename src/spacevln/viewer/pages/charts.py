"""Small bar charts of a run as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

WIDTH, HEIGHT = 320, 170
LEFT, BOTTOM, TOP = 30, 26, 10
BINS = 12


@dataclass(frozen=True, slots=True)
class Chart:
    """A drawn chart and what it shows."""

    svg: Markup
    caption: str


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar: stacked pieces (class, count) from the bottom, and what a pointer is told."""

    pieces: tuple[tuple[str, int], ...]
    tip: str


def histogram(values: Sequence[float], caption: str, unit: str, *, whole: bool = False) -> Chart | None:
    """How often a value is; None for no values. ``whole`` says that values are whole numbers."""
    return stacked([(value, "bar") for value in values], caption, unit, ("bar",), whole=whole)


def by_outcome(values: Sequence[tuple[float, bool]], caption: str, unit: str) -> Chart | None:
    """Successes and failures over a value."""
    named = [(value, "success" if good else "failure") for value, good in values]
    return stacked(named, caption, unit, ("success", "failure"))


def stacked(
    values: Sequence[tuple[float, str]], caption: str, unit: str, names: tuple[str, ...], *, whole: bool = False
) -> Chart | None:
    """Counts of several kinds over a value, in bins of one width."""
    if not values:
        return None
    width = _round_up((max(value for value, _ in values) or 1.0) / BINS, whole=whole)
    count = int(max(value for value, _ in values) // width) + 1
    bars = []
    for k in range(count):
        inside = [name for value, name in values if int(value // width) == k]
        pieces = tuple((name, inside.count(name)) for name in names)
        words = ", ".join(f"{number} {name}" if len(names) > 1 else str(number) for name, number in pieces)
        bars.append(Bar(pieces, f"{k * width:g} to {(k + 1) * width:g} {unit}".strip() + f": {words}"))
    return Chart(_draw(bars, width, caption), caption)


def _round_up(value: float, *, whole: bool) -> float:
    """The next of 1, 2, 2.5, 5 times a power of ten."""
    power = 1e-6
    while True:
        for factor in (1.0, 2.0, 2.5, 5.0):
            step = factor * power
            if step >= value and not (whole and step != int(step)):
                return round(step, 9)
        power *= 10


def _draw(bars: Sequence[Bar], width: float, caption: str) -> Markup:
    highest = max(sum(number for _, number in bar.pieces) for bar in bars)
    inner_w, inner_h = WIDTH - LEFT - 14, HEIGHT - BOTTOM - TOP
    slot = inner_w / len(bars)
    floor = HEIGHT - BOTTOM
    parts = [
        Markup('<svg viewBox="0 0 {} {}" role="img" aria-label="{}">').format(WIDTH, HEIGHT, caption),
        Markup('<line class="axis" x1="{}" y1="{}" x2="{}" y2="{}"/>').format(LEFT, floor, WIDTH - 14, floor),
        Markup('<text class="tick" x="{}" y="{}" text-anchor="end">{}</text>').format(LEFT - 5, TOP + 9, highest),
        Markup('<text class="tick" x="{}" y="{}" text-anchor="end">0</text>').format(LEFT - 5, floor),
    ]
    for k, bar in enumerate(bars):
        y = float(floor)
        parts.append(Markup("<g><title>{}</title>").format(bar.tip))
        for name, number in bar.pieces:
            height = inner_h * number / highest
            y -= height
            style = "bar" if name == "bar" else f"bar {name}"
            shape = Markup('<rect class="{}" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/>')
            parts.append(shape.format(style, LEFT + k * slot + 1, y, max(1.0, slot - 2), height))
        parts.append(Markup("</g>"))
    every = max(1, -(-len(bars) // 5))
    for k in range(0, len(bars) + 1, every):
        x = LEFT + k * slot
        parts.append(
            Markup('<text class="tick" x="{:.1f}" y="{}" text-anchor="middle">{:g}</text>').format(x, floor + 15, k * width)
        )
    parts.append(Markup("</svg>"))
    return Markup("").join(parts)
