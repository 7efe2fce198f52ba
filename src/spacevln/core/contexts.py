"""What a planner and an executor read and reply: both model-written and rule-based ones (DESIGN 5.4)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from spacevln.core.actions import Action, MoveForward, Stop, TurnLeft, TurnPurpose, TurnRight
from spacevln.core.geometry import Pose
from spacevln.core.interfaces import SpatialMap
from spacevln.core.sensing import Observation, Sighting
from spacevln.core.spatial import EgocentricMemory
from spacevln.core.stages import Feedback, LandmarkPool, StageRecord, Subtask
from spacevln.core.task import Task


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One image (o^i_k, alpha_i) of a look-around.

    Args:
        label: ``"front"``, ``"left 30"`` ... as in :func:`geometry.egocentric_label`.
        heading_rad: alpha_i, egocentric, left positive.
        rgb: (H, W, 3) uint8; None where the agent did not turn to, as what lies there is known.
        obstacle_m: distance to the nearest obstacle in this direction [m].
        sightings: lifted detections.
    """

    label: str
    heading_rad: float
    rgb: NDArray[np.uint8] | None
    obstacle_m: float
    sightings: tuple[Sighting, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PlannerContext:
    """Everything a planner may know at planning boundary k.

    Args:
        task: q.
        stage: k, from 0.
        views: O^12_k, counter-clockwise from the front (12, or 8 on a robot).
        memory: Psi_k; None when Hierarchical Spatial Memory is switched off.
        feedback: F_{k-1}; None at the first boundary.
        last_subtask: sigma_{k-1}; None at the first boundary. Its verified anchors keep their place.
        pose: live pose, episode frame.
        space: queries on the metric map.
        steps_left: environment steps that remain, this look-around already paid.
        rejections: why earlier replies of this very boundary were refused, oldest first.
    """

    task: Task
    stage: int
    views: tuple[View, ...]
    memory: EgocentricMemory | None
    feedback: Feedback | None
    last_subtask: Subtask | None
    pose: Pose
    space: SpatialMap
    steps_left: int
    rejections: tuple[str, ...] = ()

    def view(self, label: str) -> View | None:
        """The view with this label."""
        return next((view for view in self.views if view.label == label), None)


@dataclass(frozen=True, slots=True)
class PlannerThought:
    """r^P_k, the five fields of the planner's Spatial-CoT (paper Sec. 3.3)."""

    observation: str = ""
    memory: str = ""
    progress: str = ""
    decision: str = ""
    plan: str = ""


@dataclass(frozen=True, slots=True)
class PlannerReply:
    """A planner's answer: the reasoning and the subtask, not yet validated."""

    subtask: Subtask
    thought: PlannerThought = PlannerThought()
    fallbacks: tuple[str, ...] = ()  # substitute decisions it had to take; each becomes a FallbackUsed event


@dataclass(frozen=True, slots=True)
class ObstacleDistances:
    """Omega_t: distance to the nearest obstacle by sector [m], map and depth fused (capped, see docs/defaults.md)."""

    front_m: float
    left_30_m: float
    right_30_m: float


@dataclass(frozen=True, slots=True)
class AdmissibleActions:
    """U_t: what control lets the executor choose now (appendix "Action-space constraints").

    Args:
        forward_m: allowed forward distances, ascending; empty when forward is masked.
        left, right: whether a turn to that side is allowed.
        reasons: why something is masked, for the model and the record.
    """

    forward_m: tuple[float, ...]
    left: bool
    right: bool
    reasons: tuple[str, ...] = ()

    def allows(self, action: Action) -> bool:
        """Whether the action is in the set. STOP always is."""
        match action:
            case Stop():
                return True
            case MoveForward(distance_m=distance_m):
                return any(abs(distance_m - allowed) < 1e-6 for allowed in self.forward_m)
            case TurnLeft():
                return self.left
            case TurnRight():
                return self.right

    @property
    def blocked(self) -> bool:
        """No forward and no permitted turn is left."""
        return not (self.forward_m or self.left or self.right)


@dataclass(frozen=True, slots=True, eq=False)
class ExecutorContext:
    """I^E_t = (I_t, Omega_t, Lambda_t, sigma_k), with what control adds.

    Args:
        observation: front view.
        obstacles: Omega_t.
        pool: B^(k)_t.
        subtask: sigma_k.
        progress: tau_k so far.
        admissible: U_t.
        space: queries on the metric map.
        decisions_left: executor decisions that the stage budget still allows, this one included.
        rejections: why earlier answers to this very query were refused.
        sightings: of the stage's landmark in this very image, for marking it.
        goal: name of the goal object, where the agent looks about for it on the way; else ``""``.
        glimpsed: then, of everything that the planner's look-around asks for, in the images since the last decision.
    """

    observation: Observation
    obstacles: ObstacleDistances
    pool: LandmarkPool
    subtask: Subtask
    progress: StageRecord
    admissible: AdmissibleActions
    space: SpatialMap
    decisions_left: int
    rejections: tuple[str, ...] = ()
    sightings: tuple[Sighting, ...] = ()
    goal: str = ""
    glimpsed: tuple[Sighting, ...] = ()


@dataclass(frozen=True, slots=True)
class ExecutorThought:
    """r^E_t, the four fields of the executor's Spatial-CoT."""

    view: str = ""
    detection: str = ""
    progress: str = ""
    action: str = ""


@dataclass(frozen=True, slots=True)
class ExecutorReply:
    """An executor's answer: one action, and of a turn its purpose."""

    action: Action
    purpose: TurnPurpose | None = None
    thought: ExecutorThought = field(default_factory=ExecutorThought)
    fallbacks: tuple[str, ...] = ()
