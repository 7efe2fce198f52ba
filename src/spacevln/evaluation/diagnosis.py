"""Why an episode failed: a class from the evidence in the record and the truth (paper, appendix "Failure Analysis").

The paper groups four cases by hand; the classes here are finer, and each belongs to one of its four kinds or to none of them.
A route is judged by where the agent left the shortest path for good; an object goal, which any way may lead to, by what its
landmark pool held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from spacevln.core import EpisodeStatus, LandmarkCandidate, Pose
from spacevln.evaluation.episode import GroundTruth, Points
from spacevln.language import parse, same_thing
from spacevln.recording import Diagnosis, EventLine, Metrics, ResultFile
from spacevln.recording.schema import (
    DecisionMadeLine,
    EpisodeEndedLine,
    EpisodeStartedLine,
    StageEndedLine,
    StepTakenLine,
    SubtaskIssuedLine,
)

ON_ROUTE_M = 1.5
"""Farther than this from the shortest path is off it."""
SAME_OBJECT_M = 2.0
"""A candidate farther than this from every goal object is another object."""
AT_GOAL_M = 2.0
"""An agent that came this near was at the goal; nearer than the 3 m of a route's success, which a wrong turn may graze."""
STALLED_SHARE = 0.3
"""Share of forward decisions without motion from which an agent counts as blocked."""
CONFINED_M = 3.0
"""An agent that spends the second half of its steps in a box of this diagonal oscillates."""
PROGRESS_M = 1.0
"""Less than this nearer to the goal over the last third of the steps is no progress."""


class Kind(StrEnum):
    """Classes of failures."""

    ASSOCIATION = "wrong landmark association"
    UNSEEN = "never saw the landmark"
    BLOCKED = "blocked or oscillating"
    DIRECTION = "wrong direction or reference frame"
    PASSED = "progress lost: passed the goal"
    EARLY = "progress lost: stopped too early"
    LATE = "progress lost: stopped too late"
    BUDGET = "budget"
    MODEL = "model failure"
    ENVIRONMENT = "environment failure"


OUTSIDE = "outside the paper"
PAPER: dict[Kind, str] = {
    Kind.ASSOCIATION: "misrecognition",
    Kind.UNSEEN: "misrecognition",
    Kind.BLOCKED: "obstacle avoidance",
    Kind.DIRECTION: "ambiguous instruction",
    Kind.PASSED: "progress tracking",
    Kind.EARLY: "progress tracking",
    Kind.LATE: "progress tracking",
    Kind.BUDGET: OUTSIDE,
    Kind.MODEL: OUTSIDE,
    Kind.ENVIRONMENT: OUTSIDE,
}
UNDIAGNOSED = "not diagnosed"
CLASSES = (*(kind.value for kind in Kind), UNDIAGNOSED)
"""What :func:`failure_class` may say."""
PAPER_KINDS = (*dict.fromkeys(PAPER.values()), UNDIAGNOSED)
"""What :func:`failure_kind` may say."""


def failure_class(result: ResultFile) -> str | None:
    """The class of a failed episode; None for a success and where there is no truth. Results before format 1.2 name none."""
    return _failure(result, None if result.diagnosis is None else result.diagnosis.name)


def failure_kind(result: ResultFile) -> str | None:
    """The paper's kind of error of a failed episode, as :func:`failure_class`."""
    return _failure(result, None if result.diagnosis is None else result.diagnosis.paper)


def _failure(result: ResultFile, name: str | None) -> str | None:
    return (name or UNDIAGNOSED) if result.metrics.SR == 0.0 else None


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """The evidence.

    Args:
        steps: taken, oldest first.
        subtasks, decisions, ends: of every stage.
        distances_m: (N + 1,) geodesic to the goal, at the start and after each of N steps.
        offsets_m: (N + 1,) to the shortest path.
        goals: (G, 3) in the episode frame.
        path: (M, 3) shortest path in the episode frame.
        forced: the agent did not choose its STOP.
        last_named: what the instruction names last; ``""`` where it names nothing.
    """

    steps: tuple[StepTakenLine, ...]
    subtasks: dict[int, SubtaskIssuedLine]
    decisions: dict[int, list[DecisionMadeLine]]
    ends: dict[int, StageEndedLine]
    distances_m: NDArray[np.float64]
    offsets_m: NDArray[np.float64]
    goals: Points
    path: Points
    forced: bool
    last_named: str

    def finding(self, kind: Kind, reason: str, index: int | None) -> Diagnosis:
        """The diagnosis with the step at an index of ``distances_m``; the first step stands for the start."""
        step = None if index is None or not self.steps else self.steps[max(0, index - 1)]
        return Diagnosis(
            name=kind.value,
            paper=PAPER[kind],
            reason=reason,
            stage=None if step is None else step.stage,
            step=None if step is None else step.step,
        )

    def first_index(self, stage: int) -> int:
        """Index of the step at which a stage was planned."""
        return next((k for k, step in enumerate(self.steps, start=1) if step.stage == stage and step.phase != "lookaround"), 0)

    def candidates(self, stages: Sequence[int]) -> list[LandmarkCandidate]:
        """What the landmark pool held in some stages."""
        return [candidate for stage in stages for decision in self.decisions.get(stage, ()) for candidate in decision.pool]


def diagnose(
    lines: Sequence[EventLine], end: EpisodeEndedLine, metrics: Metrics, truth: GroundTruth, positions: Points, origin: Pose
) -> Diagnosis | None:
    """The class of a failed episode; None for a success and for an interrupted one.

    Args:
        lines: of the episode's record.
        end: its last line.
        metrics: with the truth's part.
        truth: of the episode.
        positions: (N, 3) in the scene frame, the start first.
        origin: of the episode frame in the scene.
    """
    if metrics.SR != 0.0 or end.status is EpisodeStatus.INTERRUPTED:
        return None
    case = _case(lines, end, truth, positions, origin)
    if end.status is EpisodeStatus.MODEL_FAILURE:
        return case.finding(
            Kind.MODEL, f"The model failed: {end.detail or 'no usable reply'}.".replace("..", "."), len(case.steps)
        )
    if end.status in (EpisodeStatus.ENVIRONMENT_FAILURE, EpisodeStatus.SAFETY):
        return case.finding(Kind.ENVIRONMENT, f"The world ended the episode: {end.detail or end.status.value}.", len(case.steps))
    if metrics.NE is None:
        return case.finding(Kind.ENVIRONMENT, "No way leads from where it ended to the goal.", None)
    if metrics.OSR == 1.0 and float(case.distances_m.min()) < AT_GOAL_M:
        return _had_arrived(case, truth, positions)
    return _blocked(case) or (_object_goal(case) if truth.reference_path is None else _route(case))


def _case(lines: Sequence[EventLine], end: EpisodeEndedLine, truth: GroundTruth, positions: Points, origin: Pose) -> Case:
    decisions: dict[int, list[DecisionMadeLine]] = {}
    named: list[str] = []
    for line in lines:
        if isinstance(line, EpisodeStartedLine):
            named = [clause.place.phrase for clause in parse(line.task_text) if clause.place is not None]
        if isinstance(line, DecisionMadeLine):
            decisions.setdefault(line.stage, []).append(line)
    return Case(
        steps=tuple(line for line in lines if isinstance(line, StepTakenLine)),
        subtasks={line.stage: line for line in lines if isinstance(line, SubtaskIssuedLine)},
        decisions=decisions,
        ends={line.stage: line for line in lines if isinstance(line, StageEndedLine)},
        distances_m=truth.distances_m(positions),
        offsets_m=offsets_m(positions, truth.shortest_path),
        goals=_in_episode(truth.goals, origin),
        path=_in_episode(truth.shortest_path, origin),
        forced=end.stop_reason.forced,
        last_named=named[-1] if named else "",
    )


def offsets_m(points: Points, path: Points) -> NDArray[np.float64]:
    """Distance of each point (N, 3) to a polyline (M, 3), shape (N,) [m]."""
    if len(path) < 2:
        return np.asarray(np.linalg.norm(points - path[:1], axis=1), np.float64)
    a, along = path[:-1], np.diff(path, axis=0)
    squared = np.maximum((along**2).sum(axis=1), 1e-12)
    t = np.clip(((points[:, None] - a) * along).sum(axis=2) / squared, 0.0, 1.0)
    gaps = np.linalg.norm(points[:, None] - (a + t[..., None] * along), axis=2)
    return np.asarray(gaps.min(axis=1), np.float64)


def _in_episode(points: Points, origin: Pose) -> Points:
    places = [Pose(*map(float, point)).relative_to(origin).position_m for point in points]
    return np.array(places).reshape(-1, 3)


def _had_arrived(case: Case, truth: GroundTruth, positions: Points) -> Diagnosis:
    inside = [k for k, position in enumerate(positions) if truth.reached(position)]
    if case.forced:
        return case.finding(Kind.LATE, "It was at the goal and did not stop before its steps ran out.", inside[0])
    return case.finding(Kind.PASSED, f"It was at the goal and stopped {case.distances_m[-1]:.1f} m from it.", inside[-1])


def _blocked(case: Case) -> Diagnosis | None:
    """Whether the body, and not the mind, kept it from the goal."""
    for stage, ended in case.ends.items():
        left = _departure(case)
        if ended.end == "blocked" and (case.forced or left is None or case.steps[max(0, left - 1)].stage in (stage, stage + 1)):
            return case.finding(Kind.BLOCKED, f"Stage {stage + 1} ended because no way was left.", case.first_index(stage))
    if not case.forced:
        return None
    asked = [done for ended in case.ends.values() for done in ended.decisions if done.asked.startswith("forward")]
    stalls = sum(done.stalled for done in asked)
    if asked and stalls / len(asked) >= STALLED_SHARE:
        worst = max(case.ends, key=lambda stage: sum(done.stalled for done in case.ends[stage].decisions))
        return case.finding(Kind.BLOCKED, f"{stalls} of {len(asked)} forward moves did not move it.", case.first_index(worst))
    half = len(case.steps) // 2
    places = np.array([step.pose.position_m[:2] for step in case.steps[half:]]).reshape(-1, 2)
    if len(places) and float(np.linalg.norm(np.ptp(places, axis=0))) < CONFINED_M:
        return case.finding(Kind.BLOCKED, "It spent the second half of its steps on one spot.", half)
    return None


def _departure(case: Case) -> int | None:
    """Index after which the agent never came back to the shortest path; None when it ended on it."""
    near = np.flatnonzero(case.offsets_m <= ON_ROUTE_M)
    last = int(near[-1]) if len(near) else 0
    return None if last == len(case.offsets_m) - 1 else last


def _route(case: Case) -> Diagnosis:
    left = _departure(case)
    if left is None:
        return _on_route(case)
    stage = case.steps[min(left, len(case.steps) - 1)].stage
    issued = case.subtasks.get(stage)
    landmark = issued.subtask.landmark if issued else ""
    way = f"It left the shortest path for good in stage {stage + 1}"
    if landmark:
        pool = case.candidates([stage])
        if not pool:
            return case.finding(Kind.UNSEEN, f"{way}, looking for “{landmark}” and never seeing it.", case.first_index(stage))
        best = min(pool, key=lambda candidate: candidate.distance_m)
        away_m = float(offsets_m(np.array([best.position_m]), case.path)[0])
        if away_m > ON_ROUTE_M:
            text = f"{way}, heading for a “{best.category}” that lies {away_m:.1f} m off it."
            return case.finding(Kind.ASSOCIATION, text, left + 1)
    chosen = f", going {issued.subtask.direction}" if issued and issued.subtask.direction else ""
    return case.finding(Kind.DIRECTION, f"{way}{chosen}.", case.first_index(stage) or left + 1)


def _on_route(case: Case) -> Diagnosis:
    """The agent ended on the shortest path, short of the goal."""
    rest_m = float(case.distances_m[-1])
    if not case.forced:
        other = _stopped_at(case)
        if other is not None:
            text = f"It stopped at a “{other.category}” on the way, {rest_m:.1f} m before the goal."
            return case.finding(Kind.ASSOCIATION, text, case.first_index(max(case.decisions)))
        return case.finding(Kind.EARLY, f"It stopped on the way, {rest_m:.1f} m before the goal.", len(case.steps))
    stages = sorted(case.subtasks)[-3:]
    searched = [case.subtasks[stage].subtask.landmark for stage in stages]
    third = len(case.distances_m) * 2 // 3
    if all(searched) and not case.candidates(stages) and case.distances_m[third] - rest_m < PROGRESS_M:
        text = f"It ran out of steps looking for “{searched[-1]}” and never seeing it."
        return case.finding(Kind.UNSEEN, text, case.first_index(stages[0]))
    return case.finding(Kind.BUDGET, f"It ran out of steps on the way, {rest_m:.1f} m before the goal.", len(case.steps))


def _stopped_at(case: Case) -> LandmarkCandidate | None:
    """The landmark at which the agent stopped, if it is another one of what the instruction names last."""
    ended = case.ends.get(max(case.decisions, default=-1))
    arrived = [candidate for candidate in ended.pool if candidate.arrived] if ended is not None else []
    alike = [candidate for candidate in arrived if case.last_named and same_thing(candidate.category, case.last_named)]
    return next((candidate for candidate in alike if not _is_goal(case, candidate)), None)


def _object_goal(case: Case) -> Diagnosis:
    if not case.forced:
        text = f"It stopped {case.distances_m[-1]:.1f} m from the goal object, at something it took for it."
        return case.finding(Kind.ASSOCIATION, text, case.first_index(max(case.decisions, default=0)))
    final = [stage for stage, issued in case.subtasks.items() if issued.subtask.targets_final_anchor]
    pool = case.candidates(final)
    if any(_is_goal(case, candidate) for candidate in pool):
        text = "It had seen the goal object and ran out of steps before it was there."
        return case.finding(Kind.BUDGET, text, len(case.steps))
    if not pool:
        return case.finding(Kind.UNSEEN, "It ran out of steps without seeing the goal object.", len(case.steps))
    return case.finding(Kind.ASSOCIATION, "It ran out of steps following things that were not the goal object.", len(case.steps))


def _is_goal(case: Case, candidate: LandmarkCandidate) -> bool:
    gaps = np.linalg.norm(case.goals - np.array(candidate.position_m), axis=1)
    return bool(len(gaps)) and float(gaps.min()) < SAME_OBJECT_M
