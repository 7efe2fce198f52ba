import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_house import DOORS, WALK, door, house, remembered, seen_from, thing
from drawn_map import DrawnMap
from hypothesis import given, settings
from hypothesis import strategies as st

from spacevln.core import Anchor, CueKind, Frontier, Mark, Pose, SpaceKind
from spacevln.memory import EdgeKind, HierarchicalSpatialMemory, MemoryMap, SpatialCognitiveMemory

MAP = house()
MEMORY = remembered(MAP)
HERE = Pose(12.0, 2.5, 0.0, 2.5)
W = MEMORY.hierarchical

TEXT = """\
Here: living room 1
Waypoints around you (direction, way):
w2 hallway 1: doorway | left 30 | 4.0 m
w3 kitchen 1: wooden dining table, stove, doorway | left 30 | 5.9 m via w4
w1 hallway 1: doorway | left 30 | 7.0 m via w2
w0 bedroom 1 [first]: blue bed, nightstand, doorway | left 30 | 9.2 m via w2, w1
w5 living room 1: white sofa, bookshelf, doorway | left 60 | 1.0 m
w4 hallway 1: doorway | left 60 | 2.9 m
w6 living room 1 [previous]: bookshelf, white sofa, doorway | right 90 | 0.9 m
Spaces: bedroom 1 (w0) next to hallway 1; hallway 1 (w1 w2 w4) next to bedroom 1, kitchen 1, living room 1; \
kitchen 1 (w3) next to hallway 1; living room 1 (w5 w6) next to hallway 1
Walked so far: w0 bedroom 1 > 2.2 m > w1 hallway 1 > 3.0 m > w2 > left 120, 2.0 m > w3 kitchen 1 > right 120, 2.8 m > \
w4 hallway 1 > 1.8 m > w5 living room 1 > left 30, 1.8 m > w6 > right 150, 0.9 m > here"""


def test_the_drawn_map_is_a_memory_map() -> None:
    metric_map: MemoryMap = MAP
    assert metric_map.floor == 0


def test_waypoints_are_parsed_from_the_planner_s_anchor() -> None:
    waypoint = W.waypoints[5]
    assert waypoint.region == "living room"
    assert waypoint.text == "living room - white sofa"
    assert waypoint.cues[0].category == "sofa"
    assert waypoint.cues[0].position_m == (13.5, 1, 0.5)
    assert W.waypoints[2].region == "hallway"  # "corridor"
    typed = HierarchicalSpatialMemory().add(Pose(3, 3), 0, Anchor("den", SpaceKind.ROOM, "globe", CueKind.SOLID), [], MAP)
    assert typed.region == "office"
    assert typed.cues[0].category == "globe"
    assert typed.cues[0].position_m is None


def test_an_unknown_region_text_is_kept() -> None:
    waypoint = HierarchicalSpatialMemory().add(Pose(3, 3), 0, "Winter Garden Annex - fern", [], MAP)
    assert waypoint.region == "winter garden annex"


def test_the_chain_keeps_every_visit_in_order() -> None:
    assert W.chain == (0, 1, 2, 3, 4, 5, 6)
    chain = [(edge.a, edge.b) for edge in W.graph.edges if edge.kind is EdgeKind.CHAIN]
    assert chain == [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6)]


def test_regions_group_what_is_one_space_and_doorways_part_what_is_two() -> None:
    assert [(region.label, region.waypoints) for region in W.regions.all] == [
        ("bedroom 1", (0,)),
        ("hallway 1", (1, 2, 4)),
        ("kitchen 1", (3,)),
        ("living room 1", (5, 6)),
    ]
    walk = tuple((pose, "bedroom") for pose, _ in WALK)  # all of one type: only thresholds part them
    regions = remembered(house(), walk).hierarchical.regions.all
    assert [region.waypoints for region in regions] == [(0,), (1, 2, 4), (3,), (5, 6)]
    assert [region.label for region in regions] == ["bedroom 1", "bedroom 2", "bedroom 3", "bedroom 4"]


def test_rooms_whose_floors_meet_outside_their_doors_stay_two() -> None:
    """One door was seen in part, its neighbour not at all: both floors run on into the hallway."""
    plan = DrawnMap([(0, 0, 4, 3), (0, 3.3, 4, 6.3), (4.1, 0, 5.3, 6.3), (3.9, 2.0, 4.3, 2.9), (3.9, 3.4, 4.3, 4.3)])
    part = door((4.05, 2.35), (4.05, 2.9))
    for seen, spaces in (([part, part], [(0,), (1,)]), ([], [(0, 1)])):
        memory = SpatialCognitiveMemory()
        memory.add_waypoint(Pose(3.4, 2.5), "bedroom", seen, plan)
        memory.add_waypoint(Pose(3.4, 3.9), "bedroom", seen, plan)
        regions = memory.hierarchical.regions
        shared = np.intersect1d(regions.support_of(0), regions.support_of(1))
        assert len(shared) > 0.1 * min(len(regions.support_of(0)), len(regions.support_of(1)))
        assert [region.waypoints for region in regions.all] == spaces


def test_a_support_ends_at_walls_and_thresholds() -> None:
    for x, y, label in ((2, 3, "bedroom 1"), (8, 2, "hallway 1"), (7, 3.5, "kitchen 1"), (12.5, 1.5, "living room 1")):
        region = W.region_at(Pose(x, y), 0)
        assert region is not None
        assert region.label == label
    assert W.region_at(Pose(2, 3), 1) is None
    assert W.region_at(Pose(40, 3), 0) is None


def test_region_neighbours_are_those_next_door() -> None:
    hallway = W.regions.all[1]
    assert [region.label for region in W.region_neighbours(hallway)] == ["bedroom 1", "kitchen 1", "living room 1"]
    assert [region.label for region in W.region_neighbours(W.regions.all[0])] == ["hallway 1"]


def test_what_is_seen_through_a_doorway_is_no_cue_of_this_space() -> None:
    hallway = W.waypoints[1]  # the bed is 4.2 m away, the table 3.3 m, both behind doorways
    assert {cue.category for cue in hallway.cues} == {"doorway"}
    assert len([cue for cue in hallway.cues if cue.is_passage]) == 3


def test_arranged_around_the_agent_with_marks_and_ways() -> None:
    arranged = MEMORY.egocentric(HERE, MAP).waypoints
    by_index = {item.waypoint.index: item for item in arranged}
    assert by_index[0].marks == (Mark.FIRST,)
    assert by_index[6].marks == (Mark.PREVIOUS,)
    assert by_index[0].path[-1] == 0
    assert len(by_index[0].path) == 3
    for item in arranged:
        at = item.waypoint.pose
        assert item.geodesic_m == pytest.approx(MAP.geodesic_m(HERE.xy_m, at.xy_m), abs=1e-6)
        assert item.bearing_rad == pytest.approx(HERE.bearing_rad(at.x_m, at.y_m))
        for one, two in zip(item.path, item.path[1:], strict=False):
            assert two in W.graph.neighbours(one)


def test_overlapping_waypoints_are_shown_once_and_never_forgotten() -> None:
    metric_map = house()
    memory = remembered(metric_map, (*WALK, (Pose(11.3, 2.4), "living room"), (Pose(3, 2.8), "bedroom")))
    arranged = memory.egocentric(HERE, metric_map).waypoints
    shown = {item.waypoint.index: item for item in arranged}
    assert shown[7].merged == (5,)
    assert shown[7].visits == 2
    assert shown[8].merged == (0,)
    assert shown[8].marks == (Mark.FIRST, Mark.PREVIOUS, Mark.VISITED)
    assert sorted(index for item in arranged for index in (*item.merged, item.waypoint.index)) == list(range(9))
    assert memory.hierarchical.chain == tuple(range(9))


def test_the_text_is_this_text() -> None:
    assert MEMORY.egocentric(HERE, MAP).text == TEXT


def test_the_same_state_has_the_same_bytes() -> None:
    again = remembered(house()).egocentric(HERE, MAP)
    assert again.text == TEXT
    assert np.array_equal(again.map_image, MEMORY.egocentric(HERE, MAP).map_image)


@settings(max_examples=5, deadline=None)
@given(st.randoms(use_true_random=False))
def test_the_order_of_sightings_does_not_matter(random: object) -> None:
    memory, metric_map, previous = SpatialCognitiveMemory(), house(), None
    for pose, anchor in WALK:
        if previous is not None:
            metric_map.walk(previous, pose)
        sightings = seen_from(pose, metric_map)
        random.shuffle(sightings)  # type: ignore[attr-defined]
        memory.add_waypoint(pose, anchor, sightings, metric_map)
        previous = pose
    assert memory.egocentric(HERE, metric_map).text == TEXT


@settings(max_examples=10, deadline=None)
@given(st.permutations(range(1, 7)))
def test_edges_and_regions_do_not_depend_on_the_order_of_visits(order: list[int]) -> None:
    walk = tuple(WALK[k] for k in (0, *order))
    memory = remembered(house(), walk).hierarchical
    number = dict(enumerate((0, *order)))
    edges = {frozenset((number[e.a], number[e.b])) for e in memory.graph.edges if e.kind is EdgeKind.MAP}
    assert edges == {frozenset((e.a, e.b)) for e in W.graph.edges if e.kind is EdgeKind.MAP}
    groups = {frozenset(number[index] for index in region.waypoints) for region in memory.regions.all}
    assert groups == {frozenset(region.waypoints) for region in W.regions.all}


def test_an_empty_memory_can_be_told_too() -> None:
    told = SpatialCognitiveMemory().egocentric(Pose(3, 3), MAP)
    assert told.text == "Here: a space not named yet"
    assert told.waypoints == told.chain == ()
    assert told.region == ""


def test_frontiers_are_told_nearest_first_and_narrow_ones_and_blind_spots_not() -> None:
    class Bordered(DrawnMap):
        def frontiers(self, pose: Pose) -> tuple[Frontier, ...]:  # noqa: ARG002
            return (
                Frontier((3, 3), 0.1, -0.5, 1.0),
                Frontier((1, 1), 1.0, 0.5, 0.2),
                Frontier((2, 2), 2.04, 0.5, 1.0),
                Frontier((3, 2), math.inf, 0.5, 1.0),
                Frontier((4, 2), 5.0, math.pi, 1.0),
            )

    told = SpatialCognitiveMemory().egocentric(Pose(3, 3), Bordered([(0, 0, 4, 4)]))
    assert told.text.splitlines()[-1] == "Unexplored beyond: left 30 2.0 m; back 5.0 m"


def test_two_floors_are_joined_by_the_chain_and_never_mixed() -> None:
    lower, upper = house(), house(floor=1)
    memory = remembered(lower)
    stairs = np.array([[13.0, 3.4, 0], [14.0, 3.4, 0], [14.0, 4.4, 1]])
    upper.travelled = np.vstack([lower.travelled, stairs])
    memory.add_waypoint(Pose(14.0, 4.5, 2.8, 0.0), "bedroom", [], upper)
    hierarchical = memory.hierarchical
    (transition,) = hierarchical.floor_transitions
    assert (transition.a, transition.b) == (6, 7)
    assert transition.length_m > 2.0
    assert hierarchical.floors == (0, 1)
    assert hierarchical.regions.of(7).label == "bedroom 2"
    told = memory.egocentric(Pose(13.5, 4.0, 2.8, 0.0), upper)
    assert told.floor == 1
    assert told.waypoints[0].waypoint.index == 7
    below = next(item for item in told.waypoints if item.waypoint.index == 6)
    assert below.path == (7, 6)
    assert math.isfinite(below.geodesic_m)
    lines = told.text.splitlines()
    assert lines[0] == "Here: bedroom 2, floor 1"
    assert any(line.startswith("w6 living room 1") and "floor 0" in line for line in lines)
    assert "stairs up > w7 bedroom 2" in lines[-1]


def test_a_threshold_is_known_from_its_nearest_view() -> None:
    memory = HierarchicalSpatialMemory()
    memory.thresholds.add([door((4.0, 1.6), (4.0, 2.5), distance_m=4.0)], 0)
    memory.thresholds.add([door((4.05, 1.6), (4.05, 2.5), distance_m=1.0), *DOORS[1:]], 0)
    memory.thresholds.add([door((4.2, 1.6), (4.2, 2.5), distance_m=3.0), *DOORS[1:]], 0)
    memory.thresholds.add([thing("doorway", 1, 1), replace(DOORS[0], is_passage=False)], 0)
    assert [threshold.a_m for threshold in memory.thresholds.on(0)] == [(4.05, 1.6), (6.5, 2.75), (10.05, 1.5)]
    assert memory.thresholds.on(0)[0].views == 3
    assert memory.thresholds.on(1) == ()


def test_a_threshold_is_believed_when_two_views_agree_and_no_narrower_one_shares_its_jamb() -> None:
    thresholds = HierarchicalSpatialMemory().thresholds
    narrow, wide = door((4.0, 1.6), (4.0, 2.5)), door((4.0, 1.6), (4.2, 4.5))
    thresholds.add([wide, wide, narrow], 0)
    assert [threshold.b_m for threshold in thresholds.on(0)] == [(4.2, 4.5)]
    thresholds.add([narrow], 0)
    assert [threshold.b_m for threshold in thresholds.on(0)] == [(4.0, 2.5)]
    assert len(thresholds.believed(0)) == 1
    assert len(list(thresholds)) == 2


def test_the_rendered_map_is_agent_centred_heading_up_with_region_colours() -> None:
    image = MEMORY.egocentric(HERE, MAP).map_image
    assert image.shape == (480, 440, 3)
    assert image.dtype == np.uint8
    red = (image[:440, :, 0] > 200) & (image[:440, :, 1] < 60) & (image[:440, :, 2] < 60)
    rows, columns = np.nonzero(red)
    assert rows.mean() == pytest.approx(220, abs=6)
    assert columns.mean() == pytest.approx(220, abs=3)
    facing_east = MEMORY.egocentric(replace(HERE, yaw_rad=0.0), MAP).map_image
    facing_west = MEMORY.egocentric(replace(HERE, yaw_rad=math.pi), MAP).map_image
    grey = np.array([238, 239, 243])
    unknown = [(np.abs(part.astype(int) - grey) < 3).all(axis=-1).mean() for part in (facing_east[:180], facing_west[:180])]
    assert unknown[0] > unknown[1] + 0.1  # the house lies to the west of the living room


def test_places_without_a_name_are_numbered_by_themselves() -> None:
    names = ("", "bedroom", "", "bedroom")
    walk = tuple((pose, name) for (pose, _), name in zip((WALK[0], WALK[1], WALK[3], WALK[5]), names, strict=True))
    labels = [region.label for region in remembered(house(), walk).hierarchical.regions.all]
    assert labels == ["unknown place 1", "bedroom 1", "unknown place 2", "bedroom 2"]
