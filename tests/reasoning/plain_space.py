"""A known floor made of rectangles, and sightings on it: synthetic contexts for the rules."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spacevln.core import EgocentricMemory, Frontier, PlannerContext, Pose, Sighting, Task, View, egocentric_label

Rect = tuple[float, float, float, float]


class PlainSpace:
    """A :class:`~spacevln.core.SpatialMap`: the union of rectangles is free, everything else is wall."""

    def __init__(self, free: Sequence[Rect]) -> None:
        self.free = tuple(free)

    def is_explored(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return np.ones(len(np.atleast_2d(xy_m)), np.bool_)

    def is_free(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        xy = np.atleast_2d(np.asarray(xy_m, np.float64))
        inside = np.zeros(len(xy), np.bool_)
        for x0, y0, x1, y1 in self.free:
            inside |= (xy[:, 0] >= x0) & (xy[:, 0] <= x1) & (xy[:, 1] >= y0) & (xy[:, 1] <= y1)
        return inside

    def is_obstacle(self, xy_m: ArrayLike) -> NDArray[np.bool_]:
        return ~self.is_free(xy_m)

    def line_of_sight(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> bool:
        a, b = np.asarray(a_xy_m, np.float64), np.asarray(b_xy_m, np.float64)
        return bool(self.is_free(a + np.linspace(0, 1, 60)[:, None] * (b - a)).all())

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        a, b = np.asarray(a_xy_m, np.float64), np.asarray(b_xy_m, np.float64)
        return float(np.hypot(*(b - a))) if self.is_free([a, b]).all() else math.inf

    def path(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> NDArray[np.float64]:
        reachable = math.isfinite(self.geodesic_m(a_xy_m, b_xy_m))
        return np.array([a_xy_m, b_xy_m], np.float64) if reachable else np.zeros((0, 2))


def seen(
    category: str, x: float, y: float, pose: Pose, *attributes: str, width_m: float = 0.6, along_rad: float = math.pi / 2
) -> Sighting:
    """A clear sight of a thing or a doorway whose surface runs along a direction."""
    c, s = width_m / 2 * math.cos(along_rad), width_m / 2 * math.sin(along_rad)
    return Sighting(
        category=category,
        confidence=0.9,
        box_px=(0, 0, 10, 10),
        position_m=(x, y, 0.5),
        distance_m=pose.distance_m(x, y),
        bearing_rad=pose.bearing_rad(x, y),
        extent_m=width_m,
        attributes=attributes,
        is_passage=category in ("doorway", "opening"),
        pixels=500,
        surface_m=((x - c, y - s), (x, y), (x + c, y + s)),
    )


def context(
    task: Task,
    pose: Pose,
    space: PlainSpace,
    sightings: Sequence[Sighting],
    frontiers: Sequence[Frontier] = (),
    memory: bool = True,
    **more: object,
) -> PlannerContext:
    """A planning boundary; every sighting lies in the view that faces it."""
    views = []
    for k in range(12):
        heading = k * math.pi / 6
        label = egocentric_label(heading)
        mine = tuple(s for s in sightings if egocentric_label(s.bearing_rad) == label)
        views.append(View(label, heading, np.zeros((4, 4, 3), np.uint8), 2.0, mine))
    psi = EgocentricMemory(pose, 0, "", (), (), "", None, tuple(frontiers)) if memory else None
    settings: dict[str, object] = {"stage": 0, "feedback": None, "last_subtask": None, "steps_left": 248, **more}
    return PlannerContext(task=task, views=tuple(views), memory=psi, pose=pose, space=space, **settings)  # type: ignore[arg-type]
