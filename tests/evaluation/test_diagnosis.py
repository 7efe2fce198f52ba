"""Classes of failures from made-up evidence: a straight route of 10 m along x, success within 1 m of its end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from spacevln.core import (
    Action,
    AdmissibleActions,
    Anchor,
    CueKind,
    EpisodeStatus,
    ExecutorThought,
    LandmarkCandidate,
    Motion,
    ObstacleDistances,
    PlannerThought,
    Pose,
    SpaceKind,
    Stop,
    StopReason,
    Subtask,
)
from spacevln.evaluation.diagnosis import PAPER, Kind, diagnose, offsets_m
from spacevln.recording import Diagnosis, EventLine, Metrics
from spacevln.recording.schema import (
    DecisionMadeLine,
    EpisodeEndedLine,
    ExecutedLine,
    StageEndedLine,
    StepTakenLine,
    SubtaskIssuedLine,
)

Way = Sequence[tuple[float, float]]
OBJECT_GOAL = None
ROUTE = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])


class Straight:
    goals = np.array([[10.0, 0.0, 0.0]])
    radius_m = 1.0
    shortest_path = ROUTE

    def __init__(self, reference: NDArray[np.float64] | None) -> None:
        self.reference_path = reference

    def distances_m(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.linalg.norm(positions - self.goals[0], axis=1)

    def reached(self, position: NDArray[np.float64]) -> bool:
        return bool(self.distances_m(position[None])[0] < self.radius_m)

    def viewpoint_m(self, _: NDArray[np.float64]) -> float | None:
        return None

    def follow(self, _: Pose) -> Action:
        return Stop()


def walk(*corners: tuple[float, float]) -> list[tuple[float, float]]:
    """Places 0.25 m apart."""
    places = [corners[0]]
    for (x0, y0), (x1, y1) in pairwise(corners):
        count = max(1, round(math.dist((x0, y0), (x1, y1)) / 0.25))
        places += [(x0 + (x1 - x0) * k / count, y0 + (y1 - y0) * k / count) for k in range(1, count + 1)]
    return places


def story(
    stages: Sequence[Way],
    *,
    status: EpisodeStatus = EpisodeStatus.STOPPED,
    reason: StopReason = StopReason.GATE,
    landmark: str = "",
    pool: tuple[LandmarkCandidate, ...] = (),
    end: str = "arrival",
    stalled: bool = False,
    reference: NDArray[np.float64] | None = ROUTE,
) -> Diagnosis | None:
    lines: list[EventLine] = []
    places = [(0.0, 0.0)]
    for number, way in enumerate(stages):
        anchors = (Anchor("room", SpaceKind.ROOM), Anchor("hall", SpaceKind.ROOM))
        subtask = Subtask(anchors, 0, anchors[0], anchors[1], "left 90", "go", landmark, complete=False)
        lines.append(
            SubtaskIssuedLine(time_s=0.0, stage=number, subtask=subtask, thought=PlannerThought(), seconds=0.0, revision="")
        )
        lines.append(
            DecisionMadeLine(
                time_s=0.0,
                stage=number,
                decision=1,
                action="forward 0.25",
                purpose=None,
                thought=ExecutorThought(),
                obstacles=ObstacleDistances(1.0, 1.0, 1.0),
                pool=pool,
                admissible=AdmissibleActions((0.25,), True, True),
                seconds=0.0,
            )
        )
        for x, y in way:
            places.append((x, y))
            lines.append(
                StepTakenLine(
                    time_s=0.0,
                    step=len(places) - 1,
                    stage=number,
                    phase="execute",
                    action="forward 0.25",
                    motion=Motion(0.25, 0.0, False),
                    pose=Pose(x, y),
                    rgb=None,
                    depth=None,
                    sightings=(),
                )
            )
        done = ExecutedLine(
            asked="forward 0.25", purpose=None, moved_m=0.25, turned_rad=0.0, primitives=1, stalled=stalled, interrupted=False
        )
        lines.append(
            StageEndedLine(
                time_s=0.0, stage=number, end=end, start=Pose(0, 0), pose=Pose(*places[-1]), decisions=(done,), pool=()
            )
        )
    positions = np.array([(x, y, 0.0) for x, y in places])
    truth = Straight(reference)
    ended = EpisodeEndedLine(
        time_s=0.0,
        status=status,
        stop_reason=reason,
        stopped=True,
        detail="",
        pose=Pose(*places[-1]),
        steps=len(places) - 1,
        lookaround_steps=0,
        align_steps=0,
        collisions=0,
        stages=len(stages),
        seconds=0.0,
    )
    arrived = any(truth.reached(position) for position in positions)
    metrics = Metrics(
        SR=float(truth.reached(positions[-1])), OSR=float(arrived), NE=float(truth.distances_m(positions)[-1]), path_length=1.0,
        steps=1, lookaround_steps=0, align_steps=0, collisions=0, stages=1, rejections=0, fallbacks=0,
    )  # fmt: skip
    return diagnose(lines, ended, metrics, truth, positions, Pose(0.0, 0.0))


def candidate(x: float, y: float) -> LandmarkCandidate:
    return LandmarkCandidate(0, "chair", (x, y, 0.5), 1.0, 0.0, 0.9, visible=True, arrived=True, kind=CueKind.SOLID)


STRAY = (walk((0, 0), (4, 0)), walk((4, 0), (4, 6)))
BUDGET = {"status": EpisodeStatus.STEP_LIMIT, "reason": StopReason.BUDGET}


@pytest.mark.parametrize(
    ("kind", "found"),
    [
        (Kind.EARLY, story([walk((0, 0), (6, 0))])),
        (Kind.PASSED, story([walk((0, 0), (10, 0), (10, 4))])),
        (Kind.LATE, story([walk((0, 0), (10, 0), (10, 4))], **BUDGET)),
        (Kind.BUDGET, story([walk((0, 0), (6, 0))], **BUDGET)),
        (Kind.DIRECTION, story(STRAY)),
        (Kind.ASSOCIATION, story(STRAY, landmark="chair", pool=(candidate(4, 6),))),
        (Kind.UNSEEN, story(STRAY, landmark="chair")),
        (Kind.BLOCKED, story(STRAY, end="blocked", **BUDGET)),
        (Kind.BLOCKED, story([walk((0, 0), (4, 0))], stalled=True, **BUDGET)),
        (Kind.BLOCKED, story([walk((0, 0), (3, 0)), 30 * walk((3, 0), (3.5, 0))], **BUDGET)),
        (Kind.MODEL, story([walk((0, 0), (4, 0))], status=EpisodeStatus.MODEL_FAILURE, reason=StopReason.MODEL)),
        (Kind.ENVIRONMENT, story([], status=EpisodeStatus.ENVIRONMENT_FAILURE, reason=StopReason.ENVIRONMENT)),
        (Kind.ASSOCIATION, story(STRAY, landmark="chair", pool=(candidate(4, 6),), reference=OBJECT_GOAL)),
        (Kind.UNSEEN, story(STRAY, landmark="chair", reference=OBJECT_GOAL, **BUDGET)),
    ],
)
def test_the_evidence_gives_the_class(kind: Kind, found: Diagnosis | None) -> None:
    assert found is not None
    assert (found.name, found.paper) == (kind.value, PAPER[kind])
    assert found.reason.endswith(".")


def test_a_success_has_no_diagnosis() -> None:
    assert story([walk((0, 0), (10, 0))]) is None


def test_the_decisive_stage_is_where_the_path_was_left() -> None:
    found = story(STRAY)
    assert found is not None
    assert found.stage == 1
    assert found.step == 18  # the first of the second stage


@given(st.floats(-20, 20), st.floats(-20, 20))
def test_an_offset_is_the_distance_to_the_nearest_point_of_the_path(x: float, y: float) -> None:
    path = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0]])
    fine = np.concatenate([np.linspace(a, b, 400) for a, b in pairwise(path)])
    expected = np.linalg.norm(fine - np.array([x, y, 0.0]), axis=1).min()
    assert offsets_m(np.array([[x, y, 0.0]]), path)[0] == pytest.approx(expected, abs=0.02)
