"""Legs: the walk inside one room from a node to a portal, a place or the edge of what is known, and its bends."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core import wrap_angle
from spacevln.reasoning.rules.grid import STEP_M
from spacevln.reasoning.rules.sightings import XY, Portal, Thing

Float = NDArray[np.float64]
TURN_RAD = math.radians(35)
CHORD_M = 1.2
CLIMBED = -10  # and less: the "portal" of a node is a flight of stairs that was walked


@dataclass(frozen=True, slots=True)
class Node:
    """Where a leg begins: the start (``portal`` = -1) or just inside a room after a portal.

    Args:
        floor, room: of the grid; room 0 is unknown.
        xy: position.
        yaw_rad: direction of walking.
        portal: walked through to get here.
        side: of that portal.
    """

    floor: int
    room: int
    xy: XY
    yaw_rad: float
    portal: int = -1
    side: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A walk inside one room.

    Args:
        node: where it begins.
        points: (N, 2) every 0.2 m.
        yaws: (N,) direction of walking.
        turns: (arc position, angle), left positive: at the node, on the way, and into the portal.
        length_m: length.
        portal: walked through at the end.
        side: of the portal on which the leg ends.
        thing: approached at the end.
        kind: ``"cross"``, ``"place"`` or ``"frontier"``.
    """

    node: Node
    points: Float
    yaws: Float
    turns: tuple[tuple[float, float], ...]
    length_m: float
    kind: str
    portal: Portal | None = None
    side: int = 0
    thing: Thing | None = None
    label: str = ""

    @property
    def exit_turn_rad(self) -> float:
        """Turn into the portal."""
        return self.turns[-1][1] if self.turns and self.turns[-1][0] >= self.length_m - 1e-6 else 0.0

    @property
    def travel_rad(self) -> float:
        """Direction of its main run."""
        if self.length_m < 1.0:
            return self.node.yaw_rad
        k = len(self.points) // 2
        a, b = self.points[max(0, k - 4)], self.points[min(len(self.points) - 1, k + 4)]
        return math.atan2(b[1] - a[1], b[0] - a[0])


def make_leg(
    node: Node, points: Float, kind: str, portal: Portal | None = None, side: int = 0, thing: Thing | None = None, label: str = ""
) -> Leg:
    """A leg along sampled points."""
    length = float(np.hypot(*np.diff(points, axis=0).T).sum()) if len(points) > 1 else 0.0
    out_yaw = portal.normal_rad(side) if portal is not None and kind == "cross" else None
    turns = _turns(points, length, node.yaw_rad, out_yaw)
    return Leg(node, points, _directions(points), turns, length, kind, portal, side, thing, label)


def _directions(points: Float, half: int = 2) -> Float:
    n = len(points)
    low, high = np.maximum(np.arange(n) - half, 0), np.minimum(np.arange(n) + half, n - 1)
    d = points[high] - points[low]
    return np.asarray(np.arctan2(d[:, 1], d[:, 0]))


def _chord(points: Float, a: int, b: int) -> float | None:
    d = points[b] - points[a]
    return math.atan2(d[1], d[0]) if math.hypot(d[0], d[1]) > 0.3 else None


def _turns(points: Float, length: float, in_yaw: float, out_yaw: float | None) -> tuple[tuple[float, float], ...]:
    """Bends; a short leg has only its net turn, so that a step aside is no turn."""
    n, chord = len(points), round(CHORD_M / STEP_M)
    first, last = _chord(points, 0, min(chord, n - 1)), _chord(points, max(0, n - 1 - chord), n - 1)
    if length < 1.1 or first is None or last is None:
        end = out_yaw if out_yaw is not None else (first if first is not None else in_yaw)
        return ((length, wrap_angle(end - in_yaw)),)
    turns = [(0.0, wrap_angle(first - in_yaw))]
    k = chord
    while k < n - chord:
        if abs(_bend(points, k, chord)) >= TURN_RAD:
            best = max(range(k, min(k + chord, n - chord)), key=lambda i: abs(_bend(points, i, chord)))
            turns.append((best * STEP_M, _bend(points, best, chord)))
            k = best + chord
        else:
            k += 1
    if out_yaw is not None:
        turns.append((length, wrap_angle(out_yaw - last)))
    return tuple(turns)


def _bend(points: Float, k: int, chord: int) -> float:
    before, after = _chord(points, k - chord, k), _chord(points, k, k + chord)
    return 0.0 if before is None or after is None else wrap_angle(after - before)
