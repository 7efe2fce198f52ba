"""The record's format (docs/record-format.md): one pydantic model per line of ``events.jsonl`` and one per JSON file.

Images are files beside the events; a line holds their names. Numbers that are not finite are the strings ``"Infinity"``,
``"-Infinity"`` and ``"NaN"``, so that every line is strict JSON.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter

from spacevln.core import (
    AdmissibleActions,
    ArrangedWaypoint,
    Camera,
    EpisodeStatus,
    ExecutorThought,
    Frontier,
    LandmarkPool,
    Motion,
    ObstacleDistances,
    PlannerThought,
    Pose,
    Sighting,
    SpatialWaypoint,
    StopReason,
    Subtask,
    TurnPurpose,
)
from spacevln.recording.calls import CallRetriedLine, ModelCalledLine
from spacevln.recording.record import Record
from spacevln.recording.usage import CallUsage

Format = Literal["spacevln-record/1.0", "spacevln-record/1.1", "spacevln-record/1.2", "spacevln-record/1.3"]
FORMAT: Format = "spacevln-record/1.3"
"""Name and version of the format. The second number counts additions: this version reads every record of the same first number
up to its own; the first changes when something that was there changes its meaning."""


class EpisodeStartedLine(Record):
    """The environment was reset. ``start`` is in the scene frame, every other pose in the episode frame.

    ``origin`` is the origin of the episode frame in the scene; None says that it is ``start``, as it is unless the memory of
    an earlier episode was loaded. ``camera`` and ``T_body_camera``, a homogeneous matrix by rows, are None before format 1.2.
    """

    event: Literal["episode_started"] = "episode_started"
    time_s: float
    episode_id: str
    scene: str
    start: Pose
    origin: Pose | None = None
    task_kind: Literal["vln", "objectnav"]
    task_text: str
    camera: Camera | None = None
    T_body_camera: tuple[tuple[float, float, float, float], ...] | None = None

    @property
    def T_scene_episode(self) -> Pose:
        """The origin of every other pose of the record, in the scene frame."""
        return self.origin or self.start


class StepTakenLine(Record):
    """One environment step. ``external`` names the picture of a camera that shows the robot from outside, where one was kept."""

    event: Literal["step_taken"] = "step_taken"
    time_s: float
    step: int
    stage: int
    phase: str
    action: str
    motion: Motion
    pose: Pose
    rgb: str | None
    depth: str | None
    external: str | None = None
    sightings: tuple[Sighting, ...]


class ViewLine(Record):
    """One view of a look-around; ``rgb`` names the image of the step that took it, None where the agent did not turn to."""

    label: str
    heading_rad: float
    rgb: str | None
    obstacle_m: float
    sightings: tuple[Sighting, ...]


class MemoryLine(Record):
    """Psi_k, the planner's view of Spatial Cognitive Memory."""

    pose: Pose
    floor: int
    region: str
    waypoints: tuple[ArrangedWaypoint, ...]
    chain: tuple[int, ...]
    text: str
    map_image: str | None
    frontiers: tuple[Frontier, ...]


class LookedAroundLine(Record):
    """What the planner saw at a planning boundary."""

    event: Literal["looked_around"] = "looked_around"
    time_s: float
    stage: int
    views: tuple[ViewLine, ...]
    memory: MemoryLine | None


class ReplyRefusedLine(Record):
    """A reply was rejected."""

    event: Literal["reply_refused"] = "reply_refused"
    time_s: float
    stage: int
    role: str
    kind: str
    reason: str


class SubtaskIssuedLine(Record):
    """sigma_k was validated."""

    event: Literal["subtask_issued"] = "subtask_issued"
    time_s: float
    stage: int
    subtask: Subtask
    thought: PlannerThought
    seconds: float
    revision: str


class WaypointAddedLine(Record):
    """w_k joined graph and chain."""

    event: Literal["waypoint_added"] = "waypoint_added"
    time_s: float
    stage: int
    waypoint: SpatialWaypoint


class DecisionMadeLine(Record):
    """The executor chose an admissible action."""

    event: Literal["decision_made"] = "decision_made"
    time_s: float
    stage: int
    decision: int
    action: str
    purpose: TurnPurpose | None
    thought: ExecutorThought
    obstacles: ObstacleDistances
    pool: LandmarkPool
    admissible: AdmissibleActions
    seconds: float
    sightings: tuple[Sighting, ...] = ()


class ExecutedLine(Record):
    """One executed decision inside F_k."""

    asked: str
    purpose: TurnPurpose | None
    moved_m: float
    turned_rad: float
    primitives: int
    stalled: bool
    interrupted: bool


class StageEndedLine(Record):
    """Control went back to the planner with F_k."""

    event: Literal["stage_ended"] = "stage_ended"
    time_s: float
    stage: int
    end: str
    start: Pose
    pose: Pose
    decisions: tuple[ExecutedLine, ...]
    pool: LandmarkPool


class FallbackUsedLine(Record):
    """A substitute decision was taken."""

    event: Literal["fallback_used"] = "fallback_used"
    time_s: float
    stage: int
    kind: str
    detail: str


class GateAskedLine(Record):
    """The episode gate judged a finish."""

    event: Literal["gate_asked"] = "gate_asked"
    time_s: float
    stage: int
    accepted: bool
    clauses: tuple[tuple[str, bool], ...]


class FloorMapLine(Record):
    """One floor of the final map; ``image`` is a PNG: red = cells (0 unknown, 1 free, 2 obstacle), green = regions."""

    floor: int
    resolution_m: float
    origin_m: tuple[float, float]
    image: str
    region_names: tuple[str, ...]


class MapSavedLine(Record):
    """The metric map at the end."""

    event: Literal["map_saved"] = "map_saved"
    time_s: float
    floors: tuple[FloorMapLine, ...]


class EpisodeEndedLine(Record):
    """The episode is over."""

    event: Literal["episode_ended"] = "episode_ended"
    time_s: float
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


EventLine = Annotated[
    EpisodeStartedLine
    | StepTakenLine
    | LookedAroundLine
    | ReplyRefusedLine
    | ModelCalledLine
    | CallRetriedLine
    | SubtaskIssuedLine
    | WaypointAddedLine
    | DecisionMadeLine
    | StageEndedLine
    | FallbackUsedLine
    | GateAskedLine
    | MapSavedLine
    | EpisodeEndedLine,
    Field(discriminator="event"),
]

EVENT_LINE: TypeAdapter[EventLine] = TypeAdapter(EventLine)


class Metrics(Record):
    """Metrics of one episode; null where there is no truth (a free instruction) or where the value is infinite.

    ``SR``, ``SPL``, ``OSR``, ``nDTW``, ``SDTW`` and ``SoftSPL`` are 0 to 1, ``NE`` and ``path_length`` metres. ``SR_no_stop`` and
    ``SPL_no_stop`` need no STOP, ``SR_viewpoint`` and ``SR_viewpoint_1m`` are STOP within 0.25 m and 1 m of a view point of the
    goal object: variants that are printed beside SR, never instead of it.
    """

    SR: float | None = None
    SPL: float | None = None
    OSR: float | None = None
    NE: float | None = None
    nDTW: float | None = None
    SDTW: float | None = None
    SoftSPL: float | None = None
    oracle_NE: float | None = None
    SR_no_stop: float | None = None
    SPL_no_stop: float | None = None
    SR_viewpoint: float | None = None
    SR_viewpoint_1m: float | None = None
    path_length: float
    steps: int
    lookaround_steps: int
    align_steps: int
    collisions: int
    stages: int
    rejections: int
    fallbacks: int


class Truth(Record):
    """What evaluation knows and the agent does not, in the scene frame: for tables and viewers."""

    goals: tuple[tuple[float, float, float], ...]
    shortest_path: tuple[tuple[float, float, float], ...]
    geodesic_m: float
    final_distance_m: float


class Diagnosis(Record):
    """Why an episode failed, by evaluation (docs/metrics.md).

    Args:
        name: the class.
        paper: which of the paper's four kinds of errors it belongs to, or ``"outside the paper"``.
        reason: the evidence, in one sentence.
        stage: of the decisive step; None where no stage decided.
        step: the decisive step; None where no step decided.
    """

    name: str
    paper: str
    reason: str
    stage: int | None = None
    step: int | None = None


class ResultFile(Record):
    """``result.json``: written once, atomically; the first result of an episode stands.

    ``timing_s`` and ``restarts`` are the only fields that may differ when an episode is repeated. ``memory`` names the file of
    the final memory beside it; ``loaded_memory`` is the digest of the one that the episode began with, null for none. ``usage``
    sums the calls of chat models by role. ``diagnosis`` is null for a success and where there is no truth.
    """

    format: Format = FORMAT
    episode_id: str
    scene: str
    task_kind: Literal["vln", "objectnav"]
    task_text: str
    status: EpisodeStatus
    stop_reason: StopReason
    forced_stop: bool
    detail: str
    metrics: Metrics
    truth: Truth | None
    tags: dict[str, str | float | int | bool] = Field(default={})
    memory: str | None = None
    loaded_memory: str | None = None
    usage: dict[str, CallUsage] = Field(default={})
    diagnosis: Diagnosis | None = None
    timing_s: float
    restarts: int = 0


class RunFile(Record):
    """``run.json``: what ran. ``dataset`` has the SHA-256 of every data file by its name; empty for what the program makes."""

    format: Format = FORMAT
    version: str
    suite: str
    created: str
    command: tuple[str, ...]
    configuration: dict[str, Any]
    configuration_hash: str
    packages: dict[str, str]
    python: str
    platform: str
    git_revision: str | None
    dataset: dict[str, str] = Field(default={})


class SummaryFile(Record):
    """``summary.json``: means over every attempted episode (DESIGN 8); percent for SR, SPL, OSR and nDTW, metres for NE.

    ``intervals`` has the 95 % bootstrap interval over episodes of each mean that has one; ``diagnoses`` counts failed episodes by
    class, ``diagnoses_paper`` by the paper's kinds of errors.
    """

    episodes: int
    metrics: dict[str, float | None]
    statuses: dict[str, int]
    stop_reasons: dict[str, int]
    rejections: int
    fallbacks: int
    unreachable: int
    intervals: dict[str, tuple[float, float]] = Field(default={})
    diagnoses: dict[str, int] = Field(default={})
    diagnoses_paper: dict[str, int] = Field(default={})
    usage: dict[str, CallUsage] = Field(default={})
