"""The disc among obstacles: never inside one, never farther than asked, no tunnelling, collided exactly when hindered."""

from __future__ import annotations

import math

import numpy as np
import pytest
import two_rooms
from hypothesis import example, given, settings
from hypothesis import strategies as st

from spacevln.core import Pose
from spacevln.environments.houses.walking.motion import Body, sweep_disc

RADIUS = 0.1
NO_DISCS = np.empty((0, 3))
coordinate = st.floats(-2, 2)
extent = st.floats(0.02, 0.8)
boxes_st = st.lists(st.tuples(coordinate, coordinate, extent, extent, st.floats(0, math.tau)), max_size=6)
discs_st = st.lists(st.tuples(coordinate, coordinate, extent), max_size=4)
moves = st.lists(st.tuples(st.floats(0, math.tau), st.sampled_from([0.25, 1.0, 4.0])), min_size=1, max_size=6)


def clearance(x: float, y: float, boxes: np.ndarray, discs: np.ndarray) -> float:
    """Distance from a point to the nearest obstacle; negative inside. Written independently of the module under test."""
    best = math.inf
    for cx, cy, c, s, hx, hy in boxes:
        across = np.array([[c, s], [-s, c]]) @ (x - cx, y - cy)
        over = np.abs(across) - (hx, hy)
        best = min(best, float(np.linalg.norm(np.maximum(over, 0)) + min(over.max(), 0)))
    for cx, cy, radius in discs:
        best = min(best, math.hypot(x - cx, y - cy) - radius)
    return best


def box_rows(boxes) -> np.ndarray:
    """Rows (x, y, half, half, yaw) as motion takes them."""
    return np.array([(x, y, math.cos(a), math.sin(a), hx, hy) for x, y, hx, hy, a in boxes], float).reshape(-1, 6)


def arrays(boxes: list[tuple[float, ...]], discs: list[tuple[float, ...]]) -> tuple[np.ndarray, np.ndarray]:
    return box_rows(boxes), np.array(discs, float).reshape(-1, 3)


@settings(max_examples=300, deadline=None)
@given(boxes_st, discs_st, moves, st.booleans())
@example([(0.0, 0.5, 1.0, 0.02, 0.0)], [], [(math.pi / 2, 4.0)], False)
def test_never_inside_never_too_far_collided_when_hindered(boxes, discs, moves, sliding):
    boxes, discs = arrays(boxes, discs)
    x, y = 0.0, 0.0
    if clearance(x, y, boxes, discs) < RADIUS:
        return
    for yaw, length in moves:
        wanted = (length * math.cos(yaw), length * math.sin(yaw))
        nx, ny, collided = sweep_disc((x, y), wanted, boxes, discs, radius_m=RADIUS, sliding=sliding)
        assert clearance(nx, ny, boxes, discs) >= RADIUS - 1e-6
        assert math.hypot(nx - x, ny - y) <= length + 1e-9
        hindered = math.hypot(nx - x - wanted[0], ny - y - wanted[1]) > 1e-9
        assert collided == hindered
        if not sliding:  # the way is a straight piece of the wanted one, and all of it is free: nothing was tunnelled through
            share = math.hypot(nx - x, ny - y) / length
            assert math.hypot(nx - x - share * wanted[0], ny - y - share * wanted[1]) < 1e-7
            for t in np.linspace(0, 1, 40):
                assert clearance(x + t * (nx - x), y + t * (ny - y), boxes, discs) >= RADIUS - 1e-6
        x, y = nx, ny


@settings(max_examples=200, deadline=None)
@given(boxes_st, discs_st, st.floats(0, math.tau), st.booleans())
def test_a_long_move_equals_its_pieces_up_to_the_first_contact(boxes, discs, yaw, sliding):
    boxes, discs = arrays(boxes, discs)
    if clearance(0, 0, boxes, discs) < RADIUS + 1e-3:
        return
    c, s = math.cos(yaw), math.sin(yaw)
    whole = sweep_disc((0, 0), (2 * c, 2 * s), boxes, discs, sliding=False)
    x, y, collided = 0.0, 0.0, False
    for _ in range(20):
        x, y, collided = sweep_disc((x, y), (0.1 * c, 0.1 * s), boxes, discs, sliding=sliding)
        if collided:
            break
    assert whole[2] == collided
    if not sliding or not collided:
        assert (x, y) == pytest.approx(whole[:2], abs=1e-6)


def test_a_thin_wall_is_not_tunnelled_through():
    wall = box_rows([(1.0, 0.0, 0.001, 5.0, 0.0)])
    x, y, collided = sweep_disc((0.0, 0.0), (100.0, 0.0), wall, NO_DISCS)
    assert x == pytest.approx(1.0 - 0.001 - RADIUS, abs=2e-4)
    assert y == 0.0
    assert collided


def test_sliding_keeps_the_part_along_the_wall():
    wall = box_rows([(0.0, 1.0, 5.0, 0.5, 0.0)])
    angle = math.radians(30)
    move = (0.25 * math.cos(angle), 0.25 * math.sin(angle))
    slid = sweep_disc((0.0, 0.4 - 2e-4), move, wall, NO_DISCS)
    stopped = sweep_disc((0.0, 0.4 - 2e-4), move, wall, NO_DISCS, sliding=False)
    assert slid[0] == pytest.approx(move[0], abs=1e-3)
    assert slid[1] == pytest.approx(0.4, abs=3e-4)
    assert math.hypot(stopped[0], stopped[1] - 0.4) < 1e-3
    assert slid[2]
    assert stopped[2]


def test_a_seam_between_flush_walls_does_not_catch_the_disc():
    walls = box_rows([(-1.0, 1.0, 1.0, 0.5, 0.0), (1.0, 1.0, 1.0, 0.5, 0.0)])
    x, y = -0.5, 0.4 - 1e-4
    for _ in range(4):
        x, y, _ = sweep_disc((x, y), (0.25 * math.cos(0.2), 0.25 * math.sin(0.2)), walls, NO_DISCS)
    assert x == pytest.approx(-0.5 + math.cos(0.2), abs=1e-3)


def test_an_inner_corner_holds_the_disc():
    walls = box_rows([(1.0, 0.0, 0.1, 3.0, 0.0), (0.0, 1.0, 3.0, 0.1, 0.0)])
    x, y, _ = sweep_disc((0.5, 0.6), (1.0, 1.1), walls, NO_DISCS)
    again = sweep_disc((x, y), (0.2, 0.2), walls, NO_DISCS)
    assert (x, y) == pytest.approx((0.8, 0.8), abs=3e-4)
    assert math.hypot(again[0] - x, again[1] - y) < 1e-3
    assert again[2]


def test_through_the_doorway_and_into_its_frame():
    boxes, discs = two_rooms.obstacles()
    x, y, collided = sweep_disc((3.5, 2.0), (1.5, 0.0), boxes, discs)
    assert (x, y, collided) == (5.0, 2.0, False)
    x, _, collided = sweep_disc((3.5, 1.0), (1.5, 0.0), boxes, discs)
    assert collided
    assert x == pytest.approx(3.9, abs=2e-4)


def test_the_body_reports_what_it_did():
    body = Body(two_rooms.FlatGround(), sliding=False)
    at = Pose(3.8, 1.0, 0.0, 0.0)
    there, motion = body.forward(at, 0.25)
    assert motion.collided
    assert motion.moved_m == pytest.approx(0.1, abs=2e-4)
    assert there.x_m == pytest.approx(3.9, abs=2e-4)
    turned, motion = body.turn(there, math.radians(30))
    assert turned.yaw_rad == pytest.approx(math.radians(30))
    assert motion.turned_rad == pytest.approx(math.radians(30))
    assert not motion.collided


def test_the_disc_is_moved_again_in_the_very_same_way():
    boxes, discs = two_rooms.obstacles()
    ways = [sweep_disc((1.0, 1.0), (3 * math.cos(a), 3 * math.sin(a)), boxes, discs) for a in np.linspace(0, 6, 50)]
    assert ways == [sweep_disc((1.0, 1.0), (3 * math.cos(a), 3 * math.sin(a)), boxes, discs) for a in np.linspace(0, 6, 50)]
