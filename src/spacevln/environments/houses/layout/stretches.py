"""Straight pieces of wall: those that two rooms share, and those that face the open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from spacevln.environments.houses.layout.draft import WALL_M, Draft
from spacevln.environments.houses.plan import Axis, Rect

JAMB_M = 0.1
"""Wall kept between a hole and the next corner, for the frame."""
MARGIN_M = WALL_M / 2 + JAMB_M
_SHORTEST_M = 0.5


@dataclass(frozen=True, slots=True)
class Stretch:
    """A piece of wall: ``axis`` it runs along, its middle line at ``across``, from ``low`` to ``high``."""

    axis: Axis
    across: float
    low: float
    high: float

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.high - self.low


def common_walls(draft: Draft, a: int, b: int) -> list[Stretch]:
    """Stretches between two rooms that are free of stairs on both sides, clear of corners."""
    first, second = draft.cells[a], draft.cells[b]
    if first.floor != second.floor:
        return []
    found = [stretch for p in first.rects for q in second.rects for stretch in _contact(p, q)]
    return [piece for stretch in found for piece in without_flight(draft, stretch)]


def _contact(p: Rect, q: Rect) -> list[Stretch]:
    found: list[Stretch] = []
    for across, facing in ((p.x1, q.x0), (p.x0, q.x1)):
        if abs(across - facing) < 1e-6:
            found.append(Stretch("y", across, max(p.y0, q.y0) + MARGIN_M, min(p.y1, q.y1) - MARGIN_M))
    for across, facing in ((p.y1, q.y0), (p.y0, q.y1)):
        if abs(across - facing) < 1e-6:
            found.append(Stretch("x", across, max(p.x0, q.x0) + MARGIN_M, min(p.x1, q.x1) - MARGIN_M))
    return [stretch for stretch in found if stretch.length > _SHORTEST_M]


def without_flight(draft: Draft, stretch: Stretch) -> list[Stretch]:
    """The parts of a stretch that are not beside the steps."""
    if draft.flight is None:
        return [stretch]
    rect = draft.flight.rect
    along, side = ((rect.x0, rect.x1), (rect.y0, rect.y1)) if stretch.axis == "x" else ((rect.y0, rect.y1), (rect.x0, rect.x1))
    if not side[0] - 0.5 < stretch.across < side[1] + 0.5:
        return [stretch]
    pieces = [
        Stretch(stretch.axis, stretch.across, stretch.low, min(stretch.high, along[0] - 0.1)),
        Stretch(stretch.axis, stretch.across, max(stretch.low, along[1] + 0.1), stretch.high),
    ]
    return [piece for piece in pieces if piece.length > _SHORTEST_M]


def outer_walls(draft: Draft, index: int) -> list[Stretch]:
    """Stretches of a room's walls that face the open, longest first, clear of corners and of stairs."""
    cell = draft.cells[index]
    others = [rect for k in draft.on_floor(cell.floor) for rect in draft.cells[k].rects]
    found = [stretch for rect in cell.rects for stretch in _open_sides(rect, [r for r in others if r is not rect])]
    free = [piece for stretch in found if stretch.length > _SHORTEST_M for piece in without_flight(draft, stretch)]
    return sorted(free, key=lambda stretch: -stretch.length)


def _open_sides(rect: Rect, others: list[Rect]) -> Iterator[Stretch]:
    """What the others leave of a rectangle's four sides."""
    sides: tuple[tuple[Axis, float], ...] = (("x", rect.y0), ("x", rect.y1), ("y", rect.x0), ("y", rect.x1))
    for axis, across in sides:
        low, high = _span(rect, axis)
        cursor = low
        for start, end in [*sorted(_span(other, axis) for other in others if _touches(other, axis, across)), (high, high)]:
            if start > cursor:
                yield Stretch(axis, across, cursor + MARGIN_M, min(start, high) - MARGIN_M)
            cursor = max(cursor, end)
            if cursor >= high:
                break


def _span(rect: Rect, axis: Axis) -> tuple[float, float]:
    return (rect.x0, rect.x1) if axis == "x" else (rect.y0, rect.y1)


def _touches(rect: Rect, axis: Axis, across: float) -> bool:
    edges = (rect.y0, rect.y1) if axis == "x" else (rect.x0, rect.x1)
    return any(abs(edge - across) < 1e-6 for edge in edges)
