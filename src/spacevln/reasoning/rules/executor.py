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
    wrap_angle,
)

Float = NDArray[np.float64]
TURN_DEG = 30.0
ARRIVED_M = 0.3
OFF_PATH_COST = 1.2
TURN_COST_M = 0.12
MIN_GAIN_M = 0.1


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
        way = context.space.path(pose.xy_m, target)
        known = len(way) >= 2
        path = np.asarray(way) if known else np.stack([pose.xy_m, target])
        action, purpose = self._follow(context, path)
        words = (
            f"target {remaining:.2f} m away, {'on the known way' if known else 'no known way: straight on'}: {describe(action)}"
        )
        return _reply(context, action, purpose, candidate, words, () if known else ("straight_line",))

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
        """The admissible action that gains most along the path."""
        pose = context.observation.pose
        allowed = context.admissible
        best: tuple[float, Action, TurnPurpose | None] | None = None
        for steps in range(-6, 7):
            heading = wrap_angle(pose.yaw_rad + math.radians(steps * TURN_DEG))
            if steps > 0 and not allowed.left or steps < 0 and not allowed.right:
                continue
            distances = allowed.forward_m if steps == 0 else (0.25, 0.5, 0.75, 1.0, 1.25)
            for distance in distances:
                gain = _gain(path, pose.xy_m, heading, distance) - TURN_COST_M * (abs(steps) + 2 * (steps != 0))
                action: Action
                if steps == 0:
                    action, purpose = MoveForward(distance), None
                else:
                    action = TurnLeft(steps * TURN_DEG) if steps > 0 else TurnRight(-steps * TURN_DEG)
                    purpose = TurnPurpose.ALIGN
                if best is None or gain > best[0] + 1e-9:
                    best = (gain, action, purpose)
        if best is not None and best[0] > MIN_GAIN_M - 0.6:
            return best[1], best[2]
        return self._avoid(context)

    @staticmethod
    def _avoid(context: ExecutorContext) -> tuple[Action, TurnPurpose | None]:
        """No admissible action gains anything: turn to the more open side."""
        allowed, obstacles = context.admissible, context.obstacles
        sides: list[tuple[float, Action]] = []
        if allowed.left:
            sides.append((obstacles.left_30_m, TurnLeft(TURN_DEG)))
        if allowed.right:
            sides.append((obstacles.right_30_m, TurnRight(TURN_DEG)))
        if sides:
            return max(sides, key=lambda item: item[0])[1], TurnPurpose.AVOID
        return (MoveForward(allowed.forward_m[0]), None) if allowed.forward_m else (Stop(), None)


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
        else f"{candidate.category} at {candidate.distance_m:.2f} m, {math.degrees(candidate.bearing_rad):+.0f} deg, {'visible' if candidate.visible else 'remembered'}"
    )
    thought = ExecutorThought(
        view=f"front {obstacles.front_m:.2f} m, left {obstacles.left_30_m:.2f} m, right {obstacles.right_30_m:.2f} m free",
        detection=found,
        progress=f"{record.moved_m:.2f} m and {math.degrees(record.turned_rad):+.0f} deg so far",
        action=why,
    )
    return ExecutorReply(action, purpose, thought, fallbacks)
