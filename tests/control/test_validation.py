"""Model-output validation: every rule accepts what it should and refuses what it should."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from spacevln.control import ControlSettings, chain_revision, validate_subtask
from spacevln.core import (
    Anchor,
    CueKind,
    InstructionTask,
    ObjectGoalTask,
    PlannerContext,
    PlannerReply,
    Pose,
    SpaceKind,
    Subtask,
    Task,
    View,
    egocentric_label,
)
from spacevln.testing.scripted import subtask_of

HALL = Anchor("hallway", SpaceKind.CONNECTOR)
KITCHEN = Anchor("kitchen", SpaceKind.ROOM, "kitchen island", CueKind.SOLID)
DOOR = Anchor("", SpaceKind.UNKNOWN, "glass door", CueKind.OPENING)
LIVING = Anchor("living room", SpaceKind.ROOM, "white sofa", CueKind.SOLID)
CHAIN = (HALL, KITCHEN, DOOR, LIVING)
VLN = InstructionTask("Go.")


def views(obstacle_m: float = 3.0, **special: float) -> tuple[View, ...]:
    made = []
    for index in range(12):
        heading = np.deg2rad(30.0 * index)
        label = egocentric_label(heading)
        made.append(View(label, heading, np.zeros((2, 2, 3), np.uint8), special.get(label.replace(" ", "_"), obstacle_m)))
    return tuple(made)


def context(
    task: Task = VLN, stage: int = 1, last: Subtask | None = None, seen: tuple[View, ...] | None = None
) -> PlannerContext:
    return PlannerContext(
        task=task,
        stage=stage,
        views=views() if seen is None else seen,
        memory=None,
        feedback=None,
        last_subtask=last,
        pose=Pose(0, 0),
        space=None,  # type: ignore[arg-type]  # no rule asks it
        steps_left=200,
    )


def kinds(subtask: Subtask, at: PlannerContext | None = None) -> list[str]:
    return [rejection.kind for rejection in validate_subtask(PlannerReply(subtask), at or context(), ControlSettings())]


@pytest.mark.parametrize("current", [-1, 0, 1, 2, 3])
def test_consistent_subtasks_are_accepted(current: int) -> None:
    assert kinds(subtask_of(CHAIN, current)) == []


def test_direction_must_be_one_of_the_views() -> None:
    rejections = validate_subtask(PlannerReply(subtask_of(CHAIN, 0, "image 5")), context(), ControlSettings())
    assert [rejection.kind for rejection in rejections] == ["direction"]
    assert "'image 5'" in rejections[0].reason
    assert "left 30" in rejections[0].reason


def test_direction_must_be_traversable() -> None:
    seen = views(left_30=0.49, right_30=0.5)
    assert kinds(subtask_of(CHAIN, 0, "left 30"), context(seen=seen)) == ["not_traversable"]
    assert kinds(subtask_of(CHAIN, 0, "right 30"), context(seen=seen)) == []


def test_any_direction_serves_when_none_is_traversable() -> None:
    assert kinds(subtask_of(CHAIN, 0, "left 30"), context(seen=views(0.3))) == []


def test_a_finished_task_needs_no_direction() -> None:
    assert kinds(subtask_of(CHAIN, 3, "")) == []


def test_chain_may_not_be_empty_and_current_anchor_lies_in_it() -> None:
    good = subtask_of(CHAIN, 0)
    assert kinds(replace(good, chain=())) == ["chain"]
    assert kinds(replace(good, current_index=4)) == ["chain"]
    assert kinds(replace(good, current_index=-2)) == ["chain"]


def test_next_anchor_is_the_immediate_successor() -> None:
    good = subtask_of(CHAIN, 0)
    assert kinds(replace(good, next_anchor=DOOR)) == ["next_anchor"]
    assert kinds(replace(good, next_anchor=replace(KITCHEN, space="Kitchen", space_kind=SpaceKind.UNKNOWN))) == []


def test_next_anchor_is_absent_exactly_when_complete() -> None:
    assert kinds(replace(subtask_of(CHAIN, 0), next_anchor=None)) == ["completion"]
    assert kinds(replace(subtask_of(CHAIN, 3), next_anchor=LIVING)) == ["completion"]


def test_complete_exactly_at_the_last_anchor() -> None:
    assert kinds(replace(subtask_of(CHAIN, 2), complete=True, next_anchor=None)) == ["completion"]
    assert kinds(replace(subtask_of(CHAIN, 3), complete=False)) == ["completion"]


def test_never_finished_at_the_first_call() -> None:
    assert kinds(subtask_of(CHAIN, 3), context(stage=0)) == ["first_finish"]


def test_verified_anchors_keep_their_place() -> None:
    last = subtask_of(CHAIN, 1)
    assert kinds(subtask_of((KITCHEN, HALL, LIVING), 1), context(last=last)) == ["verified_moved"]
    assert kinds(subtask_of(CHAIN[:1], 0), context(last=last)) == ["verified_moved"]
    assert kinds(subtask_of(CHAIN, 0), context(last=last)) == ["verified_lost"]


def test_unverified_anchors_may_be_refined_and_that_is_told() -> None:
    last = subtask_of(CHAIN, 1)
    refined = subtask_of((HALL, KITCHEN, LIVING), 1)
    assert kinds(refined, context(last=last)) == []
    assert "white sofa" in chain_revision(refined, last)
    assert chain_revision(subtask_of(CHAIN, 2), last) == ""
    assert chain_revision(refined, None) == ""


def test_of_an_object_goal_only_the_final_anchor_is_fixed() -> None:
    task = ObjectGoalTask("sofa")
    last = subtask_of(CHAIN, 2)
    assert kinds(subtask_of((DOOR, LIVING), 0), context(task, last=last)) == []
    assert kinds(subtask_of((DOOR, KITCHEN), 0), context(task, last=last)) == ["goal_changed"]


@pytest.mark.parametrize("space", ["unknown", "N/A", "<room>", "the room", "an area", "space", "unknown bedroom", "none"])
def test_placeholders_are_refused(space: str) -> None:
    hollow = Anchor(space, SpaceKind.ROOM)
    assert set(kinds(subtask_of((HALL, hollow, LIVING), 0, here=HALL))) == {"placeholder"}


def test_empty_anchors_are_refused_but_the_present_place_may_be_nameless() -> None:
    nameless = Anchor("", SpaceKind.UNKNOWN)
    assert kinds(subtask_of((HALL, nameless, LIVING), 0)) == ["placeholder"]
    assert kinds(subtask_of(CHAIN, 0, here=nameless)) == []
    assert kinds(subtask_of(CHAIN, 0, here=Anchor("unknown", SpaceKind.UNKNOWN))) == ["placeholder"]


def test_a_bare_room_with_a_cue_is_grounded() -> None:
    assert kinds(subtask_of((HALL, Anchor("room", SpaceKind.ROOM, "white sofa", CueKind.SOLID)), 0)) == []


def test_instruction_and_landmark() -> None:
    good = subtask_of(CHAIN, 0)
    assert kinds(replace(good, instruction=" ")) == ["instruction"]
    assert kinds(replace(good, instruction="Go to <landmark>.")) == ["placeholder"]
    assert kinds(replace(good, instruction="Explore the unknown part, none of the doors.")) == []
    assert kinds(replace(good, landmark="")) == ["landmark"]
    assert kinds(replace(good, landmark="unknown")) == ["placeholder"]


def test_every_fault_is_named_at_once() -> None:
    bad = replace(subtask_of(CHAIN, 0, "up"), instruction="", landmark="")
    assert kinds(bad) == ["direction", "instruction", "landmark"]
