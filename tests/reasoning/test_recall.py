"""What the rules take from a loaded memory at the first boundary."""

from __future__ import annotations

from dataclasses import replace

from plain_space import PlainSpace, context, seen

from spacevln.core import ArrangedWaypoint, LandmarkCue, Mark, ObjectGoalTask, PlannerContext, Pose, SpatialWaypoint
from spacevln.perception.matching import Match
from spacevln.reasoning.rules.instances import instances
from spacevln.reasoning.rules.state import EpisodeState

SPACE = PlainSpace([(-2, -2, 2, 2), (2, -0.5, 2.2, 0.5), (2.2, -2, 6, 2)])
START, BEYOND = Pose(0.0, 0.0), Pose(4.0, 0.0)
CUES = (
    LandmarkCue("teapot", ("blue",), (5.0, 1.0, 0.8), 0.9, 1.4, 0.2),
    LandmarkCue("doorway", (), (2.1, 0.0, 1.0), 0.9, 1.9, 1.0, is_passage=True),
    LandmarkCue("what the planner named"),
)


def boundary(mark: str, pose: Pose = START) -> PlannerContext:
    plain = context(ObjectGoalTask("teapot"), pose, SPACE, [seen("sofa", -1.0, 1.0, pose)])
    assert plain.memory is not None
    waypoint = SpatialWaypoint(0, BEYOND, 0, "kitchen", CUES, "kitchen")
    known = ArrangedWaypoint(waypoint, (), 0.0, 4.0, (0,), (mark,), 0)
    return replace(plain, memory=replace(plain.memory, waypoints=(known,)))


def test_things_seen_in_an_earlier_episode_are_known_with_their_place() -> None:
    state = EpisodeState()
    world = state.observe(boundary(Mark.EARLIER))
    (teapot,) = instances(world, "teapot", Match.NAME)
    assert (teapot.xy, teapot.attributes, teapot.seen_from) == ((5.0, 1.0), ("blue",), (4.0, 0.0))
    assert [thing.category for thing in world.sightings.things] == ["teapot", "sofa"]
    assert world.sightings.portals == []
    assert state.visited == [(0, (0.0, 0.0))], "where an earlier episode stood was not tried for this goal"
    assert state.levels == {0: 0.0}


def test_a_memory_is_taken_in_once() -> None:
    state = EpisodeState()
    state.observe(boundary(Mark.EARLIER))
    weights = [thing.weight for thing in state.sightings.things if thing.category == "teapot"]
    state.observe(boundary(Mark.EARLIER, Pose(0.5, 0.0)))
    assert [thing.weight for thing in state.sightings.things if thing.category == "teapot"] == weights


def test_what_this_episode_saw_is_not_recalled_from_its_waypoints() -> None:
    state = EpisodeState()
    world = state.observe(boundary(Mark.FIRST))
    assert [thing.category for thing in world.sightings.things] == ["sofa"]
    assert state.visited == [(0, (0.0, 0.0))]
