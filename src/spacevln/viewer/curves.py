"""Line charts with intervals as one SVG file that needs nothing else, for documents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

COLOURS = ("#0060a8", "#c2410c", "#15803d", "#7c3aed")
WIDTH, HEIGHT = 380, 280
LEFT, RIGHT, TOP, BOTTOM = 60, 14, 54, 46
TICKS = 4


@dataclass(frozen=True, slots=True)
class Point:
    """A value over x, with its interval where it has one."""

    x: float
    y: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Curve:
    """Points of one name, joined."""

    name: str
    points: tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class Panel:
    """One chart.

    Args:
        title, x, y: what it shows, and what its axes are, with units.
        curves: at most four.
        highest: of the vertical axis, which begins at 0.
    """

    title: str
    x: str
    y: str
    curves: tuple[Curve, ...]
    highest: float


def draw_curves(panels: Sequence[Panel]) -> str:
    """All panels side by side."""
    width = WIDTH * len(panels)
    head = Markup(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" '
        'font-family="system-ui, sans-serif" font-size="12" fill="#1f2937">'
    ).format(width, HEIGHT)
    ground = Markup('<rect width="{}" height="{}" fill="#ffffff"/>').format(width, HEIGHT)
    drawn = [Markup('<g transform="translate({} 0)">{}</g>').format(k * WIDTH, _panel(each)) for k, each in enumerate(panels)]
    return str(Markup("\n").join((head, ground, *drawn, Markup("</svg>")))) + "\n"


def _panel(panel: Panel) -> Markup:
    last = max((point.x for curve in panel.curves for point in curve.points), default=1.0) or 1.0
    scale = _Scale(last, panel.highest)
    parts = [
        _text(LEFT, 18, panel.title, weight="600"),
        _text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, panel.x, anchor="middle"),
        Markup('<text transform="translate(13 {}) rotate(-90)" text-anchor="middle">{}</text>').format(
            (TOP + HEIGHT - BOTTOM) / 2, panel.y
        ),
    ]
    for k in range(TICKS + 1):
        value = panel.highest * k / TICKS
        y = scale.y(value)
        parts.append(Markup('<path d="M{} {:.1f}H{}" stroke="#e5e7eb"/>').format(LEFT, y, WIDTH - RIGHT))
        parts.append(_text(LEFT - 6, y + 4, f"{value:g}", anchor="end"))
    marks = sorted({point.x for curve in panel.curves for point in curve.points})
    parts += [_text(scale.x(x), HEIGHT - BOTTOM + 16, f"{x:g}", anchor="middle") for x in marks]
    for k, curve in enumerate(panel.curves):
        parts += _curve(curve, COLOURS[k], scale, aside_px=(k - (len(panel.curves) - 1) / 2) * 5)
        parts.append(Markup('<path d="M{} 34h14" stroke="{}" stroke-width="2.5"/>').format(LEFT + k * 108, COLOURS[k]))
        parts.append(_text(LEFT + k * 108 + 18, 38, curve.name))
    return Markup("\n").join(parts)


@dataclass(frozen=True, slots=True)
class _Scale:
    last: float
    highest: float

    def x(self, value: float) -> float:
        """Column of a value."""
        return LEFT + 12 + (WIDTH - LEFT - RIGHT - 24) * value / self.last

    def y(self, value: float) -> float:
        """Row of a value."""
        return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * min(value, self.highest) / self.highest


def _curve(curve: Curve, colour: str, scale: _Scale, aside_px: float) -> list[Markup]:
    """Line, dots and intervals; curves of one panel stand a little aside of one another, so that intervals can be told apart."""
    if not curve.points:
        return []
    places = [(scale.x(point.x) + aside_px, scale.y(point.y), point) for point in curve.points]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y, _ in places)
    parts = [Markup('<polyline points="{}" fill="none" stroke="{}" stroke-width="2"/>').format(line, colour)]
    for x, y, point in places:
        if point.low is not None and point.high is not None:
            bar = Markup('<path d="M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {1:.1f}h6M{3:.1f} {2:.1f}h6" stroke="{4}" opacity="0.6"/>')
            parts.append(bar.format(x, scale.y(point.low), scale.y(point.high), x - 3, colour))
        parts.append(Markup('<circle cx="{:.1f}" cy="{:.1f}" r="3.2" fill="{}"/>').format(x, y, colour))
    return parts


def _text(x: float, y: float, text: str, *, anchor: str = "start", weight: str = "400") -> Markup:
    return Markup('<text x="{:.1f}" y="{:.1f}" text-anchor="{}" font-weight="{}">{}</text>').format(x, y, anchor, weight, text)
