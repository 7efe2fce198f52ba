import math
from collections import Counter
from dataclasses import replace

import cv2
import numpy as np
import pytest

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.furniture import CATALOGUE, RECIPES, design, furnish
from spacevln.environments.houses.furniture.leaf import leaf_place
from spacevln.environments.houses.furniture.mesh import named_mesh, part_triangles
from spacevln.environments.houses.furniture.shapes import CUSTOM
from spacevln.environments.houses.furniture.walls import footprint_of, overlap
from spacevln.environments.houses.ground.walkable import clearance_connected
from spacevln.environments.houses.layout import ROOM_TYPES, generate_layout
from spacevln.environments.houses.plan import House, Item

SEEDS = range(12)
IDENTIFYING = {
    "bedroom": ({"bed", "bunk bed"},),
    "bathroom": ({"toilet"}, {"bathroom sink"}),
    "kitchen": ({"stove"}, {"refrigerator"}, {"kitchen sink"}),
    "living room": ({"sofa"}, {"tv", "fireplace"}),
    "dining room": ({"dining table", "round table"}, {"dining chair"}),
    "office": ({"desk"},),
    "laundry room": ({"washing machine"},),
    "garage": ({"car", "workbench", "ping pong table"},),
    "gym": ({"treadmill"},),
    "library": ({"bookshelf"},),
    "playroom": ({"toy box", "pool table", "ping pong table", "foosball table"},),
    "closet": ({"clothes rack", "wardrobe", "shoe rack"},),
}


@pytest.fixture(scope="module")
def houses() -> list[House]:
    return [furnish(generate_layout(seed)) for seed in SEEDS]


def stand(item: Item) -> str:
    return CATALOGUE[item.category].stand


def test_at_least_75_categories_each_with_variants_told_apart():
    assert len(CATALOGUE) >= 75
    for name, kind in CATALOGUE.items():
        assert kind.looks, name
        assert all(look.words for look in kind.looks), name
    varied = [name for name, kind in CATALOGUE.items() if len({look.words for look in kind.looks}) > 1]
    assert len(varied) >= 75


@pytest.mark.parametrize("category", sorted(CATALOGUE))
def test_designs_are_centred_and_stand_on_their_base(category):
    for look in range(len(CATALOGUE[category].looks)):
        made = design(category, look, look % 3)
        points = np.concatenate([part_triangles(part).points for part in made.parts])
        low, high = points.min(axis=0), points.max(axis=0)
        assert np.allclose(high - low, made.size, atol=1e-3)
        assert np.allclose(low[:2], -high[:2], atol=1e-3)
        assert abs(low[2]) < 1e-3
        assert max(made.size) < 4.0


@pytest.mark.parametrize("name", ["box", "cylinder", "thin cylinder", "ellipsoid", "small ellipsoid", *sorted(CUSTOM)])
def test_unit_meshes_lie_in_the_unit_cube_with_outward_unit_normals(name):
    mesh = named_mesh(name)
    assert np.abs(mesh.points).max() <= 1.0 + 1e-9
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)
    corners = mesh.points[mesh.faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = np.einsum("ij,ij->i", flat, mesh.normals[mesh.faces].mean(axis=1))
    assert (facing > -1e-9).all()
    # a closed surface turned outwards encloses a positive volume
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume > -1e-6


def test_unknown_category_is_refused():
    with pytest.raises(UnknownNameError, match="sofa"):
        design("sofaa", 0)


def test_every_room_type_has_a_recipe_and_others_are_refused(houses):
    assert set(RECIPES) == set(ROOM_TYPES)
    room = replace(houses[0].rooms[0], type="ballroom")
    with pytest.raises(UnknownNameError, match="ballroom"):
        furnish(replace(houses[0], rooms=(room, *houses[0].rooms[1:])))


def test_same_seed_same_house(houses):
    assert furnish(generate_layout(3)) == houses[3]
    assert furnish(houses[3]) == houses[3]


def test_ids_are_unique_and_shared_with_openings_and_stairs(houses):
    for house in houses:
        ids = [x.id for x in (*house.items, *house.openings, *house.stairs)]
        assert len(ids) == len(set(ids))
        assert min(ids) > 0


def test_rooms_hold_what_identifies_them(houses):
    missing, asked = [], 0
    for house in houses:
        for room in house.rooms:
            here = {item.category for item in house.items if item.room == room.id}
            for options in IDENTIFYING.get(room.type, ()):
                asked += 1
                if not here & options:
                    missing.append((house.seed, room.type, options))
    assert len(missing) <= 0.02 * asked, missing


def test_items_are_inside_their_rooms(houses):
    for house in houses:
        for item in house.items:
            room, rect = house.rooms[item.room], footprint_of(item)
            corners = [(x, y) for x in (rect.x0 + 2e-3, rect.x1 - 2e-3) for y in (rect.y0 + 2e-3, rect.y1 - 2e-3)]
            assert all(room.contains(x, y) for x, y in corners), (house.seed, item.category)
            z = house.floors[item.floor].z_m
            assert z - 1e-6 <= item.z
            assert item.z + item.size[2] <= z + house.floors[item.floor].ceiling_m


def test_items_do_not_overlap(houses):
    for house in houses:
        for room in house.rooms:
            items = [item for item in house.items if item.room == room.id and stand(item) != "flat"]
            for k, a in enumerate(items):
                for b in items[:k]:
                    if a.support == b.id or a.z + 3e-3 > b.z + b.size[2] or b.z + 3e-3 > a.z + a.size[2]:
                        continue
                    assert not overlap(footprint_of(a), footprint_of(b)), (house.seed, a.category, b.category)


def test_things_on_supports_stand_on_them(houses):
    for house in houses:
        by_id = {item.id: item for item in house.items}
        for item in house.items:
            if item.support is None:
                assert stand(item) != "top"
                continue
            support = by_id[item.support]
            top = CATALOGUE[support.category].top_m
            assert top is not None
            assert abs(item.z - support.z - top) < 2e-3
            assert footprint_of(support).contains(item.x, item.y)


def test_nothing_solid_stands_in_doorways_and_all_rooms_stay_reachable(houses):
    for house in houses:
        assert clearance_connected(house, 0.25)
        for opening in house.openings:
            if opening.kind == "window":
                continue
            for item in house.items:
                if item.solid and item.floor == opening.floor:
                    r = footprint_of(item)
                    away = math.hypot(max(r.x0 - opening.x, 0, opening.x - r.x1), max(r.y0 - opening.y, 0, opening.y - r.y1))
                    assert away > 0.35, (house.seed, item.category, opening.id)


def test_open_leaves_keep_their_stretch_of_wall(houses):
    found = 0
    for house in houses:
        for opening in house.openings:
            place = leaf_place(house, opening)
            if place is None:
                continue
            found += 1
            shift = place.side * (opening.width_m + 0.02)
            off = place.face * (house.wall_thickness_m / 2 + 0.05)
            x, y = (opening.x + shift, opening.y + off) if opening.along == "x" else (opening.x + off, opening.y + shift)
            assert house.rooms[place.room].contains(x, y)
            blocking = [
                i
                for i in house.items
                if i.floor == opening.floor and stand(i) != "flat" and i.z - house.floors[i.floor].z_m < 1.9
            ]
            assert not any(footprint_of(item).contains(x, y, 0.01) for item in blocking)
    assert found > 20


def test_instances_of_a_category_usually_differ(houses):
    same = total = 0
    for house in houses:
        for category in ("sofa", "bed", "dresser", "wardrobe", "bookshelf", "armchair", "bathroom sink"):
            words = Counter(item.attributes for item in house.items if item.category == category)
            total += sum(words.values())
            same += sum(count - 1 for count in words.values())
    assert same < 0.25 * total


def test_room_styles_name_materials_for_every_room(houses):
    for house in houses:
        assert len(house.styles) == len(house.rooms)


@pytest.mark.slow
def test_every_category_appears_in_some_house():
    seen: set[str] = set()
    for seed in range(200):
        seen |= {item.category for item in furnish(generate_layout(seed)).items}
    assert seen == set(CATALOGUE)


def _upper_planes(category: str, look: int) -> list[tuple[int, float, np.ndarray, str]]:
    """Axis-aligned triangles of a design that do not face down: axis with sign, offset, corners in the plane, material."""
    found = []
    for part in design(category, look).parts:
        triangles = part_triangles(part)
        corners = triangles.points[triangles.faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(across, axis=1)
        for k in np.flatnonzero((area > 2e-5) & (np.abs(across).max(axis=1) > 0.9999 * area)):
            axis = int(np.abs(across[k]).argmax())
            side = axis + 1 if across[k, axis] > 0 else -axis - 1
            if side != -3:
                found.append((side, float(corners[k, 0, axis]), np.delete(corners[k], axis, 1), part.material))
    return found


@pytest.mark.parametrize("category", sorted(CATALOGUE))
def test_no_two_materials_share_a_plane(category):
    # such faces fight for every pixel
    for look in {(look.main == look.trim): k for k, look in enumerate(CATALOGUE[category].looks)}.values():
        planes = sorted(_upper_planes(category, look), key=lambda plane: plane[:2])
        if not planes:
            continue
        place = np.array([10.0 * side + offset for side, offset, _, _ in planes])
        low, high = (np.array([getattr(corners, end)(axis=0) for _, _, corners, _ in planes]) for end in ("min", "max"))
        stuff = np.array([plane[3] for plane in planes])
        for k, (_, _, corners, _) in enumerate(planes):
            gap = (np.minimum(high[k], high) - np.maximum(low[k], low)).min(axis=1)
            near = (np.abs(place - place[k]) < 0.0005) & (gap > 0.002) & (stuff != stuff[k])
            for other in np.flatnonzero(near[k + 1 :]) + k + 1:
                pair = [100 * (c - low[k]).astype(np.float32) for c in (corners, planes[other][2])]
                shared, _ = cv2.intersectConvexConvex(*pair)
                assert shared < 0.5, (look, stuff[k], stuff[other], f"{shared:.2f} cm2")
