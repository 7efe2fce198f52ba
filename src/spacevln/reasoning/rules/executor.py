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
    Pose,
    Stop,
    TurnLeft,
    TurnPurpose,
    TurnRight,
    describe,
)
from spacevln.perception.matching import Match, match
from spacevln.reasoning.rules.grid import comfortable_guide
from spacevln.reasoning.rules.heading import ARRIVED_M
from spacevln.reasoning.rules.lattice import Gait, first_run, straight_guide

Float = NDArray[np.float64]
TURN_BACK_DEG = 120.0
TURNS_BACK = 1  # more of them in a stage gain nothing
SHORT_M = 0.1  # of a forward
BUMP_M, BUMP_ACROSS_M = 0.15, (-0.1, -0.05, 0.0, 0.05, 0.1)  # from the body's centre to what it touches, and along that
BEFORE_LANDMARK_M = 0.12  # a landmark's arrival is not the target's: one goes as near as one gets
OTHER_STOREY_M = 0.5
SAME_THING_M = 1.0
STEP_UP_M = 0.2  # of a stair: on the last one the flight is not over


class RuleExecutor:
    """Implements :class:`spacevln.core.Executor`. Keeps nothing but what the body has bumped into, and where it saw the goal.

    Args:
        gait: what the body can do; None is that of the simulators.
    """

    def __init__(self, gait: Gait | None = None) -> None:
        self._gait = gait or Gait()
        self._bumps: list[tuple[float, float, float]] = []
        self._told: list[tuple[float, float]] = []  # where the goal came into view
        self._from = Pose(0.0, 0.0, 0.0, 0.0)  # where the last decision was made

    def reset(self) -> None:
        """Forget the episode."""
        self._bumps.clear()
        self._told.clear()

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """The next action."""
        pose = context.observation.pose
        self._feel(context)
        if self._goal_comes_into_view(context):
            return _reply(context, Stop(), None, None, f"a {context.goal} comes into view: back to the planner")
        candidate = _candidate(context)
        target = _target(context, candidate)
        if target is None:
            return self._without_target(context, candidate)
        remaining = pose.distance_m(float(target[0]), float(target[1]))
        near_m = BEFORE_LANDMARK_M if context.subtask.landmark else ARRIVED_M
        if remaining <= near_m:
            return _reply(context, Stop(), None, candidate, f"the target is {remaining:.2f} m away: the stage is done")
        action, purpose = self._follow(context, target, near_m)
        if isinstance(action, Stop):
            return _reply(context, action, None, candidate, f"nothing leads nearer than {remaining:.2f} m: back to the planner")
        if _turns_back(action) and sum(_turns_back(decision.asked) for decision in context.progress.decisions) >= TURNS_BACK:
            return _reply(context, Stop(), None, candidate, "the way leads to and fro: back to the planner")
        return _reply(context, action, purpose, candidate, f"target {remaining:.2f} m away: {describe(action)}")

    def _goal_comes_into_view(self, context: ExecutorContext) -> bool:
        """Whether the goal object, looked for elsewhere, is seen at a place that the planner was not sent back for yet."""
        if not context.goal or context.subtask.targets_final_anchor:
            return False
        new = False
        for sighting in context.glimpsed:
            at = (sighting.position_m[0], sighting.position_m[1])
            if match(context.goal, sighting.category, sighting.attributes) is Match.NAME:
                new = new or all(math.dist(at, told) > SAME_THING_M for told in self._told)
                self._told.append(at)
        return new

    def _feel(self, context: ExecutorContext) -> None:
        """What kept a forward from its way lies on the side to which the body did not move; slid along, it is a wall's.

        Low things close to the body are below the image: nothing but this tells of them.
        """
        last = context.progress.decisions[-1] if context.progress.decisions else None
        before, pose = self._from, context.observation.pose
        self._from = pose
        if last is None or not isinstance(last.asked, MoveForward):
            return
        asked = last.primitives * self._gait.step_m * np.array([math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)])
        missing = asked - (pose.xy_m - before.xy_m)
        if math.hypot(*missing) < SHORT_M:
            return
        towards = missing / math.hypot(*missing)
        for across in BUMP_ACROSS_M:
            x, y = pose.xy_m + (BUMP_M + self._gait.wider_m) * towards + across * np.array([-towards[1], towards[0]])
            self._bumps.append((float(x), float(y), pose.z_m))

    def _follow(self, context: ExecutorContext, target: Float, near_m: float) -> tuple[Action, TurnPurpose | None]:
        """The first decision of the cheapest way to the target; to another storey that is straight over the flight."""
        pose, subtask, allowed = context.observation.pose, context.subtask, context.admissible
        flight = subtask.target_m is not None and abs(subtask.target_m[2] - pose.z_m) > STEP_UP_M
        space = None if flight else context.space
        if space is None:
            guide = straight_guide(pose.xy_m, target)
        else:
            guide = comfortable_guide(space, pose, (float(target[0]), float(target[1])))
        forward_m = allowed.forward_m[-1] if allowed.forward_m else 0.0
        bumps = np.array([(x, y) for x, y, z in self._bumps if abs(z - pose.z_m) < OTHER_STOREY_M]).reshape(-1, 2)
        run = first_run(self._gait, space, bumps, pose, guide, target, near_m, forward_m, (allowed.left, allowed.right))
        if run.forwards:
            return MoveForward(run.forwards * self._gait.step_m), None
        if run.turns:
            angle_deg = abs(run.turns) * 360.0 / self._gait.headings
            return TurnLeft(angle_deg) if run.turns > 0 else TurnRight(angle_deg), TurnPurpose.ALIGN
        return Stop(), None

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
