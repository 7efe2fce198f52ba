import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_house import door, house, thing
from hypothesis import given, settings
from hypothesis import strategies as st

from spacevln.core import CueKind, Pose
from spacevln.memory import ARRIVAL_RADIUS_M, LocalLandmarkMemory, summarise

MAP = house()
START = Pose(3.0, 3.0, 0.0, 0.0)
LIVING = Pose(11.0, 2.0, 0.0, 0.0)


def seen(landmark: str, *images: tuple[Pose, list], **options: object) -> LocalLandmarkMemory:
    memory = LocalLandmarkMemory(landmark, images[0][0] if images else START, **options)  # type: ignore[arg-type]
    for pose, sightings in images:
        memory.update(sightings, pose, MAP)
    return memory


def test_two_sightings_of_one_thing_are_one_candidate() -> None:
    memory = seen("sofa", (LIVING, [thing("sofa", 13.5, 1.0)]), (LIVING, [thing("couch", 13.7, 1.2, confidence=0.4)]))
    (candidate,) = memory.candidates
    assert candidate.observations == 2
    assert candidate.confidence == 0.8
    assert 13.5 < candidate.position_m[0] < 13.6  # nearer to the confident one


@pytest.mark.parametrize(
    ("category", "away", "higher", "one"),
    [
        ("painting", 0.0, 0.7, True),  # the image cut it at another height
        ("painting", 0.55, 0.0, True),
        ("painting", 0.55, 0.7, False),  # near across and near in height, but not in space
        ("painting", 0.0, 1.2, False),
        ("doorway", 0.55, 0.9, True),  # from floor to lintel
        ("doorway", 0.0, 2.6, False),  # of the storey above
        ("sofa", 0.8, 0.5, True),  # as wide as it is
    ],
)
def test_fusion_is_in_three_dimensions(category: str, away: float, higher: float, one: bool) -> None:
    extent = 1.6 if category == "sofa" else 0.0
    first = thing(category, 13.0, 2.0, extent_m=extent)
    second = thing(category, 13.0, 2.0 + away, extent_m=extent, position_m=(13.0, 2.0 + away, 0.5 + higher))
    memory = seen(category, (LIVING, [first]), (LIVING, [second]))
    assert len(memory.candidates) == (1 if one else 2)


def test_two_things_in_one_image_stay_two_and_duplicates_are_dropped() -> None:
    near = [thing("chair", 12, 2.0), thing("chair", 12, 2.4, box_px=(60, 0, 110, 90))]
    assert len(seen("chair", (LIVING, near)).candidates) == 2
    twice = [thing("chair", 12, 2.0), thing("chair", 12.1, 2.1, confidence=0.5)]
    assert len(seen("chair", (LIVING, twice)).candidates) == 1


def test_small_masks_and_weak_and_other_things_are_no_candidates() -> None:
    others = [thing("sofa", 13, 1, pixels=5), thing("sofa", 13, 1, confidence=0.2), thing("bed", 13, 1)]
    assert seen("sofa", (LIVING, others)).candidates == ()
    assert seen("", (LIVING, [thing("sofa", 13, 1)])).candidates == ()


def test_top_k_is_confidence_first_then_distance() -> None:
    chairs = [
        thing("chair", 14, 4, confidence=0.6, box_px=(0, 0, 9, 9)),
        thing("chair", 12, 2, confidence=0.6, box_px=(20, 0, 29, 9)),
        thing("chair", 14.5, 2, confidence=0.9, box_px=(40, 0, 49, 9)),
    ]
    memory = seen("chair", (LIVING, chairs))
    assert [candidate.confidence for candidate in memory.pool()] == [0.9, 0.6]
    assert memory.pool()[1].position_m[:2] == (12, 2)
    assert len(memory.pool(5)) == 3


def test_visibility_distance_and_bearing_follow_the_pose() -> None:
    memory = seen("sofa", (LIVING, [thing("sofa", 13.0, 2.0)]))
    assert memory.pool()[0].visible
    memory.update([], Pose(11.0, 2.0, 0.0, math.pi / 2), MAP)
    (candidate,) = memory.pool()
    assert not candidate.visible
    assert candidate.distance_m == pytest.approx(2.0)
    assert candidate.bearing_rad == pytest.approx(-math.pi / 2)


def test_distance_is_to_the_nearest_surface_seen_so_far_from_any_pose() -> None:
    front = ((13.0, 0.2), (13.0, 1.0), (13.0, 1.8))
    memory = seen("sofa", (LIVING, [thing("sofa", 13.4, 1.0, surface_m=front, extent_m=1.6)]))
    memory.update([], Pose(13.0, 2.5, 0.0, 0.0), MAP)
    assert memory.pool()[0].distance_m == pytest.approx(0.7)
    assert memory.pool()[0].arrived


@pytest.mark.parametrize(("category", "radius"), [("sofa", 0.75), ("doorway", 0.5), ("stairs", 0.5)])
def test_arrival_is_by_kind(category: str, radius: float) -> None:
    for gap, arrived in ((radius + 0.05, False), (radius - 0.05, True)):
        memory = seen(category, (Pose(12.0 - gap, 2.0), [thing(category, 12.0, 2.0)]))
        assert memory.pool()[0].arrived is arrived
        assert memory.arrived is arrived


def test_stairs_that_are_traversed_are_arrived_at_on_the_other_floor() -> None:
    memory = seen("stairs", (Pose(11.9, 2.0), [thing("stairs", 12.0, 2.0)]), traverse=True)
    assert not memory.arrived
    memory.update([], Pose(13.0, 2.0, 2.8, 0.0), MAP)
    assert memory.arrived
    assert memory.pool()[0].arrived


def test_a_wall_between_means_no_arrival() -> None:
    memory = seen("sofa", (START, [thing("sofa", 3.9, 2.8)]), (Pose(4.5, 2.6), []))  # from the bedroom into the hallway
    assert memory.pool()[0].distance_m < ARRIVAL_RADIUS_M[CueKind.SOLID]
    assert not memory.arrived


def test_what_stands_before_a_landmark_in_view_does_not_hide_its_arrival() -> None:
    lamp, here = thing("lamp", 12.0, 4.75), Pose(12.0, 4.1)  # upon or behind the shelf
    assert seen("lamp", (here, [lamp])).arrived
    assert not seen("lamp", (Pose(12.0, 3.0), [lamp]), (here, [])).arrived


def test_what_hangs_too_high_to_be_in_view_from_nearby_is_arrived_at_over_the_furniture_below() -> None:
    lamp, far, near = thing("lamp", 12.0, 4.75), Pose(12.0, 3.0), Pose(12.0, 4.1)  # over the shelf
    high = replace(lamp, position_m=(*lamp.position_m[:2], 1.8))
    assert seen("lamp", (far, [high]), (near, [])).arrived
    assert not seen("lamp", (Pose(12.0, 0.6), [high]), (near, [])).arrived  # not from that far away


def test_attributes_that_contradict_never_arrive_and_rank_last() -> None:
    black, white = thing("sofa", 11.5, 2.0, ("black",)), thing("sofa", 14.0, 2.0, ("white",), box_px=(60, 0, 99, 90))
    memory = seen("white sofa", (LIVING, [black, white]))
    assert [candidate.attributes for candidate in memory.pool()] == [("white",), ("black",)]
    assert not memory.arrived
    assert seen("sofa", (LIVING, [black])).arrived


def test_an_opening_is_one_by_category_and_by_depth_profile() -> None:
    shut = thing("door", 10.05, 2.1, surface_m=((10.05, 1.5), (10.05, 2.7)))
    memory = seen("door", (Pose(8, 2), [shut]))
    assert memory.pool()[0].kind is CueKind.SOLID
    memory.update([door((10.05, 1.5), (10.05, 2.7))], Pose(8.2, 2), MAP)
    assert memory.pool()[0].kind is CueKind.OPENING
    memory.update([shut], Pose(8.4, 2), MAP)
    assert memory.pool()[0].kind is CueKind.OPENING, "what was seen once stays seen"
    assert seen("sofa", (LIVING, [thing("sofa", 13, 2, is_passage=True)])).pool()[0].kind is CueKind.SOLID


def test_an_opening_is_where_its_best_view_says() -> None:
    jamb = thing("doorway", 10.05, 2.7, surface_m=((10.05, 2.7), (10.05, 2.7)))
    memory = seen("doorway", (Pose(8, 2), [door((10.05, 1.5), (10.05, 2.7))]), (Pose(9, 2), [jamb]))
    (candidate,) = memory.candidates
    assert candidate.kind is CueKind.OPENING
    assert candidate.position_m[1] == pytest.approx(2.1)
    memory.update([], Pose(10.0, 2.1), MAP)
    assert memory.arrived


@settings(deadline=None)
@given(
    category=st.sampled_from(["bed", "sofa", "chair", "stairs", "doorway", "lamp", "white table", "zorblax", ""]),
    landmark=st.sampled_from(["refrigerator", "toilet", "piano", "blue globe", "frobnicator", ""]),
    gap=st.floats(0, 2),
    confidence=st.floats(0, 1),
    height=st.floats(-3, 3),
)
def test_an_unrelated_thing_is_never_arrived_at(
    category: str, landmark: str, gap: float, confidence: float, height: float
) -> None:
    sighting = thing(category, 12.0 + gap, 2.0, confidence=confidence)
    memory = seen(landmark, (Pose(12.0, 2.0), [sighting]), (Pose(12.0, 2.0, height), [sighting]))
    assert not memory.arrived
    assert memory.candidates == ()


@settings(deadline=None)
@given(st.permutations(range(5)), st.integers(0, 3))
def test_the_order_of_sightings_in_an_image_does_not_matter(order: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    chairs = [
        thing(
            "chair",
            *rng.uniform((10.5, 0), (14, 4)),
            confidence=round(float(rng.uniform(0.3, 1)), 2),
            box_px=(k * 9, 0, k * 9 + 8, 9),
        )
        for k in range(5)
    ]
    shuffled = [chairs[k] for k in order]
    one, two = seen("chair", (LIVING, chairs)), seen("chair", (LIVING, shuffled))
    assert [replace(c, instance=0) for c in one.candidates] == [replace(c, instance=0) for c in two.candidates]


def test_the_summary_says_what_became_of_the_landmark() -> None:
    memory = seen("sofa", (LIVING, [thing("sofa", 11.5, 2.0)]))
    assert summarise(memory.pool(), "sofa") == "sofa (arrived) 0.5 m front"
    memory.update([], LIVING.turned(math.pi), MAP)
    assert summarise(memory.pool(), "sofa") == "sofa (arrived) 0.5 m back, remembered"
    assert summarise((), "sofa") == "sofa: never seen"
    assert summarise((), "") == "no landmark was tracked"


def test_with_temporal_verification_one_picture_is_not_enough_and_the_same_picture_again_says_nothing_new() -> None:
    near = Pose(11.0, 2.0, 0.0, 0.0)
    first, second = thing("sofa", 11.5, 2.0), thing("sofa", 11.5, 2.02, box_px=(2, 0, 52, 90))
    assert seen("sofa", (near, [first])).arrived
    once = seen("sofa", (near, [first]), (near, [first]), (near, [first]), arrival_sightings=2)
    assert [candidate.observations for candidate in once.candidates] == [3]
    assert not once.arrived
    assert seen("sofa", (near, [first]), (near, [second]), arrival_sightings=2).arrived
    assert not seen("sofa", (near, [first]), (near, [second]), arrival_sightings=3).arrived
    elsewhere = thing("sofa", 14.0, 4.0, box_px=(200, 0, 250, 90))
    assert not seen(
        "sofa", (near, [first]), (near, [elsewhere]), arrival_sightings=2
    ).arrived  # another thing's look does not count
