"""The search for an object: names, chances, where to stand, and when it is found."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import ArrayLike
from plain_space import PlainSpace, context, seen

from spacevln.core import Feedback, Frontier, Glimpse, ObjectGoalTask, PlannerReply, Pose, Sighting, StageEnd, StageRecord
from spacevln.language import FREE_FLOOR_M2, LOWER_STOREY, ROOM_SHARES, chance_in_room
from spacevln.language.object_rooms import OBJECT_ROOMS, OPENS_ON
from spacevln.perception.matching import Match, match
from spacevln.reasoning.rules import RulePlanner
from spacevln.reasoning.rules.beliefs import Beliefs
from spacevln.reasoning.rules.instances import WITHIN_M, instances, obstacle_between, standing_place
from spacevln.reasoning.rules.state import EpisodeState
from spacevln.reasoning.rules.world import World

# a dining room; a doorway east leads to a room with a toilet in it, one north to a room of which nothing is known
ROOMS = PlainSpace([(-2, -2, 2, 2), (2, -0.5, 2.2, 0.5), (2.2, -2, 6, 2), (-0.5, 2, 0.5, 2.2), (-2, 2.2, 2, 5)])
START = Pose(0.0, 0.0, 0.0, 0.0)
SEEN = (("dining table", -1.5, 1.0), ("dining chair", -1.5, 0.2), ("toilet", 5.5, 1.0), ("bathtub", 5.5, -1.0))


def sightings(pose: Pose, *more: tuple[str, float, float]) -> list[Sighting]:
    doors = [seen("doorway", 2.1, 0.0, pose, width_m=1.0), seen("doorway", 0.0, 2.1, pose, width_m=1.0, along_rad=0.0)]
    return [*doors, *(seen(name, x, y, pose) for name, x, y in (*SEEN, *more))]


def plan(goal: str, *more: tuple[str, float, float], pose: Pose = START, **settings: object) -> PlannerReply:
    boundary = context(ObjectGoalTask(goal), pose, ROOMS, sightings(pose, *more), **settings)  # type: ignore[arg-type]
    return RulePlanner().plan(boundary)


def world() -> World:
    return EpisodeState().observe(context(ObjectGoalTask("sofa"), START, ROOMS, sightings(START)))


@pytest.mark.parametrize(
    ("goal", "name", "expected"),
    [
        ("tv", "television", Match.NAME),
        ("couch", "sofa", Match.NAME),
        ("wall cabinet", "wall cabinet", Match.NAME),
        ("cabinet", "wall cabinet", Match.KIND),
        ("cabinet", "filing cabinet", Match.KIND),
        ("table", "dining table", Match.KIND),
        ("dining table", "coffee table", None),
        ("sofa", "bed", None),
    ],
)
def test_a_goal_is_found_by_its_name_and_a_mere_kind_of_it_is_told_apart(goal: str, name: str, expected: Match | None) -> None:
    assert match(goal, name, ()) == expected


def test_rooms_of_the_tables_are_known_types_and_chances_are_chances() -> None:
    assert sum(ROOM_SHARES.values()) == pytest.approx(1.0, abs=0.03)
    assert set(OPENS_ON) <= set(ROOM_SHARES) == set(FREE_FLOOR_M2) == set(LOWER_STOREY)
    assert {room for rooms in OPENS_ON.values() for room in rooms} <= set(ROOM_SHARES)
    assert all(0 < chance <= 1 for rooms in OBJECT_ROOMS.values() for chance in rooms.values())
    assert chance_in_room("couch", "living room") > 0.8 > 0.1 > chance_in_room("couch", "bathroom") > 0
    assert chance_in_room("grandfather paradox", "kitchen") == 0.15


def test_what_is_seen_of_a_room_changes_what_it_may_hold() -> None:
    known = world()
    bathroom, unseen = known.room_at(0, (4.0, 0.0)), known.room_at(0, (0.0, 3.5))
    dining = known.room_at(0, (0.0, 0.0))
    stove, toilet = Beliefs(known, "stove"), Beliefs(known, "toilet")
    assert max(stove.types(bathroom), key=lambda name: stove.types(bathroom)[name]) == "bathroom"
    assert toilet.holds(bathroom) > 0.9 > toilet.holds(unseen)
    assert stove.holds(bathroom) < 0.1 < stove.holds(unseen, dining)
    assert stove.holds(unseen, dining) > stove.holds(unseen)  # dining rooms open on kitchens
    assert 0 <= stove.leads_on(bathroom) < stove.leads_on(unseen, dining) <= 1
    assert 0 < stove.on_another_storey() < 1


def test_one_cooks_below_and_sleeps_above() -> None:
    def chances(leads: set[str], goal: str) -> tuple[float, float]:
        home = world()
        home.leads_from = lambda _: leads  # type: ignore[method-assign]
        beliefs = Beliefs(home, goal)
        return beliefs.on_another_storey(), beliefs.holds(0)

    upstairs, downstairs = chances({"down"}, "stove"), chances({"up"}, "stove")
    assert upstairs[0] > 2 * downstairs[0]
    assert upstairs[1] < downstairs[1] / 2
    assert chances({"up"}, "bed")[0] > chances({"down"}, "bed")[0]
    assert chances(set(), "stove") == chances({"up", "down"}, "stove")


def test_the_search_goes_where_the_object_may_be() -> None:
    stove = plan("stove").subtask
    assert stove.target_m is not None
    assert stove.target_m[1] > 2.5  # not to the bathroom
    assert not stove.targets_final_anchor


def test_another_kind_is_no_goal_while_there_are_steps_to_look_on() -> None:
    assert not plan("cabinet", ("wall cabinet", 1.5, -1.9)).subtask.targets_final_anchor
    assert plan("cabinet", ("wall cabinet", 1.5, -1.9), steps_left=50).subtask.targets_final_anchor
    assert plan("wall cabinet", ("wall cabinet", 1.5, -1.9)).subtask.targets_final_anchor


@pytest.mark.parametrize(("x", "complete"), [(0.6, True), (1.2, False)])
def test_it_is_found_when_it_is_in_view_within_reach(x: float, complete: bool) -> None:
    first = plan("lamp", ("lamp", x, 0.0)).subtask
    feedback = Feedback(first, StageRecord(START), (), StageEnd.STAGE_BUDGET)
    assert plan("lamp", ("lamp", x, 0.0), stage=1, feedback=feedback, last_subtask=first).subtask.complete == complete


def test_a_refused_finish_leads_to_another_place_before_the_goal() -> None:
    planner, lamp = RulePlanner(), ("lamp", 1.9, -1.0)
    task = ObjectGoalTask("lamp")
    first = planner.plan(context(task, START, ROOMS, sightings(START, lamp))).subtask
    assert first.target_m is not None
    there = Pose(first.target_m[0], first.target_m[1], 0.0, 0.0)
    feedback = Feedback(first, StageRecord(START), (), StageEnd.ARRIVAL)
    boundary = context(task, there, ROOMS, sightings(there, lamp), stage=1, feedback=feedback, last_subtask=first)
    assert planner.plan(boundary).subtask.complete
    refused = context(
        task, there, ROOMS, sightings(there, lamp), stage=1, feedback=feedback, last_subtask=first, rejections=("no evidence",)
    )
    again = planner.plan(refused).subtask
    assert not again.complete
    assert again.target_m is not None
    assert there.distance_m(*again.target_m[:2]) > 0.25


def edge(x: float, y: float) -> Frontier:
    return Frontier((x, y), math.hypot(x, y), math.atan2(y, x), 1.0)


def test_what_furniture_hides_the_floor_of_is_approached_by_the_nearest_edge_of_the_known_floor() -> None:
    hidden = seen("lamp", 6.0, 4.5, START)  # seen over a bed, say; no floor is known within two metres of it
    boundary = context(ObjectGoalTask("lamp"), START, ROOMS, [*sightings(START), hidden], (edge(5.8, 1.9), edge(-1.9, -1.9)))
    state = EpisodeState()
    world = state.observe(boundary)
    (lamp,) = instances(world, "lamp", Match.NAME)
    first = standing_place(boundary, world, lamp, state)
    assert first is not None
    state.failures.append((0, first))
    assert standing_place(boundary, world, lamp, state) == (5.8, 1.9)


def test_a_place_farther_off_than_the_goals_reach_is_no_place_to_stand() -> None:
    boundary = context(ObjectGoalTask("lamp"), START, ROOMS, [*sightings(START), seen("lamp", 1.0, -1.0, START)])
    state = EpisodeState()
    world = state.observe(boundary)
    (lamp,) = instances(world, "lamp", Match.NAME)
    state.visited += [
        (0, (1.0 + 0.65 * math.cos(0.5 * k), -1.0 + 0.65 * math.sin(0.5 * k))) for k in range(13)
    ]  # stood all around
    place = standing_place(boundary, world, lamp, state)
    assert place is not None
    assert float(lamp.distance_m(np.array([place]))[0]) <= WITHIN_M


class Winding(PlainSpace):
    """Rooms whose ways are three times the straight line, as around beds."""

    def geodesic_m(self, a_xy_m: ArrayLike, b_xy_m: ArrayLike) -> float:
        return 3.0 * super().geodesic_m(a_xy_m, b_xy_m)


def test_what_was_seen_over_furniture_is_reached_around_it_but_not_through_a_wall() -> None:
    space = Winding(ROOMS.free)
    lamp_seen = seen("lamp", 3.0, -1.0, START)  # near the wall between the rooms, in the far one
    boundary = context(ObjectGoalTask("lamp"), START, space, [*sightings(START), lamp_seen])
    state = EpisodeState()
    world = state.observe(boundary)
    (lamp,) = instances(world, "lamp", Match.NAME)
    place = standing_place(boundary, world, lamp, state)
    assert place is not None
    assert place[0] > 2.2
    assert float(lamp.distance_m(np.array([place]))[0]) <= WITHIN_M
    assert obstacle_between(boundary, (1.8, -1.0), (2.8, -1.0))
    assert not obstacle_between(boundary, place, (2.8, -1.0))


@pytest.mark.parametrize(("target", "vain"), [((-1.0, 0.0), 0), ((0.6, 0.0), 1)])
def test_only_stages_that_stood_before_a_thing_were_in_vain(target: tuple[float, float], vain: int) -> None:
    lamp_seen = seen("lamp", 1.5, 0.0, START)
    state = EpisodeState()
    world = state.observe(context(ObjectGoalTask("lamp"), START, ROOMS, [*sightings(START), lamp_seen]))
    (lamp,) = instances(world, "lamp", Match.NAME)
    subtask = plan("lamp", ("lamp", 1.5, 0.0)).subtask
    state.sought, state.target, state.target_way_m = lamp.id, (0, target), 1.0
    feedback = Feedback(subtask, StageRecord(START), (), StageEnd.STOP)
    there = Pose(*target, 0.0, 0.0)
    assert state.judge_last_stage(
        context(ObjectGoalTask("lamp"), there, ROOMS, [], stage=1, feedback=feedback, last_subtask=subtask), 0
    )
    assert state.vain.get(lamp.id, 0) == vain


def test_what_the_images_on_the_way_showed_is_known_at_the_next_boundary() -> None:
    planner, task = RulePlanner(), ObjectGoalTask("lamp")
    first = planner.plan(context(task, START, ROOMS, sightings(START))).subtask
    assert not first.targets_final_anchor
    on_the_way, there = Pose(3.0, 0.0, 0.0, 0.0), Pose(2.6, 0.0, 0.0, math.pi)
    upstairs = Pose(3.0, 0.0, 2.8, 0.0)
    lamp = Glimpse(on_the_way, (seen("lamp", 4.5, 0.0, on_the_way),))
    elsewhere = Glimpse(upstairs, (seen("lamp", 4.5, 0.0, upstairs),))
    for glimpses, known in (((lamp,), True), ((elsewhere,), False), ((), False)):
        feedback = Feedback(first, StageRecord(START), (), StageEnd.STAGE_BUDGET, glimpses)
        fresh = RulePlanner()
        fresh.plan(context(task, START, ROOMS, sightings(START)))
        boundary = context(task, there, ROOMS, [], stage=1, feedback=feedback, last_subtask=first)
        assert fresh.plan(boundary).subtask.targets_final_anchor == known
