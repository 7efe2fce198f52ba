"""What the agent loop says while it runs. Recording, progress display and viewers only listen (DESIGN 2)."""

from __future__ import annotations

from dataclasses import dataclass

from spacevln.core.actions import Action, Motion, TurnPurpose
from spacevln.core.chat import ChatReply, ChatRequest, Role
from spacevln.core.contexts import AdmissibleActions, ExecutorThought, ObstacleDistances, PlannerThought, View
from spacevln.core.geometry import Pose
from spacevln.core.sensing import Observation, Sighting
from spacevln.core.spatial import EgocentricMemory, FloorMap, SpatialWaypoint
from spacevln.core.stages import EpisodeStatus, Feedback, LandmarkPool, StopReason, Subtask
from spacevln.core.task import EpisodeSpec


@dataclass(frozen=True, slots=True)
class EpisodeStarted:
    """The environment was reset; ``observation`` is the first one."""

    episode: EpisodeSpec
    pose: Pose
    observation: Observation | None = None


@dataclass(frozen=True, slots=True, eq=False)
class StepTaken:
    """One environment step: a primitive, in a look-around, an alignment or a decision.

    Args:
        step: number of this step in the episode, from 1; STOP counts.
        stage: k.
        phase: ``"lookaround"``, ``"align"``, ``"execute"`` or ``"stop"``.
        action: the primitive.
        motion: what really happened.
        observation: after it; None after STOP.
        sightings: of the active terms in it.
    """

    step: int
    stage: int
    phase: str
    action: Action
    motion: Motion
    pose: Pose
    observation: Observation | None
    sightings: tuple[Sighting, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class LookedAround:
    """O^12_k and Psi_k are ready for the planner."""

    stage: int
    views: tuple[View, ...]
    memory: EgocentricMemory | None


@dataclass(frozen=True, slots=True)
class ReplyRefused:
    """A planner's or executor's reply was rejected and, within N_retry, asked again.

    Args:
        role: ``"planner"`` or ``"executor"``.
        kind: class of the rejection.
        reason: what the model is told.
    """

    stage: int
    role: str
    kind: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class ModelCalled:
    """A chat model was asked, with whatever outcome; every call is told, those of refused replies included.

    Args:
        model: its name.
        request: what it read.
        reply: what it wrote; None when no reply came.
        problem: ``""`` for a usable reply, the class of an unusable one, or ``"failed"`` when none came.
        detail: reason or message of the problem.
    """

    model: str
    request: ChatRequest
    reply: ChatReply | None
    problem: str = ""
    detail: str = ""


@dataclass(frozen=True, slots=True)
class CallRetried:
    """A request to a model failed and is sent again.

    Args:
        attempt: number of the failed one, from 1.
        kind: class of the failure, e.g. ``"timeout"``, ``"rate_limit"``.
        detail: what happened.
        wait_s: pause before the next attempt.
    """

    role: Role
    model: str
    attempt: int
    kind: str
    detail: str
    wait_s: float


@dataclass(frozen=True, slots=True)
class SubtaskIssued:
    """sigma_k was validated.

    Args:
        revision: how unverified anchors were refined or replaced since the last call, in words; ``""`` when they were not.
    """

    stage: int
    subtask: Subtask
    thought: PlannerThought
    seconds: float
    revision: str = ""


@dataclass(frozen=True, slots=True)
class WaypointAdded:
    """w_k joined graph and chain."""

    stage: int
    waypoint: SpatialWaypoint


@dataclass(frozen=True, slots=True, eq=False)
class DecisionMade:
    """The executor chose an admissible action.

    Args:
        decision: number within the stage, from 1.
        obstacles, pool, admissible, sightings: what it saw.
    """

    stage: int
    decision: int
    action: Action
    purpose: TurnPurpose | None
    thought: ExecutorThought
    obstacles: ObstacleDistances
    pool: LandmarkPool
    admissible: AdmissibleActions
    seconds: float
    sightings: tuple[Sighting, ...] = ()


@dataclass(frozen=True, slots=True)
class StageEnded:
    """Control went back to the planner with F_k."""

    stage: int
    feedback: Feedback
    pose: Pose


@dataclass(frozen=True, slots=True)
class FallbackUsed:
    """A substitute decision was taken. The report counts these; there is no silent one.

    Args:
        kind: class of the fallback, e.g. ``"planner_no_candidate"``.
    """

    stage: int
    kind: str
    detail: str


@dataclass(frozen=True, slots=True)
class GateAsked:
    """The episode gate judged a finish.

    Args:
        accepted: whether STOP may be issued.
        clauses: name of every evidence clause that applied, with its outcome.
    """

    stage: int
    accepted: bool
    clauses: tuple[tuple[str, bool], ...]


@dataclass(frozen=True, slots=True, eq=False)
class MapSaved:
    """The metric map as it stands at the end of the episode, one picture per floor; comes before :class:`EpisodeEnded`."""

    floors: tuple[FloorMap, ...]


@dataclass(frozen=True, slots=True)
class EpisodeEnded:
    """The episode is over.

    Args:
        stopped: the environment's STOP was issued.
        steps, lookaround_steps, align_steps: environment steps, of which in look-arounds and alignments.
    """

    status: EpisodeStatus
    stop_reason: StopReason
    stopped: bool
    detail: str
    pose: Pose
    steps: int
    lookaround_steps: int
    align_steps: int
    collisions: int
    stages: int
    seconds: float


Event = (
    EpisodeStarted
    | StepTaken
    | LookedAround
    | ReplyRefused
    | ModelCalled
    | CallRetried
    | SubtaskIssued
    | WaypointAdded
    | DecisionMade
    | StageEnded
    | FallbackUsed
    | GateAsked
    | MapSaved
    | EpisodeEnded
)
