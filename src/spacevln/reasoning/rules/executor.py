"""The rule-based executor: pi_E without a model. Follows the known way to the stage's target, one admissible action at a time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.core import (
    Action,
    ExecutorContext,
    ExecutorReply,
    ExecutorThought,
    LandmarkCandidate,
    MoveForward,
    Stop,
    TurnLeft,
    TurnPurpose,
    TurnRight,
    describe,
)
from spacevln.reasoning.rules.grid import comfortable_way

Float = NDArray[np.float64]
TURN_DEG = 30.0
TURN_BACK_DEG = 120.0  # two such turns in a stage gain nothing
ARRIVED_M = 0.3
OTHER_STOREY_M = 0.5
OFF_PATH_COST = 1.2
TURN_COST_M = 0.12
MIN_GAIN_M = -0.4
HALF_TURN = 6  # turn steps of a half turn
FORWARDS_M = (0.25, 0.5, 0.75, 1.0, 1.25)
LANES_M = (-0.08, 0.0, 0.08)


class RuleExecutor:
    """Implements :class:`spacevln.core.Executor`. Keeps no state: the same context gives the same reply."""

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """The next action."""
        pose = context.observation.pose
        candidate = _candidate(context)
        target = _target(context, candidate)
        if target is None:
            return self._without_target(context, candidate)
        remaining = pose.distance_m(float(target[0]), float(target[1]))
        if remaining <= ARRIVED_M:
            return _reply(context, Stop(), None, candidate, f"the target is {remaining:.2f} m away: the stage is done")
        way = self._way(context, target)
        path = way if way is not None else np.stack([pose.xy_m, target])
        action, purpose = self._follow(context, path)
        if _turns_back(action) and any(_turns_back(decision.asked) for decision in context.progress.decisions):
            return _reply(context, Stop(), None, candidate, "the way leads to and fro: back to the planner")
        words = (
            f"target {remaining:.2f} m away, {'no known way: straight on' if way is None else 'on its way'}: {describe(action)}"
        )
        return _reply(context, action, purpose, candidate, words, ("straight_line",) if way is None else ())

    @staticmethod
    def _way(context: ExecutorContext, target: Float) -> Float | None:
        """The way to the target; to another storey it is the flight, which the map of this one shows as an obstacle."""
        pose, subtask = context.observation.pose, context.subtask
        if subtask.target_m is not None and abs(subtask.target_m[2] - pose.z_m) > OTHER_STOREY_M:
            return np.stack([pose.xy_m, target])
        return comfortable_way(context.space, pose, (float(target[0]), float(target[1])))

    def _without_target(self, context: ExecutorContext, candidate: LandmarkCandidate | None) -> ExecutorReply:
        forward = context.admissible.forward_m
        if forward and not context.progress.decisions:
            return _reply(
                context,
                MoveForward(forward[-1]),
                None,
                candidate,
                "no target is known: on in the chosen direction",
                ("no_target",),
            )
        if forward and context.decisions_left > 1:
            return _reply(context, MoveForward(forward[-1]), None, candidate, "no target is known: straight on", ("no_target",))
        return _reply(
            context, Stop(), None, candidate, "no target is known and the way is blocked: back to the planner", ("no_target",)
        )

    def _follow(self, context: ExecutorContext, path: Float) -> tuple[Action, TurnPurpose | None]:
        """The admissible action that gains most along the path; a turn counts by the forward that it makes possible."""
        pose, allowed = context.observation.pose, context.admissible
        reach = _clear_ahead(context)
        best: tuple[float, Action, TurnPurpose | None] = (MIN_GAIN_M, Stop(), None)
        for steps in range(-HALF_TURN, HALF_TURN + 1):
            if (steps > 0 and not allowed.left) or (steps < 0 and not allowed.right):
                continue
            heading = pose.yaw_rad + math.radians(steps * TURN_DEG)
            open_m = reach[steps % (2 * HALF_TURN)]
            distances = allowed.forward_m if steps == 0 else [d for d in FORWARDS_M if d <= open_m]
            cost = TURN_COST_M * (abs(steps) + 2 * (steps != 0))
            for distance in distances:
                gain = _gain(path, pose.xy_m, heading, distance) - cost
                if gain > best[0] + 1e-9:
                    if steps == 0:
                        best = (gain, MoveForward(distance), None)
                    else:
                        turn = TurnLeft(steps * TURN_DEG) if steps > 0 else TurnRight(-steps * TURN_DEG)
                        best = (gain, turn, TurnPurpose.ALIGN)
        return (best[1], best[2]) if not isinstance(best[1], Stop) else self._avoid(context, reach)

    @staticmethod
    def _avoid(context: ExecutorContext, reach: list[float]) -> tuple[Action, TurnPurpose | None]:
        """Nothing admissible gains along the path: the smallest turn to a side that is open, else a short forward, else STOP."""
        allowed = context.admissible
        for steps in sorted((s for s in range(-HALF_TURN + 1, HALF_TURN) if s), key=lambda s: (abs(s), s)):
            if ((steps > 0 and allowed.left) or (steps < 0 and allowed.right)) and reach[steps % (2 * HALF_TURN)] >= 0.5:
                turn: Action = TurnLeft(steps * TURN_DEG) if steps > 0 else TurnRight(-steps * TURN_DEG)
                return turn, TurnPurpose.AVOID
        return (MoveForward(allowed.forward_m[0]), None) if allowed.forward_m else (Stop(), None)


def _clear_ahead(context: ExecutorContext) -> list[float]:
    """How far the body could go in each heading, left of the front in 30 degree steps, by the map [m]."""
    pose = context.observation.pose
    along = np.arange(0.15, FORWARDS_M[-1] + 0.2, 0.05)
    headings = pose.yaw_rad + np.radians(TURN_DEG) * np.arange(2 * HALF_TURN)
    forward = np.stack([np.cos(headings), np.sin(headings)], axis=1)
    side = np.stack([-forward[:, 1], forward[:, 0]], axis=1)
    points = (
        pose.xy_m
        + forward[:, None, None] * along[None, :, None, None]
        + side[:, None, None] * np.array(LANES_M)[None, None, :, None]
    )
    hit = np.asarray(context.space.is_obstacle(points.reshape(-1, 2)))
    blocked = np.any(hit.reshape(len(headings), len(along), len(LANES_M)), axis=2)
    first = np.where(blocked.any(axis=1), blocked.argmax(axis=1), len(along))
    return [float(along[k - 1] - 0.1) if k else 0.0 for k in first]


def _turns_back(action: Action) -> bool:
    return isinstance(action, TurnLeft | TurnRight) and action.angle_deg >= TURN_BACK_DEG


def _candidate(context: ExecutorContext) -> LandmarkCandidate | None:
    """The landmark in the pool that the planner means: nearest to its metric point, else the top one."""
    pool, target = context.pool, context.subtask.target_m
    if not pool:
        return None
    if target is None:
        return pool[0]
    return min(pool, key=lambda c: math.hypot(c.position_m[0] - target[0], c.position_m[1] - target[1]))


def _target(context: ExecutorContext, candidate: LandmarkCandidate | None) -> Float | None:
    if context.subtask.target_m is not None:
        return np.array(context.subtask.target_m[:2])
    return None if candidate is None else np.array(candidate.position_m[:2])


def _gain(path: Float, start: Float, heading: float, distance: float) -> float:
    """Progress along a path by a straight move, less what it leads astray [m]."""
    end = start + distance * np.array([math.cos(heading), math.sin(heading)])
    here, _ = _project(path, start)
    there, off = _project(path, end)
    middle = _project(path, (start + end) / 2)[1]
    return there - here - OFF_PATH_COST * max(off, middle)


def _project(path: Float, point: Float) -> tuple[float, float]:
    """Arc position of the path's point nearest to a point, and the distance to it [m]."""
    a, d = path[:-1], np.diff(path, axis=0)
    length = np.maximum(np.hypot(*d.T), 1e-9)
    t = np.clip(((point - a) * d).sum(axis=1) / length**2, 0.0, 1.0)
    off = np.hypot(*(a + t[:, None] * d - point).T)
    best = int(np.argmin(off))
    return float(length[:best].sum() + t[best] * length[best]), float(off[best])


def _reply(
    context: ExecutorContext,
    action: Action,
    purpose: TurnPurpose | None,
    candidate: LandmarkCandidate | None,
    why: str,
    fallbacks: tuple[str, ...] = (),
) -> ExecutorReply:
    obstacles, record = context.obstacles, context.progress
    found = (
        "no landmark is tracked"
        if candidate is None
        else f"{candidate.category} at {candidate.distance_m:.2f} m, {math.degrees(candidate.bearing_rad):+.0f} deg, "
        f"{'visible' if candidate.visible else 'remembered'}"
    )
    thought = ExecutorThought(
        view=f"front {obstacles.front_m:.2f} m, left {obstacles.left_30_m:.2f} m, right {obstacles.right_30_m:.2f} m free",
        detection=found,
        progress=f"{record.moved_m:.2f} m and {math.degrees(record.turned_rad):+.0f} deg so far",
        action=why,
    )
    return ExecutorReply(action, purpose, thought, fallbacks)
