"""What clauses mean, in a hand-made house: a hallway with two bedrooms on its left, a bathroom and a kitchen on its right.

::

    y=8 +-----------+-----------+-----------+
        | bedroom 1 | bedroom 2 |           |
    y=5 +--d10------+--d11------+ living 5  |
      start hallway 0          d14          |
    y=3.4 +-d12-----+--d13------+           |
        | bathroom 3| kitchen 4 |           |
    y=0 +-----------+-----------+-----------+
        0           5          10          15
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from spacevln.core.geometry import Pose
from spacevln.environments.houses.episodes import Grounds, NoEpisodeError, ObjectGoal, consistent_places, route_episode
from spacevln.environments.houses.episodes import making as make
from spacevln.environments.houses.episodes.clauses import Along, Clause, Cross, Pass, Stop, Thing, Turn
from spacevln.environments.houses.episodes.topology import Topology
from spacevln.environments.houses.plan import Floor, House, Item, Opening, Part, Rect, Room

W = 0.06  # half a wall


def item(
    id_: int, category: str, room: int, x: float, y: float, size: tuple[float, float, float], words: tuple[str, ...]
) -> Item:
    half = (size[0] / 2, size[1] / 2, size[2] / 2)
    return Item(id_, category, words, room, 0, x, y, 0.0, 0.0, size, (Part("box", half, (0.0, 0.0, half[2]), "plain-white"),))


def make_house(items: tuple[Item, ...] = ()) -> House:
    rooms = (
        Room(0, "hallway", 0, (Rect(0 + W, 3.4 + W, 10 - W, 5 - W),)),
        Room(1, "bedroom", 0, (Rect(0 + W, 5 + W, 5 - W, 8 - W),)),
        Room(2, "bedroom", 0, (Rect(5 + W, 5 + W, 10 - W, 8 - W),)),
        Room(3, "bathroom", 0, (Rect(0 + W, 0 + W, 5 - W, 3.4 - W),)),
        Room(4, "kitchen", 0, (Rect(5 + W, 0 + W, 10 - W, 3.4 - W),)),
        Room(5, "living room", 0, (Rect(10 + W, 0 + W, 15 - W, 8 - W),)),
    )
    doors = (
        Opening(10, "doorway", 0, (0, 1), 3.0, 5.0, "x", 0.9),
        Opening(11, "doorway", 0, (0, 2), 7.0, 5.0, "x", 0.9),
        Opening(12, "doorway", 0, (3, 0), 3.0, 3.4, "x", 0.9),
        Opening(13, "doorway", 0, (4, 0), 7.0, 3.4, "x", 0.9),
        Opening(14, "opening", 0, (0, 5), 10.0, 4.2, "y", 1.2),
    )
    return House(7, (Floor(0, 0.0, 2.5),), rooms, doors, (), items)


HOUSE = make_house(
    (
        item(20, "sofa", 5, 13.0, 1.0, (1.8, 0.8, 0.8), ("white",)),
        item(21, "sofa", 5, 13.0, 7.3, (1.8, 0.8, 0.8), ("black",)),
        item(22, "refrigerator", 4, 9.5, 0.5, (0.7, 0.7, 1.8), ("silver",)),
        item(23, "potted plant", 0, 5.0, 4.7, (0.3, 0.3, 1.0), ("green",)),
    )
)
START = Pose(0.6, 4.2, 0.0, 0.0)


def places(*clauses: Clause, start: Pose = START, house: House = HOUSE) -> set[int]:
    """Rooms in which an instruction may end."""
    found = consistent_places(house, start, clauses)
    rooms = {house.room_at(x, y, floor) for x, y, floor in found}
    return {room.id for room in rooms if room is not None}


def clause(*atoms: object) -> Clause:
    return Clause(("T1",), "turn", tuple(atoms))  # type: ignore[arg-type]


def test_a_room_type_means_every_room_of_that_type() -> None:
    assert places(clause(Cross(target="bedroom"), Stop("here"))) == {1, 2}
    assert places(clause(Cross(target="kitchen"), Stop("here"))) == {4}


def test_ordinals_count_doors_on_their_side_along_the_walk() -> None:
    assert places(clause(Cross(side=1, ordinal=1), Stop("here"))) == {1}
    assert places(clause(Cross(side=1, ordinal=2), Stop("here"))) == {2}
    assert places(clause(Cross(side=-1, ordinal=2), Stop("here"))) == {4}


def test_sides_turn_with_the_walker() -> None:
    back = Pose(9.4, 4.2, 0.0, math.pi)
    assert places(clause(Cross(kind="doorway", side=1, ordinal=1), Stop("here")), start=back) == {4}
    assert places(clause(Cross(kind="doorway", side=-1, ordinal=1), Stop("here")), start=back) == {2}


def test_a_turn_after_leaving_is_at_the_door() -> None:
    bedroom = Pose(1.0, 7.0, 0.0, 0.0)
    left = places(
        clause(Cross(source="bedroom")), clause(Turn(1)), clause(Cross(target="living room"), Stop("here")), start=bedroom
    )
    right = places(
        clause(Cross(source="bedroom")), clause(Turn(-1)), clause(Cross(target="living room"), Stop("here")), start=bedroom
    )
    assert left == {5}
    assert right == set()


def test_a_passed_landmark_excludes_what_lies_before_it() -> None:
    plant = Thing("plant", ("potted plant",))
    assert places(clause(Pass(plant)), clause(Cross(target="bedroom"), Stop("here"))) == {2}
    assert places(clause(Pass(plant, 1)), clause(Cross(target="bedroom"), Stop("here"))) == {2}
    assert places(clause(Pass(plant, -1)), clause(Cross(target="bedroom"), Stop("here"))) == set()


def test_attributes_tell_instances_apart() -> None:
    into = clause(Along("hallway"), Cross(kind="opening"))
    any_sofa = consistent_places(HOUSE, START, (into, clause(Stop("near", Thing("couch", ("sofa",))))))
    white = consistent_places(HOUSE, START, (into, clause(Stop("near", Thing("couch", ("sofa",), ("white",))))))
    assert {y > 4 for _, y, _ in any_sofa} == {True, False}
    assert {y > 4 for _, y, _ in white} == {False}


def test_a_closed_word_leads_nowhere() -> None:
    assert consistent_places(HOUSE, START, (clause(Cross(target="garage"), Stop("here")),)) == ()


def test_sides_of_doors_match_plane_geometry() -> None:
    """Left and right by the sign of a cross product, independent of the code under test."""
    topology = Topology(HOUSE)
    for portal in topology.portals.values():
        for room in portal.rooms:
            node = topology.node(portal, room)
            for onward in topology.of_room[room]:
                if onward.id == portal.id:
                    continue
                leg = topology.leg_to_portal(node, onward)
                assert leg is not None
                ahead = np.array([math.cos(node.yaw_rad), math.sin(node.yaw_rad)])
                to = np.array(onward.side(room)) - np.array(node.xy)
                cross = ahead[0] * to[1] - ahead[1] * to[0]
                if abs(cross) > 1.0 and abs(leg.first_turn_rad) > 0.3:
                    assert np.sign(cross) == np.sign(leg.first_turn_rad)


def test_object_goal_needs_air_between() -> None:
    goal = ObjectGoal(Grounds(HOUSE), "refrigerator")
    assert goal.is_reached(9.5, 1.6, 0.0)
    assert not goal.is_reached(9.5, 2.3, 0.0)  # too far
    assert not goal.is_reached(10.5, 0.5, 0.0)  # behind the wall, 0.65 m away
    assert goal.distance_m(9.5, 1.6, 0.0) == 0.0
    assert goal.distance_m(9.5, 2.8, 0.0) == pytest.approx(0.95, abs=0.15)


def test_an_empty_house_gives_a_clear_error() -> None:
    one = House(1, (Floor(0, 0.0, 2.5),), (Room(0, "closet", 0, (Rect(0, 0, 1.5, 1.5),)),), (), ())
    with pytest.raises(NoEpisodeError, match="House seed 1"):
        route_episode(one, 0)


def test_walls_of_clauses_are_pure_data() -> None:
    assert make.turn(0.9) == make.turn(1.2)
    assert make.turn(-0.9) != make.turn(1.2)
