"""Arrival, budgets, the episode gate and stable final arrival."""

from __future__ import annotations

from dataclasses import replace

import pytest

from spacevln.control import (
    ControlSettings,
    EpisodeGate,
    FinishClaim,
    StableFinalArrival,
    StageArrival,
    StepBudget,
    default_step_limit,
    inside_final_region,
)
from spacevln.control.arrival import ArrivalKind
from spacevln.core import (
    Anchor,
    ContractError,
    CueKind,
    InstructionTask,
    LandmarkCandidate,
    ObjectGoalTask,
    Pose,
    SpaceKind,
    UsageError,
)
from spacevln.testing.scripted import subtask_of

SETTINGS = ControlSettings()
START = Anchor("hallway", SpaceKind.CONNECTOR)
SOFA = Anchor("living room", SpaceKind.ROOM, "white sofa", CueKind.SOLID)
BEDROOM = Anchor("bedroom", SpaceKind.ROOM)
UPSTAIRS = Anchor("stairs", SpaceKind.FLOOR_TRANSITION, "stairs", CueKind.STAIRS)
HERE = Pose(0, 0)


def candidate(distance_m: float = 0.5, arrived: bool = True) -> LandmarkCandidate:
    return LandmarkCandidate(0, "sofa", (1, 0, 0.5), distance_m, 0.0, 0.9, True, arrived, CueKind.SOLID)


def arrival(anchor: Anchor, region: str = "hallway", **changes: object) -> StageArrival:
    return StageArrival(replace(subtask_of((START, anchor), 0), **changes), 0, region, SETTINGS)  # type: ignore[arg-type]


def test_a_landmark_arrives_by_its_pool_flag() -> None:
    watch = arrival(SOFA)
    assert watch.reached(HERE, 0, "living room", ()) is None
    assert watch.reached(HERE, 0, "living room", (candidate(arrived=False),)) is None
    assert watch.reached(HERE, 0, "hallway", (candidate(arrived=False), candidate())) is ArrivalKind.LANDMARK


def test_a_space_is_reached_half_a_metre_inside() -> None:
    watch = arrival(BEDROOM)
    assert watch.reached(Pose(0, 0), 0, "hallway", ()) is None
    assert watch.reached(Pose(1, 0), 0, "bedroom", ()) is None
    assert watch.reached(Pose(1.49, 0), 0, "bedroom", ()) is None
    assert watch.reached(Pose(1.5, 0), 0, "Bed room", ()) is ArrivalKind.SPACE


def test_leaving_a_space_begins_its_half_metre_again() -> None:
    watch = arrival(BEDROOM)
    watch.reached(Pose(1, 0), 0, "bedroom", ())
    watch.reached(Pose(0, 0), 0, "hallway", ())
    assert watch.reached(Pose(1.6, 0), 0, "bedroom", ()) is None


def test_a_space_where_the_stage_began_is_not_entered() -> None:
    watch = arrival(BEDROOM, region="bedroom")
    assert watch.reached(Pose(0, 0), 0, "bedroom", ()) is None
    assert watch.reached(Pose(3, 0), 0, "bedroom", ()) is None


def test_a_metric_target_counts_without_a_landmark_only() -> None:
    watch = arrival(BEDROOM, target_m=(2.0, 0.0, 0.0))
    assert watch.reached(Pose(1.64, 0), 0, "", ()) is None
    assert watch.reached(Pose(1.66, 0), 0, "", ()) is ArrivalKind.TARGET
    assert watch.reached(Pose(1.66, 0, 2.8), 0, "", ()) is None
    assert arrival(SOFA, target_m=(0.0, 0.0, 0.0)).reached(HERE, 0, "", ()) is None


def test_another_instance_than_the_one_meant_does_not_arrive() -> None:
    watch = arrival(SOFA, target_m=(3.0, 0.0, 0.0))
    assert watch.reached(HERE, 0, "", (candidate(),)) is None
    assert watch.reached(Pose(1.5, 0), 0, "", (candidate(),)) is ArrivalKind.LANDMARK


def test_what_was_in_reach_at_the_start_and_is_not_ahead_does_not_arrive_until_it_is_met_again() -> None:
    behind, ahead, far = (
        replace(candidate(), bearing_rad=2.4),
        replace(candidate(), instance=1, bearing_rad=0.3),
        replace(candidate(arrived=False), bearing_rad=2.4),
    )
    watch = arrival(SOFA)
    watch.depart((behind,))
    assert watch.reached(HERE, 0, "", (behind,)) is None
    assert watch.reached(HERE, 0, "", (behind, ahead)) is ArrivalKind.LANDMARK
    assert watch.reached(HERE, 0, "", (far,)) is None
    assert watch.reached(HERE, 0, "", (behind,)) is ArrivalKind.LANDMARK
    beside = arrival(SOFA)
    beside.depart((ahead,))
    assert beside.reached(HERE, 0, "", (ahead,)) is ArrivalKind.LANDMARK


def test_a_floor_transition_is_reached_by_the_floor() -> None:
    watch = arrival(UPSTAIRS)
    assert watch.reached(HERE, 0, "stairs", (candidate(),)) is None
    assert watch.reached(HERE, 1, "", ()) is ArrivalKind.FLOOR


def test_step_limits_of_the_paper() -> None:
    assert default_step_limit(InstructionTask("Go.")) == 260
    assert default_step_limit(ObjectGoalTask("sofa")) == 280


def test_budget_holds_the_last_step_for_stop() -> None:
    budget = StepBudget(13)
    assert budget.affords(12)
    assert not budget.affords(13)
    for _ in range(12):
        assert budget.can_move
        budget.spend()
    assert not budget.can_move
    assert not budget.affords(0)  # a step that could move is the least
    budget.spend()
    with pytest.raises(ContractError, match="13 steps"):
        budget.spend()
    with pytest.raises(UsageError, match="at least 1"):
        StepBudget(0)


CLAIM = FinishClaim(
    chain=(START, SOFA),
    located_index=1,
    verified_before=0,
    place="living room",
    pool=(candidate(),),
    arrived=False,
    changed_floor=False,
)


def failed(gate: EpisodeGate, claim: FinishClaim) -> list[str]:
    verdict = gate.judge(claim)
    assert verdict.accepted == all(holds for _, holds in verdict.clauses)
    return [name for name, holds in verdict.clauses if not holds]


def test_full_evidence_opens_the_gate() -> None:
    verdict = EpisodeGate().judge(CLAIM)
    assert verdict.accepted
    assert [name for name, _ in verdict.clauses] == [
        "final_anchor_claimed",
        "earlier_anchors_verified",
        "final_space_localised",
        "landmark_arrival",
    ]


def test_a_flight_as_the_goal_is_taken_only_by_the_change_of_floor() -> None:
    flight = Anchor("stairs up", SpaceKind.FLOOR_TRANSITION, "stairs", CueKind.STAIRS)
    beside = replace(CLAIM, chain=(START, flight), place="hallway", pool=(candidate(),), arrived=True)
    for gate in (EpisodeGate(), EpisodeGate(hsm=False, landmark_memory=False, stagewise=False)):
        assert failed(gate, beside) == ["change_of_floor"]
        assert failed(gate, replace(beside, changed_floor=True, pool=(), arrived=False)) == []


def test_each_clause_closes_the_gate_and_binds_only_with_its_component() -> None:
    assert failed(EpisodeGate(), replace(CLAIM, located_index=0)) == ["final_anchor_claimed"]
    elsewhere = replace(CLAIM, place="kitchen")
    assert failed(EpisodeGate(), elsewhere) == ["final_space_localised"]
    assert failed(EpisodeGate(hsm=False), elsewhere) == []
    unseen = replace(CLAIM, pool=(candidate(arrived=False),))
    assert failed(EpisodeGate(), unseen) == ["landmark_arrival"]
    assert failed(EpisodeGate(landmark_memory=False), unseen) == []
    assert failed(EpisodeGate(), replace(unseen, arrived=True)) == []
    jumped = replace(CLAIM, chain=(START, BEDROOM, START, SOFA), located_index=3, verified_before=0)
    assert failed(EpisodeGate(), jumped) == ["earlier_anchors_verified"]
    assert failed(EpisodeGate(), replace(jumped, verified_before=1)) == []
    assert failed(EpisodeGate(stagewise=False), jumped) == []


def test_with_everything_off_the_planners_word_is_what_binds() -> None:
    gate = EpisodeGate(hsm=False, landmark_memory=False, stagewise=False)
    assert gate.judge(replace(CLAIM, place="", pool=())).clauses == (("final_anchor_claimed", True),)


def test_a_goal_without_a_cue_is_grounded_by_its_space() -> None:
    claim = replace(CLAIM, chain=(START, BEDROOM), place="bedroom", pool=())
    assert failed(EpisodeGate(), claim) == []
    assert failed(EpisodeGate(), replace(claim, place="")) == ["final_space_localised"]
    assert failed(EpisodeGate(), replace(claim, place="", arrived=True)) == []


def test_an_opening_belongs_to_both_sides_and_an_unknown_place_contradicts_nothing() -> None:
    door = Anchor("bedroom", SpaceKind.ROOM, "doorway", CueKind.OPENING)
    assert failed(EpisodeGate(), replace(CLAIM, chain=(START, door), place="hallway")) == []
    assert failed(EpisodeGate(), replace(CLAIM, place="")) == []


def test_the_refusal_names_what_is_missing() -> None:
    reason = EpisodeGate().judge(replace(CLAIM, pool=())).reason
    assert "landmark arrival" in reason
    assert "final space" not in reason


def test_stable_final_arrival_needs_three_boundaries_without_motion() -> None:
    stable, last = StableFinalArrival(SETTINGS), subtask_of((START, SOFA), 0)
    assert not stable.observe(last, Pose(0, 0), inside=True)
    assert not stable.observe(last, Pose(0.9, 0), inside=True)
    assert stable.observe(last, Pose(0.5, 0.5), inside=True)


@pytest.mark.parametrize("disturbance", ["outside", "drift", "other anchor", "other goal"])
def test_stable_final_arrival_starts_over(disturbance: str) -> None:
    stable, last = StableFinalArrival(SETTINGS), subtask_of((START, SOFA), 0)
    stable.observe(last, HERE, inside=True)
    stable.observe(last, HERE, inside=True)
    match disturbance:
        case "outside":
            assert not stable.observe(last, HERE, inside=False)
        case "drift":
            assert not stable.observe(last, Pose(1.1, 0), inside=True)
        case "other anchor":
            assert not stable.observe(subtask_of((START, SOFA), -1), HERE, inside=True)
        case _:
            assert not stable.observe(subtask_of((START, BEDROOM), 0), HERE, inside=True)
    assert not stable.observe(last, Pose(1.1, 0), inside=True)


def test_inside_the_final_region() -> None:
    assert inside_final_region(SOFA, "living room", (), SETTINGS, hsm=True)
    assert not inside_final_region(SOFA, "kitchen", (candidate(),), SETTINGS, hsm=True)
    assert inside_final_region(SOFA, "", (candidate(1.4),), SETTINGS, hsm=False)
    assert not inside_final_region(replace(SOFA, space=""), "", (candidate(1.6),), SETTINGS, hsm=True)
