"""The verifiable space-landmark stage: anchors, the subtask sigma_k, the stage record tau_k, the feedback F_k.

Paper Sec. 3.1 (Eq. 1, Eq. 2, the feedback equation) and appendix "Stagewise Closed-Loop Navigation Interface".
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from spacevln.core.actions import Action, TurnPurpose
from spacevln.core.geometry import Pose
from spacevln.core.sensing import Sighting


class SpaceKind(StrEnum):
    """What sort of spatial state an anchor names."""

    ROOM = "room"
    CONNECTOR = "connector"  # doorway, hallway, passage
    FLOOR_TRANSITION = "floor_transition"  # stairs up or down
    UNKNOWN = "unknown"  # the instruction names no space


class CueKind(StrEnum):
    """What sort of cue identifies an anchor; decides the arrival rule (DESIGN 5.3)."""

    NONE = "none"  # reached by its space
    SOLID = "solid"
    OPENING = "opening"
    STAIRS = "stairs"


@dataclass(frozen=True, slots=True)
class Anchor:
    """v^i_k = (s^i_k, lambda^i_k): a spatial state and its identifying cue (Eq. 1).

    Args:
        space: normalised region type or free text, e.g. ``"living room"``; ``""`` when none is named.
        space_kind: what sort of space.
        cue: landmark phrase, e.g. ``"white sofa"``; ``""`` when there is none.
        cue_kind: what sort of cue.
    """

    space: str
    space_kind: SpaceKind
    cue: str = ""
    cue_kind: CueKind = CueKind.NONE

    def __str__(self) -> str:
        return " - ".join(part for part in (self.space, self.cue) if part) or "here"


class AnchorStatus(StrEnum):
    """State of one anchor of the chain."""

    VERIFIED = "verified"
    CURRENT = "current"
    PENDING = "pending"


class Verdict(StrEnum):
    """What the planner says about the last subtask (appendix, "Planner Spatial-CoT")."""

    FIRST = "first"  # there was no last subtask
    COMPLETED = "completed"
    CONTINUE = "continue"
    TRANSITION = "transition"


@dataclass(frozen=True, slots=True)
class Subtask:
    """sigma_k = (v^j_k, C_k, v^{j+1}_k, delta_k, u_k, ell_k, z_k) (Eq. 2).

    Args:
        chain: C_k, the ordered anchor chain.
        current_index: j_k, index of the furthest verified anchor; -1 when none is verified yet.
        current_anchor: v^{j_k}_k as it describes the present place; becomes the Spatial Waypoint.
        next_anchor: v^{j_k+1}_k, the stage target; None exactly when ``complete``.
        direction: delta_k, the label of one of the look-around's views, e.g. ``"left 30"``.
        instruction: u_k, the sentence for the executor.
        landmark: ell_k, the phrase that Local Landmark Memory tracks; ``""`` for none.
        complete: z_k, the task is done.
        verdict: what became of the last subtask.
        target_m: a metric point (x, y, z) in the episode frame for the next anchor, where the planner knows one. Ours: a
            VLM gives none.
    """

    chain: tuple[Anchor, ...]
    current_index: int
    current_anchor: Anchor
    next_anchor: Anchor | None
    direction: str
    instruction: str
    landmark: str
    complete: bool
    verdict: Verdict = Verdict.FIRST
    target_m: tuple[float, float, float] | None = None

    @property
    def final_anchor(self) -> Anchor:
        """The last anchor of the chain: the goal."""
        return self.chain[-1]

    @property
    def targets_final_anchor(self) -> bool:
        """Whether this stage heads for the goal itself."""
        return not self.complete and self.current_index + 1 == len(self.chain) - 1

    def status(self, index: int) -> AnchorStatus:
        """State of the anchor at ``index`` of the chain."""
        if index < self.current_index or (self.complete and index == self.current_index):
            return AnchorStatus.VERIFIED
        return AnchorStatus.CURRENT if index == self.current_index else AnchorStatus.PENDING


@dataclass(frozen=True, slots=True)
class LandmarkCandidate:
    """An entry of the landmark pool B^(k)_t (paper, "Local Landmark Memory").

    Args:
        instance: number that stays the same within a stage.
        category: c_i.
        position_m: fused position (x, y, z) in the episode frame.
        distance_m: horizontal distance from the current pose to the nearest seen surface.
        bearing_rad: egocentric, left positive.
        confidence: fused, 0 to 1.
        visible: chi^vis, in the current view.
        arrived: chi^arr, within the arrival radius of its kind.
        kind: decides the arrival rule.
        attributes: colour, material and the like where known.
        observations: number of images it was seen in.
    """

    instance: int
    category: str
    position_m: tuple[float, float, float]
    distance_m: float
    bearing_rad: float
    confidence: float
    visible: bool
    arrived: bool
    kind: CueKind
    attributes: tuple[str, ...] = ()
    observations: int = 1


LandmarkPool = tuple[LandmarkCandidate, ...]


@dataclass(frozen=True, slots=True)
class ExecutedDecision:
    """One executor decision and what the body made of it.

    Args:
        asked: the action that control let through.
        purpose: of a turn, else None.
        moved_m, turned_rad: realised over all of its primitives.
        primitives: number of environment steps spent.
        stalled: an effective forward was asked and the body stood (under 0.05 m).
        interrupted: an event ended it before its last primitive.
    """

    asked: Action
    purpose: TurnPurpose | None
    moved_m: float
    turned_rad: float
    primitives: int
    stalled: bool
    interrupted: bool = False


@dataclass(frozen=True, slots=True)
class StageRecord:
    """tau_k: what was asked and what really happened in a stage."""

    start: Pose
    decisions: tuple[ExecutedDecision, ...] = ()

    @property
    def moved_m(self) -> float:
        """Distance travelled [m]."""
        return sum(decision.moved_m for decision in self.decisions)

    @property
    def turned_rad(self) -> float:
        """Net turn, left positive [rad]."""
        return sum(decision.turned_rad for decision in self.decisions)

    @property
    def stalls(self) -> int:
        """Number of decisions in which the body stood."""
        return sum(decision.stalled for decision in self.decisions)

    @property
    def primitives(self) -> int:
        """Environment steps spent."""
        return sum(decision.primitives for decision in self.decisions)


class StageEnd(StrEnum):
    """Why control went back to the planner (Algorithm 1, line 14)."""

    ARRIVAL = "arrival"
    STOP = "stop"
    BLOCKED = "blocked"
    STAGE_BUDGET = "stage_budget"
    EPISODE_END = "episode_end"


@dataclass(frozen=True, slots=True)
class Glimpse:
    """What one image on the way showed, of the terms that the planner's look-around asks for.

    Args:
        pose: of the body.
        sightings: lifted detections.
    """

    pose: Pose
    sightings: tuple[Sighting, ...]


@dataclass(frozen=True, slots=True)
class Feedback:
    """F_k = Phi(sigma_k, tau_k, B^(k)): what the planner learns about the last stage.

    Args:
        subtask: sigma_k.
        record: tau_k.
        pool: B^(k).
        end: why it ended.
        glimpses: of every image of the stage, in order, where the agent is set to look about on the way.
    """

    subtask: Subtask
    record: StageRecord
    pool: LandmarkPool
    end: StageEnd
    glimpses: tuple[Glimpse, ...] = ()


class EpisodeStatus(StrEnum):
    """How an episode ended; exactly one."""

    STOPPED = "stopped"
    STEP_LIMIT = "step_limit"
    MODEL_FAILURE = "model_failure"
    ENVIRONMENT_FAILURE = "environment_failure"
    SAFETY = "safety"
    INTERRUPTED = "interrupted"


class StopReason(StrEnum):
    """What led to the environment's STOP, or why there was none."""

    GATE = "gate"  # final anchor localised, earlier ones verified, landmark-arrival evidence
    STABLE_FINAL_ARRIVAL = "stable_final_arrival"
    BUDGET = "budget"  # forced: the step budget ran out
    MODEL = "model"  # forced: N_retry replies were rejected or the model failed
    ENVIRONMENT = "environment"
    SAFETY = "safety"
    SPENDING = "spending"  # forced: the run has spent what it may; the episode can be run again
    INTERRUPT = "interrupt"

    @property
    def forced(self) -> bool:
        """Whether the agent did not choose this STOP itself."""
        return self not in (StopReason.GATE, StopReason.STABLE_FINAL_ARRIVAL)
