"""The walkable space: exact clearances, the ramp of the stairs, and furnishing that keeps houses passable."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacevln.core.errors import UsageError
from spacevln.environments.houses.ground.placement import PlacementGuard
from spacevln.environments.houses.ground.walkable import CAP_M, RESOLUTION_M, Walkable, clearance_connected
from spacevln.environments.houses.house import build_house, parse_scene_name
from spacevln.environments.houses.layout import generate_layout, hole, walls
from spacevln.environments.houses.layout.structure import direction, portion
from spacevln.environments.houses.plan import House, Item, Part, Rect


@lru_cache
def bare(seed: int) -> Walkable:
    return Walkable(generate_layout(seed))


@lru_cache
def with_stairs() -> Walkable:
    return next(space for space in map(bare, range(50)) if space.house.stairs)


def block(rect: Rect, room: int, number: int, floor: int = 0, z: float = 0.0, height: float = 0.5) -> Item:
    """A solid box."""
    half = (rect.width / 2, rect.depth / 2, height / 2)
    part = Part("box", half, (0.0, 0.0, height / 2), "wood")
    size = (rect.width, rect.depth, height)
    return Item(number, "box", (), room, floor, *rect.centre, z, 0.0, size, (part,))


def distance_to_rect(x: float, y: float, rect: Rect) -> float:
    return math.hypot(max(rect.x0 - x, x - rect.x1, 0.0), max(rect.y0 - y, y - rect.y1, 0.0))


@given(seed=st.integers(0, 3), u=st.floats(0, 1), v=st.floats(0, 1))
@settings(deadline=None, max_examples=60)
def test_clearance_is_the_distance_to_the_nearest_wall(seed: int, u: float, v: float) -> None:
    space = bare(seed)
    rect = space.house.rooms[int(u * 7.99) % len(space.house.rooms)].rects[0]
    x, y = rect.x0 + u * rect.width, rect.y0 + v * rect.depth
    floor = space.house.room_at(x, y, 0)
    if floor is None or space.house.stairs:
        return
    solid = [part.rect for part in walls(space.house)[0] if part.z0_m < 0.9]
    expected = min(CAP_M, min(distance_to_rect(x, y, rect) for rect in solid))
    assert space.clearance_m(x, y, 0.0) == pytest.approx(expected, abs=1e-6)
    assert space.is_walkable(x, y, 0.0, 0.1) == (expected >= 0.1 - 1e-9)


def test_grid_cells_hold_the_clearance_of_their_centre() -> None:
    space = with_stairs()
    rng = np.random.default_rng(0)
    for floor in space.floors:
        z = space.house.floors[floor.index].z_m
        for i, j in rng.integers(0, floor.clearance_m.shape, (200, 2)):
            x, y = floor.centre(int(i), int(j))
            if space.stairs_at(x, y, z) is None:
                assert floor.clearance_m[i, j] == pytest.approx(space.clearance_m(x, y, z), abs=1e-5)
            assert floor.cell(x, y) == (i, j)


@pytest.mark.parametrize("seed", range(6))
def test_doorways_let_the_disc_through_and_windows_do_not(seed: int) -> None:
    space = bare(seed)
    for opening in space.house.openings:
        z = space.house.floors[opening.floor].z_m
        if opening.kind == "window":
            assert not space.is_walkable(opening.x, opening.y, z)
        else:
            assert space.is_walkable(opening.x, opening.y, z, 0.44)


def test_the_ground_rises_along_the_stairs_and_meets_both_floors() -> None:
    space = with_stairs()
    (stairs,) = space.house.stairs
    low, high = (floor.z_m for floor in space.house.floors)
    length = max(stairs.rect.width, stairs.rect.depth)
    heights, z = [], low
    for share in np.arange(-0.5, length + 0.5, 0.05) / length:
        x, y = portion(stairs, share, share).centre
        z = space.floor_height_m(x, y, z)
        heights.append(z)
        assert space.is_walkable(x, y, z), share
    assert heights[0] == low
    assert heights[-1] == high
    assert np.diff(heights).min() >= 0.0
    assert np.diff(heights).max() <= 0.05


def test_one_cannot_step_onto_the_stairs_from_their_side_nor_into_the_well() -> None:
    space = with_stairs()
    (stairs,) = space.house.stairs
    low, high = (floor.z_m for floor in space.house.floors)
    ux, uy = direction(stairs)
    half = min(stairs.rect.width, stairs.rect.depth) / 2
    x, y = stairs.rect.centre
    for z in (low, high):
        assert all(not space.is_walkable(x + s * half * uy, y + s * half * ux, z) for s in (-1, 1))
    assert not space.is_walkable(*portion(stairs, 0.02, 0.02).centre, high)
    assert not space.is_walkable(*portion(stairs, 1.001, 1.001).centre, low)


def test_items_block_by_what_is_at_the_height_of_the_body() -> None:
    house = generate_layout(3)
    room = next(room for room in house.rooms if room.type == "living room")
    x, y = room.centre
    rect = Rect(x - 0.3, y - 0.2, x + 0.3, y + 0.2)
    for z, height, blocks in ((0.0, 0.5, True), (0.0, 0.02, False), (0.7, 0.04, True), (0.97, 0.3, False), (2.0, 0.3, False)):
        space = Walkable(replace(house, items=(block(rect, room.id, 900, z=z, height=height),)))
        assert space.is_walkable(x, y, 0.0) != blocks, (z, height)
        assert space.is_walkable(x + 0.39, y, 0.0) != blocks
        assert space.is_walkable(x + 0.401, y, 0.0)


def test_turned_and_round_parts_are_taken_exactly() -> None:
    house = generate_layout(3)
    room = next(room for room in house.rooms if room.type == "living room")
    x, y = room.centre
    disc = Part("cylinder", (0.3, 0.2, 0.0), (0.0, 0.0, 0.2), "wood")
    space = Walkable(replace(house, items=(Item(900, "stool", (), room.id, 0, x, y, 0.0, 0.3, (0.6, 0.6, 0.4), (disc,)),)))
    assert space.clearance_m(x + 0.5, y, 0.0) == pytest.approx(0.2)
    turned = replace(block(Rect(x - 0.4, y - 0.1, x + 0.4, y + 0.1), room.id, 900), yaw_rad=math.pi / 4)
    space = Walkable(replace(house, items=(turned,)))
    assert space.clearance_m(x + 0.4, y + 0.4, 0.0) == pytest.approx(math.hypot(0.4, 0.4) - 0.4)
    assert space.clearance_m(x + 0.2, y - 0.2, 0.0) == pytest.approx(math.hypot(0.2, 0.2) - 0.1)


@pytest.mark.parametrize("seeds", [range(30), pytest.param(range(30, 300), marks=pytest.mark.slow)])
def test_every_room_of_a_furnished_house_is_reached_with_a_quarter_of_a_metre_to_spare(seeds: range) -> None:
    assert [seed for seed in seeds if not clearance_connected(build_house(seed))] == []


def test_a_closed_door_is_noticed() -> None:
    house = generate_layout(4)
    room = next(room for room in house.rooms if sum(room.id in o.rooms for o in house.openings if o.kind != "window") == 1)
    door = next(o for o in house.openings if o.kind != "window" and room.id in o.rooms)
    blocked = replace(house, items=(block(hole(house, door), room.id, 900),))
    assert Walkable(blocked).unreachable_rooms() == (room.id,)
    assert not clearance_connected(blocked)


@pytest.mark.parametrize("seed", range(8))
def test_what_the_guard_accepts_leaves_the_house_passable(seed: int) -> None:
    house = generate_layout(seed)
    guard, rng = PlacementGuard(house), np.random.default_rng(seed)
    items: list[Item] = []
    refused = 0
    for _ in range(250):
        room = house.rooms[int(rng.integers(len(house.rooms)))]
        where = room.rects[0]
        (x, y), (w, d) = rng.uniform((where.x0, where.y0), (where.x1, where.y1)), rng.uniform(0.3, 1.2, 2)
        rect = Rect(x - w / 2, y - d / 2, x + w / 2, y + d / 2)
        if guard.try_add(rect, room.id):
            items.append(block(rect, room.id, 1000 + len(items), room.floor, house.floors[room.floor].z_m))
        else:
            refused += 1
    assert len(items) > 40
    assert refused > 10
    assert clearance_connected(replace(house, items=tuple(items)))


def test_the_guard_keeps_doors_free_and_refuses_a_wall_of_furniture() -> None:
    house = generate_layout(4)
    guard = PlacementGuard(house)
    room = next(room for room in house.rooms if room.type == "living room")
    for zone in guard.kept_free(room.id):
        x, y = zone.centre
        assert not guard.try_add(Rect(x - 0.1, y - 0.1, x + 0.1, y + 0.1), room.id)
        corners = np.array([(x, y - 0.1), (x + 0.1, y), (x, y + 0.1), (x - 0.1, y)])
        assert not guard.try_add(corners, room.id)
    r = room.rects[0]
    middle = (r.y0 + r.y1) / 2
    halves = [Rect(r.x0, middle - 0.1, r.centre[0], middle + 0.1), Rect(r.centre[0], middle - 0.1, r.x1, middle + 0.1)]
    assert not guard.try_add(halves, room.id)


def test_regions_of_the_grid_match_the_rooms() -> None:
    space = bare(0)
    room = space.house.rooms[1]
    cells = space.floors[0].cells_of(room.rects[0])
    count = (cells[0].stop - cells[0].start) * (cells[1].stop - cells[1].start)
    assert count * RESOLUTION_M**2 == pytest.approx(room.area, rel=0.06)


def test_scene_names_lead_to_seeds_and_back() -> None:
    house: House = build_house(17)
    assert parse_scene_name(house.name) == 17
    assert parse_scene_name("house-100000") == 100000
    assert parse_scene_name("house-1234567") == 1234567
    for name in ("house-17", "house-0000017", "home-000017", "house-000017 ", ""):
        with pytest.raises(UsageError, match="is not a house"):
            parse_scene_name(name)
    with pytest.raises(UsageError, match="negative"):
        build_house(-1)
    with pytest.raises(UsageError, match="radius"):
        bare(0).is_walkable(1.0, 1.0, 0.0, 2.0)
