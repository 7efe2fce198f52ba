"""The loop against Algorithm 1: order of events, look-around, alignment, decisions, interruptions."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from flat_runs import BED, CHAIN, DOOR, SOFA, Glass, ahead, by_feedback, run

from spacevln.agent import AgentSettings, Components
from spacevln.core import (
    DecisionMade,
    EpisodeEnded,
    EpisodeStatus,
    ExecutedDecision,
    ExecutorReply,
    FallbackUsed,
    GateAsked,
    LookedAround,
    MapSaved,
    ModelError,
    MoveForward,
    ObjectGoalTask,
    PlannerReply,
    Pose,
    ReplyRefused,
    ReplyRejected,
    StageEnd,
    StageEnded,
    StepTaken,
    Stop,
    StopReason,
    SubtaskIssued,
    TurnLeft,
    TurnRight,
    WaypointAdded,
)
from spacevln.testing.flatland import Flatland
from spacevln.testing.scripted import subtask_of


def without_repeats(names: list[str]) -> list[str]:
    return [name for index, name in enumerate(names) if index == 0 or name != names[index - 1]]


def test_events_come_in_the_order_of_algorithm_1() -> None:
    done = run()
    stage = ["StepTaken", "LookedAround", "SubtaskIssued", "WaypointAdded"]
    decisions = ["DecisionMade", "StepTaken"]
    assert without_repeats(done.sink.names()) == [
        "EpisodeStarted",
        *stage,
        *decisions * 2,
        "StageEnded",
        *stage,
        *decisions * 2,
        "StageEnded",
        "StepTaken",
        "LookedAround",
        "GateAsked",
        "SubtaskIssued",
        "WaypointAdded",
        "StepTaken",
        "MapSaved",
        "EpisodeEnded",
    ]
    assert done.result.status is EpisodeStatus.STOPPED
    assert done.result.stop_reason is StopReason.GATE
    assert [subtask.next_anchor for subtask in done.result.subtasks] == [DOOR, BED, None]
    assert len(done.result.memory.hierarchical.waypoints) == 3


def test_the_end_reports_what_the_steps_were_for() -> None:
    done = run()
    (end,) = done.events(EpisodeEnded)
    steps = done.events(StepTaken)
    assert [step.step for step in steps] == list(range(1, len(steps) + 1))
    assert end.steps == len(steps) == done.result.steps
    assert end.lookaround_steps == sum(step.phase == "lookaround" for step in steps) == 36
    assert end.align_steps == sum(step.phase == "align" for step in steps)
    assert (steps[-1].action, steps[-1].phase, steps[-1].observation) == (Stop(), "stop", None)
    assert end.stopped
    assert end.stages == 3
    assert len(done.events(MapSaved)[0].floors) == 1


def test_a_look_around_is_one_turn_and_restores_the_heading() -> None:
    done = run(start=Pose(0.0, 0.0, 0.0, 0.4), queries=("sofa",))
    first = done.events(StepTaken)[:12]
    assert {(step.action, step.phase) for step in first} == {(TurnLeft(30.0), "lookaround")}
    assert first[-1].pose.yaw_rad == pytest.approx(0.0, abs=1e-9)
    views = done.events(LookedAround)[0].views
    assert [view.label for view in views[:4]] == ["front", "left 30", "left 60", "left 90"]
    assert [view.label for view in views[6:8]] == ["back", "right 150"]
    assert [math.degrees(view.heading_rad) % 360 for view in views] == pytest.approx(
        [30 * index for index in range(12)], abs=1e-6
    )
    bearings = [view.heading_rad + sighting.bearing_rad for view in views for sighting in view.sightings]
    sofa = Pose(0.0, 0.0, 0.0, 0.4).bearing_rad(-0.95, 1.4)
    assert bearings
    assert all(abs(math.remainder(bearing - sofa, math.tau)) < 0.7 for bearing in bearings)


def test_a_robot_looks_in_eight_directions() -> None:
    done = run(environment=Flatland(turn_deg=45.0), settings=AgentSettings(step_limit=20))
    assert [view.label for view in done.events(LookedAround)[0].views] == [
        "front", "left 45", "left 90", "left 135", "back", "right 135", "right 90", "right 45",
    ]  # fmt: skip


def test_the_body_turns_to_the_chosen_direction_before_the_first_query() -> None:
    done = run([subtask_of(CHAIN, 0, "right 60")], [Stop()], AgentSettings(step_limit=20))
    align = [step for step in done.events(StepTaken) if step.phase == "align"]
    assert [step.action for step in align] == [TurnRight(30.0)] * 2
    assert done.executor.contexts[0].observation.pose.yaw_rad == pytest.approx(-math.pi / 3)
    assert done.executor.contexts[0].progress.decisions == ()


def test_the_planner_gets_feedback_and_the_executor_its_situation() -> None:
    done = run()
    first, second = done.planner.contexts[:2]
    assert (first.feedback, first.last_subtask, first.stage) == (None, None, 0)
    assert second.feedback is not None
    assert second.feedback.end is StageEnd.ARRIVAL
    assert second.last_subtask == done.result.subtasks[0]
    assert second.feedback.pool[0].arrived
    assert second.memory is not None
    assert second.memory.chain == (0,)
    before = [step for step in done.events(StepTaken) if step.stage == 0 or (step.stage, step.phase) == (1, "lookaround")]
    assert second.steps_left == 260 - len(before)
    hand = done.executor.contexts[1]
    assert hand.subtask == done.result.subtasks[0]
    assert hand.progress.moved_m == pytest.approx(1.25)
    assert hand.decisions_left == 4
    assert hand.pool[0].category == "doorway"


def test_arrival_interrupts_a_decision() -> None:
    done = run()
    decision = done.events(StageEnded)[0].feedback.record.decisions[-1]
    assert decision.interrupted
    assert decision.primitives == 2
    assert decision.moved_m == pytest.approx(0.5)


def test_a_stall_interrupts_and_masks_forward_for_the_next_query() -> None:
    """A glass pane that depth does not show: the body meets what the map does not know."""
    done = run([subtask_of(CHAIN, 0)], [MoveForward(1.25), TurnLeft(), ahead], environment=Glass(0.5))
    decision: ExecutedDecision = done.events(StageEnded)[0].feedback.record.decisions[0]
    assert decision.stalled
    assert decision.interrupted
    assert decision.moved_m == pytest.approx(0.5, abs=0.01)
    masked, lifted = done.executor.contexts[1].admissible, done.executor.contexts[2].admissible
    assert masked.forward_m == ()
    assert "did not move" in masked.reasons[0]
    assert lifted.forward_m


def test_a_stage_has_five_decisions() -> None:
    step = [MoveForward(0.25)]
    done = run([subtask_of((SOFA, BED), 0)], step, AgentSettings(step_limit=40))
    first = done.events(StageEnded)[0].feedback
    assert first.end is StageEnd.STAGE_BUDGET
    assert len(first.record.decisions) == 5
    assert [event.decision for event in done.events(DecisionMade)[:5]] == [1, 2, 3, 4, 5]


def test_a_stall_after_three_turns_blocks_the_stage() -> None:
    done = run(
        [subtask_of(CHAIN, 0)],
        [TurnLeft(), TurnLeft(), TurnLeft(), MoveForward(0.25)],
        AgentSettings(step_limit=18),
        Glass(0.0),
    )
    feedback = done.events(StageEnded)[0].feedback
    assert feedback.end is StageEnd.BLOCKED
    assert [decision.stalled for decision in feedback.record.decisions] == [False, False, False, True]
    assert len(done.executor.contexts) == 4
    assert done.events(ReplyRefused) == []


def test_the_executors_stop_ends_the_stage_and_not_the_episode() -> None:
    done = run([by_feedback], [Stop()], AgentSettings(step_limit=40))
    assert done.events(StageEnded)[0].feedback.end is StageEnd.STOP
    assert len(done.events(StageEnded)) >= 2
    assert [step.phase for step in done.events(StepTaken)].count("stop") == 1


def test_a_stop_at_the_landmark_is_an_arrival_and_opens_the_gate() -> None:
    chain = (DOOR, SOFA)
    beside = Pose(-0.95, 0.3, 0.0, math.pi / 2)  # 0.7 m from the sofa
    done = run([subtask_of(chain, 0), subtask_of(chain, 1)], [Stop()], AgentSettings(step_limit=40), start=beside)
    feedback = done.events(StageEnded)[0].feedback
    assert (feedback.end, feedback.record.decisions) == (StageEnd.ARRIVAL, ())
    assert done.result.stop_reason is StopReason.GATE


def test_a_stage_acts_before_its_arrival_is_judged() -> None:
    chain = (DOOR, SOFA)
    beside = Pose(-0.95, 0.3, 0.0, math.pi / 2)
    done = run([subtask_of(chain, 0), subtask_of(chain, 1)], [TurnLeft()], AgentSettings(step_limit=40), start=beside)
    feedback = done.events(StageEnded)[0].feedback
    assert (feedback.end, len(feedback.record.decisions)) == (StageEnd.ARRIVAL, 1)


def test_an_inadmissible_action_is_asked_again_with_the_set() -> None:
    done = run([subtask_of(CHAIN, 0)], [MoveForward(0.3), ahead], AgentSettings(step_limit=16))
    (refused,) = done.events(ReplyRefused)
    assert (refused.role, refused.kind) == ("executor", "inadmissible")
    assert "forward 0.25" in refused.reason
    assert done.executor.contexts[1].rejections == (refused.reason,)
    assert done.executor.contexts[1].progress == done.executor.contexts[0].progress


@pytest.mark.parametrize("line", [MoveForward(7.0), ReplyRejected("parse", "no JSON."), ModelError("down")])
def test_a_hopeless_executor_hands_the_stage_back(line: object) -> None:
    done = run([subtask_of(CHAIN, 0)], [line], AgentSettings(step_limit=40))  # type: ignore[list-item]
    assert {event.feedback.end for event in done.events(StageEnded)} == {StageEnd.BLOCKED}
    fallbacks = done.events(FallbackUsed)
    assert fallbacks[0].kind == ("executor_failed" if isinstance(line, ModelError) else "executor_refused")
    asked = 1 if isinstance(line, ModelError) else 4
    assert len(done.executor.contexts) == asked * len(done.events(StageEnded))
    assert done.result.status is EpisodeStatus.STEP_LIMIT


def test_a_refused_plan_is_asked_again_with_the_reason() -> None:
    bad = subtask_of(CHAIN, 0, "image 3")
    done = run([bad, ReplyRejected("parse", "no JSON."), subtask_of(CHAIN, 0)], [Stop()], AgentSettings(step_limit=14))
    assert [(event.role, event.kind) for event in done.events(ReplyRefused)] == [("planner", "direction"), ("planner", "parse")]
    assert [len(context.rejections) for context in done.planner.contexts] == [0, 1, 2]
    assert done.planner.contexts[2].rejections[1] == "no JSON."
    assert len(done.events(SubtaskIssued)) == 1


def test_no_fallback_is_silent_be_its_reply_used_or_refused() -> None:
    plans = [
        ReplyRejected("wrong_type", "no number.", ("reply_prose",)),
        PlannerReply(subtask_of(CHAIN, 0, "image 3"), fallbacks=("reply_fenced",)),
        PlannerReply(subtask_of(CHAIN, 0), fallbacks=("loose_way",)),
    ]
    moves = [
        ReplyRejected("action", "no action.", ("reply_prose",)),
        ExecutorReply(MoveForward(7.0), fallbacks=("reply_fenced",)),
        ExecutorReply(Stop(), fallbacks=("straight_line",)),
    ]
    done = run(plans, moves, AgentSettings(step_limit=14))
    assert [(event.detail, event.kind) for event in done.events(FallbackUsed)] == [
        *(("planner", kind) for kind in ("reply_prose", "reply_fenced", "loose_way")),
        *(("executor", kind) for kind in ("reply_prose", "reply_fenced", "straight_line")),
    ]


def test_what_the_executor_saw_is_told_from_its_first_image_on() -> None:
    done = run([subtask_of(CHAIN, 0)], [Stop()], AgentSettings(step_limit=14), start=Pose(-0.9, 0.0))
    assert not any(isinstance(event, StepTaken) and event.phase == "align" for event in done.sink.events)
    (made,) = done.events(DecisionMade)
    assert made.sightings == done.executor.contexts[0].sightings
    assert [seen.category for seen in made.sightings] == ["doorway"]


def test_what_the_look_around_showed_of_the_landmark_is_remembered_from_the_stages_begin() -> None:
    subtasks, start = [subtask_of(CHAIN, 0)] * 2, Pose(-0.9, 0.0, 0.0, math.pi)
    done = run(subtasks, [Stop(), Stop()], AgentSettings(step_limit=28), start=start)
    (doorway,) = done.executor.contexts[1].pool  # the second look-around was asked for the first stage's landmark
    assert doorway.category == "doorway"
    assert not doorway.visible
    assert abs(doorway.bearing_rad) == pytest.approx(math.pi, abs=0.3)


@pytest.mark.parametrize("line", [subtask_of(CHAIN, 0, "image 3"), ReplyRejected("parse", "no JSON."), ModelError("gone")])
def test_a_hopeless_planner_ends_the_episode_in_a_controlled_way(line: object) -> None:
    done = run([line])  # type: ignore[list-item]
    assert done.result.status is EpisodeStatus.MODEL_FAILURE
    assert done.result.stop_reason is StopReason.MODEL
    assert done.result.stopped
    assert done.result.steps == 13
    assert len(done.planner.contexts) == (1 if isinstance(line, ModelError) else 4)
    assert done.result.detail


def test_a_premature_finish_is_refused_by_the_gate_and_told() -> None:
    early = subtask_of((SOFA, BED), 1)
    done = run([subtask_of((SOFA, BED), 0), early, subtask_of((SOFA, BED), 0)], [Stop()], AgentSettings(step_limit=40))
    asked = done.events(GateAsked)
    assert not asked[0].accepted
    assert ("landmark_arrival", False) in asked[0].clauses
    assert "landmark arrival" in done.planner.contexts[2].rejections[0]
    assert done.result.status is EpisodeStatus.STEP_LIMIT


def test_with_the_landmark_memory_off_its_clause_does_not_bind() -> None:
    settings = AgentSettings(Components(hsm=False, landmark_memory=False), step_limit=60)
    done = run([subtask_of((SOFA, BED), 0), subtask_of((SOFA, BED), 1)], [ahead], settings)
    assert done.events(GateAsked)[0].clauses == (("final_anchor_claimed", True), ("earlier_anchors_verified", True))
    assert done.result.stop_reason is StopReason.GATE
    assert all(context.pool == () for context in done.executor.contexts)
    assert all(context.memory is None for context in done.planner.contexts)
    assert done.events(WaypointAdded) == []


def test_without_landmark_memory_a_stage_arrives_by_the_executors_stop_only() -> None:
    settings = AgentSettings(Components(landmark_memory=False), step_limit=60)
    done = run([subtask_of(CHAIN, 0)], [ahead], settings)
    assert StageEnd.ARRIVAL not in {event.feedback.end for event in done.events(StageEnded)}


def test_without_stages_there_is_no_verification_and_no_feedback() -> None:
    settings = AgentSettings(Components(stagewise=False), step_limit=60)
    done = run([subtask_of(CHAIN, 0)], [ahead], settings)
    assert all(context.feedback is None and context.last_subtask is None for context in done.planner.contexts)
    assert StageEnd.ARRIVAL not in {event.feedback.end for event in done.events(StageEnded)}
    assert len(done.planner.contexts) >= 2


def test_staying_at_the_goal_ends_the_episode_unsaid() -> None:
    chain = (SOFA, replace(SOFA, cue="chair"))
    done = run([subtask_of(chain, 0, here=SOFA)], [Stop()])
    assert done.result.stop_reason is StopReason.STABLE_FINAL_ARRIVAL
    assert done.result.status is EpisodeStatus.STOPPED
    assert len(done.events(LookedAround)) == 3


def test_a_refined_chain_is_told() -> None:
    refined = (SOFA, replace(DOOR, cue="open doorway"), BED)
    done = run([subtask_of(CHAIN, 0), subtask_of(refined, 0)], [Stop()], AgentSettings(step_limit=28))
    assert [event.revision != "" for event in done.events(SubtaskIssued)] == [False, True]


def test_fallbacks_of_a_reply_become_events() -> None:
    reply = PlannerReply(subtask_of(CHAIN, 0), fallbacks=("planner_no_candidate",))
    done = run([reply], [Stop()], AgentSettings(step_limit=14))
    assert [event.kind for event in done.events(FallbackUsed)] == ["planner_no_candidate"]


def test_object_goals_have_their_own_budget() -> None:
    assert run(task=ObjectGoalTask("bed")).planner.contexts[0].steps_left == 280 - 12
