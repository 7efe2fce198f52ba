"""Which stages take a flight of stairs, so that its steps are no obstacles."""

from __future__ import annotations

import pytest

from spacevln.agent.stage import _incline
from spacevln.core import Anchor, Pose, SpaceKind, Subtask

HERE, TOP = Anchor("hallway", SpaceKind.CONNECTOR), Anchor("top of the stairs", SpaceKind.CONNECTOR)


@pytest.mark.parametrize(
    ("target_m", "landmark", "taken"),
    [
        ((4.0, 0.0, 2.8), "", True),
        ((4.0, 0.0, -2.8), "", True),
        ((4.0, 0.0, 0.1), "", False),  # on this storey
        ((4.0, 0.0, 1.5), "wall lamp", False),  # the height of a thing
        (None, "", False),
    ],
)
def test_only_a_target_on_another_level_without_a_landmark_is_over_a_flight(
    target_m: tuple[float, float, float] | None, landmark: str, taken: bool
) -> None:
    subtask = Subtask((HERE, TOP), 0, HERE, TOP, "front", "Go.", landmark, False, target_m=target_m)
    incline = _incline(subtask, Pose(0.0, 0.0, 0.0, 0.0))
    assert (incline is not None) == taken
    if incline is not None:
        assert (incline.start_m, incline.end_m) == ((0.0, 0.0, 0.0), target_m)
