"""Floor plans: what every house of every seed keeps to."""

from __future__ import annotations

import itertools
import statistics

import pytest

from spacevln.environments.houses.layout import ROOM_TYPES, generate_layout, hole, railings, slabs, steps, walls
from spacevln.environments.houses.layout.draft import SIZES
from spacevln.environments.houses.plan import House, Rect

SEEDS = [pytest.param(range(30), id="30 houses"), pytest.param(range(30, 300), id="300 houses", marks=pytest.mark.slow)]
BEHIND = {"bedroom", "bathroom", "closet", "balcony", "garage", "laundry room"}


def overlap_m2(a: Rect, b: Rect) -> float:
    return max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) * max(0.0, min(a.y1, b.y1) - max(a.y0, b.y0))


def neighbours(house: House, room: int) -> set[int]:
    pairs = [o.rooms for o in house.openings if o.kind != "window"]
    found = {b if a == room else a for a, b in pairs if room in (a, b) and b is not None}
    if house.stairs and house.rooms[room].type == "hallway":
        found |= {other.id for other in house.rooms if other.type == "hallway"}
    return found - {room}


def reached(house: House, start: int, through: set[str]) -> set[int]:
    """Rooms that can be reached without crossing rooms of types not in ``through``."""
    seen, stack = {start}, [start]
    while stack:
        room = stack.pop()
        if room != start and house.rooms[room].type not in through:
            continue
        for other in neighbours(house, room) - seen:
            seen.add(other)
            stack.append(other)
    return seen


@pytest.mark.parametrize("seeds", SEEDS)
def test_rooms_are_of_known_types_and_of_sane_sizes(seeds: range) -> None:
    for house in map(generate_layout, seeds):
        types = [room.type for room in house.rooms]
        assert 4 <= len(types) <= 14
        assert set(types) <= set(ROOM_TYPES)
        assert {"living room", "kitchen", "bathroom", "bedroom"} <= set(types)
        assert "hallway" in types or len(types) <= 5
        assert [room.id for room in house.rooms] == list(range(len(types)))
        for room in house.rooms:
            short, long = sorted((room.rects[0].width, room.rects[0].depth))
            if room.type == "hallway":
                assert all(min(rect.width, rect.depth) >= 1.1 for rect in room.rects)
                continue
            rule = SIZES[room.type]
            assert len(room.rects) == 1
            assert rule.side_m[0] - 0.01 <= short <= rule.side_m[1] + 0.01, (house.seed, room)
            assert rule.area_m2[0] - 0.1 <= short * long <= rule.area_m2[1] + 0.1, (house.seed, room)
            assert long <= rule.aspect * short + 0.02, (house.seed, room)


@pytest.mark.parametrize("seeds", SEEDS)
def test_rooms_and_walls_do_not_overlap(seeds: range) -> None:
    for house in map(generate_layout, seeds):
        boxes = walls(house)
        for a, b in itertools.combinations(house.rooms, 2):
            if a.floor == b.floor:
                assert all(overlap_m2(p, q) < 1e-9 for p in a.rects for q in b.rects), (house.seed, a, b)
        for floor, parts in enumerate(boxes):
            rects = [rect for room in house.rooms if room.floor == floor for rect in room.rects]
            assert all(overlap_m2(part.rect, rect) < 1e-9 for part in parts for rect in rects), house.seed


@pytest.mark.parametrize("seeds", SEEDS)
def test_openings_are_wide_enough_and_lie_in_the_wall_between_their_rooms(seeds: range) -> None:
    for house in map(generate_layout, seeds):
        ids = [o.id for o in house.openings] + [s.id for s in house.stairs]
        assert len(set(ids)) == len(ids)
        boxes = walls(house)
        for opening in house.openings:
            cut = hole(house, opening)
            full = [part for part in boxes[opening.floor] if part.part in ("wall", "parapet")]
            assert all(overlap_m2(cut, part.rect) < 1e-9 for part in full), (house.seed, opening)
            away = house.wall_thickness_m / 2 + 0.05
            dx, dy = (away, 0.0) if opening.along == "y" else (0.0, away)
            sides = {house.room_at(opening.x + s * dx, opening.y + s * dy, opening.floor) for s in (-1, 1)}
            assert {None if room is None else room.id for room in sides} == set(opening.rooms), (house.seed, opening)
            if opening.kind != "window":
                assert opening.width_m >= 0.9
                assert opening.sill_m == 0.0
                assert opening.head_m >= 2.0


@pytest.mark.parametrize("seeds", SEEDS)
def test_every_room_is_reached_without_crossing_private_ones(seeds: range) -> None:
    for house in map(generate_layout, seeds):
        hub = next((room.id for room in house.rooms if room.type == "hallway"), 0)
        assert reached(house, hub, set(ROOM_TYPES)) == set(range(len(house.rooms)))
        public = reached(house, hub, set(ROOM_TYPES) - BEHIND)
        for room in house.rooms:
            if room.type in ("bedroom", "living room", "kitchen", "dining room", "office", "library", "gym", "playroom"):
                assert room.id in public, (house.seed, room)


def test_the_same_seed_gives_an_equal_house_and_others_differ() -> None:
    houses = [generate_layout(seed) for seed in range(12)]
    assert houses == [generate_layout(seed) for seed in range(12)]
    assert len({tuple(room.rects for room in house.rooms) for house in houses}) == 12


def test_a_fifth_of_the_houses_has_two_floors_and_the_median_has_eight_rooms_or_more() -> None:
    houses = [generate_layout(seed) for seed in range(300)]
    assert 0.15 <= sum(len(house.floors) == 2 for house in houses) / 300 <= 0.25
    assert statistics.median(len(house.rooms) for house in houses) >= 8
    assert 3 <= sum(len(house.rooms) <= 5 for house in houses) <= 24
    loops = sum(sum(o.kind != "window" for o in house.openings) >= len(house.rooms) - len(house.stairs) for house in houses)
    assert loops >= 90
    assert {room.type for house in houses for room in house.rooms} == set(ROOM_TYPES)


def test_houses_have_four_to_fourteen_rooms() -> None:
    sizes = [len(generate_layout(seed).rooms) for seed in (307, 11, 8)]
    assert sizes == [4, 5, 14]


def test_stairs_can_be_climbed_and_their_well_is_open() -> None:
    houses = [house for house in map(generate_layout, range(60)) if house.stairs]
    assert houses
    for house in houses:
        (stairs,) = house.stairs
        height = house.floors[1].z_m - house.floors[0].z_m
        assert height / stairs.steps <= 0.2
        assert 0.26 <= max(stairs.rect.width, stairs.rect.depth) / stairs.steps <= 0.30
        assert min(stairs.rect.width, stairs.rect.depth) >= 1.0
        treads = steps(house, stairs)
        assert treads[-1].z1_m == pytest.approx(house.floors[1].z_m)
        for slab in slabs(house):
            between = 0.5 < slab.z0_m < house.floors[1].z_m + 0.5
            assert not between or overlap_m2(slab.rect, stairs.rect) < 1e-9
        for floor in (0, 1):
            assert any(rail.floor == floor for rail in railings(house))
            assert house.room_at(*stairs.rect.centre, floor) is not None


@pytest.mark.parametrize("seed", range(8))
def test_half_walls_fill_the_space_between_rooms(seed: int) -> None:
    house = generate_layout(seed)
    for floor, parts in enumerate(walls(house)):
        z = house.floors[floor].z_m
        for a, b in itertools.combinations([part for part in parts if part.part != "header"], 2):
            assert overlap_m2(a.rect, b.rect) < 1e-9
        for x, y, inside in _probes(house, floor):
            solid = any(p.rect.contains(x, y) and p.z0_m <= z + 1.0 for p in parts if p.part in ("wall", "sill", "parapet"))
            passage = any(o.floor == floor and o.kind != "window" and hole(house, o).contains(x, y) for o in house.openings)
            assert solid != (inside or passage)


def _probes(house: House, floor: int) -> list[tuple[float, float, bool]]:
    """Points in rooms and in the middle of the walls around them."""
    found = []
    for room in house.rooms:
        if room.floor == floor and len(room.rects) == 1:
            r, half = room.rects[0], house.wall_thickness_m / 2
            found += [(*room.centre, True), (r.x0 - half / 2, r.y0 + 0.05, False), (r.x1 + half / 2, r.y1 - 0.05, False)]
    return found
