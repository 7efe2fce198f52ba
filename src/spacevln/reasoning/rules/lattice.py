"""The cheapest turns and forwards along a way: A* over the poses that turns of 30 degrees and steps of 0.25 m can reach.

A way over a map is a curve; the body has twelve headings and one length of step. A greedy choice among them runs to and fro
before a narrow place; the search finds the few primitives that pass it, or says that nothing leads nearer.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from spacevln.core import EnvironmentSpec, Pose, SpatialMap

Float = NDArray[np.float64]
WINDOW_M = 2.6  # around the pose, that is searched
HORIZON_M = 2.0  # further on a new decision will be made
CELL_M = 0.05
LINE_CELL_M = 0.1
OFF_LINE = 1.2  # metres of a straight way that a metre beside it is worth
BODY_M = (0.12, 0.07)  # room that is kept beside the body, a disc of 0.1 m; where nothing passes so, it may brush along
USUAL_RADIUS_M = 0.1
AHEAD_M, AHEAD_ROOM_M = (0.06, 0.13), 0.085  # and before it where it halts: nearer control masks the forward
DECISION_STEPS = 2.0  # what a decision costs beside its primitives: a stage has few of them
PARTS = 5  # of a forward, that are looked at
NONE, FORWARD, TURN = 0, 1, 2  # kinds of primitives
STATE_M = 0.1  # poses this near to each other are one
WORTH = 0.34  # steps of the way, that a step must gain where the target itself is out of reach


@dataclass(frozen=True, slots=True)
class Gait:
    """What a body can do: length of a forward [m], headings around it, forwards of one decision; and the radius of its disc."""

    step_m: float = 0.25
    headings: int = 12
    run: int = 5
    radius_m: float = USUAL_RADIUS_M

    @classmethod
    def of(cls, spec: EnvironmentSpec) -> Gait:
        """That of an environment's body."""
        return cls(spec.step_m, spec.lookaround_count, max(1, int(spec.max_forward_m / spec.step_m + 1e-9)), spec.body_radius_m)

    @property
    def wider_m(self) -> float:
        """How much wider the body is on every side than the usual one."""
        return self.radius_m - USUAL_RADIUS_M


@dataclass(frozen=True, slots=True)
class Run:
    """The first run of primitives: ``turns`` to the left (negative: to the right), or else ``forwards``. Neither: stay."""

    turns: int = 0
    forwards: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Guide:
    """What is left of the way, over cells.

    Args:
        origin: (2,) corner of cell (0, 0) [m].
        cell_m: size of a cell.
        weight: (I, J) price of a metre there, 1 in the open.
        left_m: (I, J) priced length of the way from there to the target.
    """

    origin: Float
    cell_m: float
    weight: Float
    left_m: Float


def straight_guide(start: Float, target: Float) -> Guide:
    """The straight line from a pose to a target, as over a flight of stairs, which the map of one storey does not know."""
    low = np.minimum(start, target) - WINDOW_M
    shape = tuple(np.ceil((np.maximum(start, target) + WINDOW_M - low) / LINE_CELL_M).astype(int))
    ij = np.indices(shape).reshape(2, -1).T
    points = low + (ij + 0.5) * LINE_CELL_M
    length = max(float(np.hypot(*(target - start))), 1e-6)
    ahead = (target - start) / length
    along, across = (points - start) @ ahead, np.abs((points - start) @ np.array([-ahead[1], ahead[0]]))
    left = np.where(along < length, length - along, np.hypot(along - length, across)) + OFF_LINE * across
    return Guide(low, LINE_CELL_M, np.ones(shape), left.reshape(shape))


def first_run(
    gait: Gait,
    space: SpatialMap | None,
    bumps: Float,
    pose: Pose,
    guide: Guide,
    target: Float,
    arrived_m: float,
    forward_m: float,
    turns: tuple[bool, bool],
    *,
    aligning: bool = False,
) -> Run:
    """The first decision of the cheapest sequence of primitives.

    Args:
        gait: of the body.
        space: tells the obstacles; None on a flight of stairs, which the map of one storey takes for one.
        bumps: (N, 2) of others, that were felt.
        pose: of the body.
        guide: of the way.
        target: (2,) where it leads.
        arrived_m: near enough.
        forward_m: longest forward that is admissible now, 0 for none.
        turns: whether a turn to the left and one to the right is.
        aligning: the first turn is the stage's alignment, which is no decision.
    """
    axis = np.arange(-WINDOW_M, WINDOW_M, CELL_M) + CELL_M / 2
    xx, yy = np.meshgrid(pose.x_m + axis, pose.y_m + axis, indexing="ij")
    solid = np.zeros(xx.shape, dtype=np.bool_)
    if space is not None:
        solid |= np.asarray(space.is_obstacle(np.stack([xx.ravel(), yy.ravel()], axis=1))).reshape(xx.shape)
    ij = np.floor((bumps - pose.xy_m + WINDOW_M) / CELL_M).astype(int)
    ij = ij[((ij >= 0) & (ij < len(axis))).all(axis=1)]
    solid[ij[:, 0], ij[:, 1]] = True
    room_m = np.asarray(distance_transform_edt(~solid)) * CELL_M if solid.any() else np.full(solid.shape, WINDOW_M)
    for body_m in BODY_M:
        turned, went = _search(
            room_m,
            body_m + gait.wider_m,
            guide.weight,
            guide.left_m,
            (pose.x_m - guide.origin[0]) / guide.cell_m,
            (pose.y_m - guide.origin[1]) / guide.cell_m,
            guide.cell_m,
            pose.yaw_rad,
            float(target[0]) - pose.x_m,
            float(target[1]) - pose.y_m,
            arrived_m,
            round(forward_m / gait.step_m),
            turns[0],
            turns[1],
            gait.step_m,
            gait.headings,
            gait.run,
            TURN if aligning else NONE,
        )
        if turned or went:
            return Run(turned, went)
    return Run()


@numba.njit(cache=True)
def _between(grid: Float, i: float, j: float) -> float:  # pragma: no cover - compiled
    """A grid's value at a point, linear between the centres of its cells."""
    a = min(max(i - 0.5, 0.0), grid.shape[0] - 1.001)
    b = min(max(j - 0.5, 0.0), grid.shape[1] - 1.001)
    m, n = int(a), int(b)
    u, v = a - m, b - n
    near = grid[m, n] * (1 - v) + grid[m, n + 1] * v
    far = grid[m + 1, n] * (1 - v) + grid[m + 1, n + 1] * v
    return float(near * (1 - u) + far * u)


@numba.njit(cache=True)
def _room(room_m: Float, x: float, y: float) -> float:  # pragma: no cover - compiled
    """Distance to the nearest obstacle; 0 outside the window."""
    i, j = int((x + WINDOW_M) / CELL_M), int((y + WINDOW_M) / CELL_M)
    if i < 0 or j < 0 or i >= room_m.shape[0] or j >= room_m.shape[1]:
        return 0.0
    return float(room_m[i, j])


@numba.njit(cache=True)
def _key(x: float, y: float, heading: int, kind: int, headings: int) -> int:  # pragma: no cover - compiled
    """Number of the state that a pose belongs to."""
    side = int(2 * WINDOW_M / STATE_M) + 2
    i, j = int((x + WINDOW_M) / STATE_M + 0.5), int((y + WINDOW_M) / STATE_M + 0.5)
    return ((i * side + j) * headings + heading) * 3 + kind


@numba.njit(cache=True)
def _price(
    room_m: Float,
    body_m: float,
    guide: Float,
    start_i: float,
    start_j: float,
    cell_m: float,
    x: float,
    y: float,
    yaw_rad: float,
    step_m: float,
) -> float:  # pragma: no cover - compiled
    """What a forward primitive costs, in steps; inf when it hits. Out of a tight place every move that gains room is allowed."""
    before, priced = _room(room_m, x, y), 0.0
    for part in range(1, PARTS + 1):
        px, py = x + part / PARTS * step_m * math.cos(yaw_rad), y + part / PARTS * step_m * math.sin(yaw_rad)
        here = _room(room_m, px, py)
        if here < body_m and here < before + 1e-9:
            return math.inf
        before = here
        priced += _between(guide, start_i + px / cell_m, start_j + py / cell_m) / PARTS
    for ahead in AHEAD_M:
        reach = step_m + ahead
        if _room(room_m, x + reach * math.cos(yaw_rad), y + reach * math.sin(yaw_rad)) < min(AHEAD_ROOM_M, body_m):
            return math.inf
    return priced


@numba.njit(cache=True)
def _search(
    room_m: Float,
    body_m: float,
    weight: Float,
    left_m: Float,
    start_i: float,
    start_j: float,
    cell_m: float,
    yaw_rad: float,
    target_x: float,
    target_y: float,
    arrived_m: float,
    forwards: int,
    may_left: bool,
    may_right: bool,
    step_m: float,
    headings: int,
    longest: int,
    begun: int,
) -> tuple[int, int]:  # pragma: no cover - compiled
    """(turns, forwards) of the first run. Positions are relative to the body [m]; costs are steps.

    A node is (x, y, cost, heading, kind of its last primitive, length of that run, turns and forwards of the first run,
    whether that still goes on).
    """
    best = np.full(_key(2 * WINDOW_M, 2 * WINDOW_M, headings, 0, headings), np.inf)
    begin_m = _between(left_m, start_i, start_j)
    nodes = [(0.0, 0.0, 0.0, 0, begun, 0, 0, 0, True)]
    queue = [(begin_m / step_m, 0)]
    gained, nearest = 0.0, 0
    while len(queue) > 0:
        number = heapq.heappop(queue)[1]
        x, y, cost, k, kind, run, first_turns, first_forwards, first = nodes[number]
        if number > 0 and cost > best[_key(x, y, k, kind, headings)] + 1e-9:
            continue
        rest_m = _between(left_m, start_i + x / cell_m, start_j + y / cell_m)
        if math.hypot(x - target_x, y - target_y) <= arrived_m or (math.hypot(x, y) >= HORIZON_M and rest_m < begin_m):
            return first_turns, first_forwards
        gain = (begin_m - rest_m) / step_m - WORTH * cost
        if gain > gained:
            gained, nearest = gain, number
        for move in range(3):  # forward, left, right
            next_kind = FORWARD if move == 0 else TURN
            side = 0 if move == 0 else 3 - 2 * move
            goes_on = kind == next_kind and abs(run) < (longest if move == 0 else headings // 2)
            if kind == TURN and move > 0 and (not goes_on or run * side < 0):
                continue
            if number == 0 and ((move == 1 and not may_left) or (move == 2 and not may_right)):
                continue
            if move == 0 and first and kind != TURN and first_forwards >= forwards and forwards < longest:
                continue
            heading, next_x, next_y, step = (k + side) % headings, x, y, 1.0
            if move == 0:
                yaw = yaw_rad + k * (2 * math.pi / headings)
                step = _price(room_m, body_m, weight, start_i, start_j, cell_m, x, y, yaw, step_m)
                next_x, next_y = x + step_m * math.cos(yaw), y + step_m * math.sin(yaw)
            total = cost + step + (0.0 if goes_on else DECISION_STEPS)
            if not total < best[_key(next_x, next_y, heading, next_kind, headings)] - 1e-9:
                continue
            best[_key(next_x, next_y, heading, next_kind, headings)] = total
            still = first and (goes_on or number == 0)
            nodes.append(
                (
                    next_x,
                    next_y,
                    total,
                    heading,
                    next_kind,
                    (run if goes_on else 0) + (1 if move == 0 else side),
                    first_turns + (side if still else 0),
                    first_forwards + (1 if still and move == 0 else 0),
                    still,
                )
            )
            to_go_m = _between(left_m, start_i + next_x / cell_m, start_j + next_y / cell_m)
            heapq.heappush(queue, (total + to_go_m / step_m, len(nodes) - 1))
    return nodes[nearest][6], nodes[nearest][7]
