from spacevln.core import Anchor, Pose, SpaceKind
from spacevln.memory import reached_space

KITCHEN = Anchor("kitchen", SpaceKind.ROOM)
DOOR = (4.0, 0.0)
START = Pose(1.0, 0.0)


def test_a_space_is_reached_half_a_metre_past_its_opening_and_when_the_region_is_of_its_type() -> None:
    assert reached_space(KITCHEN, "kitchen", Pose(4.6, 0.3), DOOR, START)
    assert not reached_space(KITCHEN, "kitchen", Pose(4.3, 0.0), DOOR, START)
    assert not reached_space(KITCHEN, "hallway", Pose(4.6, 0.0), DOOR, START)
    assert not reached_space(KITCHEN, "", Pose(4.6, 0.0), DOOR, START)
    assert not reached_space(Anchor("", SpaceKind.UNKNOWN), "kitchen", Pose(4.6, 0.0), DOOR, START)


def test_without_a_known_opening_the_region_decides() -> None:
    assert reached_space(Anchor("corridor", SpaceKind.CONNECTOR), "hallway", Pose(0.0, 0.0), None, START)


def test_from_within_the_opening_any_side_counts() -> None:
    assert reached_space(KITCHEN, "kitchen", Pose(4.0, 0.6), DOOR, Pose(4.0, 0.0))
