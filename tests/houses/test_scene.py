import math

import mujoco
import numpy as np
import pytest

from spacevln.environments.houses.furniture import furnish
from spacevln.environments.houses.layout import generate_layout
from spacevln.environments.houses.plan import House
from spacevln.environments.houses.scene import CompiledScene, compile_scene


def two_storeys() -> int:
    return next(seed for seed in range(100) if generate_layout(seed).stairs)


@pytest.fixture(scope="module")
def built() -> list[tuple[House, CompiledScene]]:
    houses = [furnish(generate_layout(seed)) for seed in (0, 5, two_storeys())]
    return [(house, compile_scene(house)) for house in houses]


def hit(scene: CompiledScene, point: tuple[float, float, float], direction: tuple[float, float, float]) -> tuple[int, float]:
    """Instance and distance of the first surface along a ray."""
    data = mujoco.MjData(scene.model)
    mujoco.mj_kinematics(scene.model, data)
    geom = np.full(1, -1, np.int32)
    distance = mujoco.mj_ray(scene.model, data, np.array(point), np.array(direction, float), None, 1, -1, geom)
    return (-1 if geom[0] < 0 else int(scene.geom_instance[geom[0]])), float(distance)


def test_arrays_belong_to_the_geoms_of_the_model(built):
    for house, scene in built:
        n = scene.model.ngeom
        assert len(scene.geom_instance) == len(scene.geom_room) == len(scene.pieces) == n
        known = {0} | {x.id for x in (*house.items, *house.openings, *house.stairs)}
        assert set(scene.geom_instance.tolist()) == known
        assert set(scene.geom_room.tolist()) <= {-1, *range(len(house.rooms))}


def test_scenes_are_lean(built):
    for _, scene in built:
        assert scene.model.ngeom < 1200
        assert scene.model.ntex < 120
        assert max(scene.model.tex_width) <= 256
        assert not scene.model.light_castshadow.any()
        assert not scene.model.mat_reflectance.any()


def test_geoms_are_where_their_pieces_are(built):
    house, scene = built[0]
    data = mujoco.MjData(scene.model)
    mujoco.mj_kinematics(scene.model, data)
    for geom in range(0, scene.model.ngeom, 7):
        piece = scene.pieces[geom]
        c, s = math.cos(piece.yaw_rad), math.sin(piece.yaw_rad)
        world = piece.triangles.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + np.array(piece.position_m)
        mesh = scene.model.geom_dataid[geom]
        start, count = scene.model.mesh_vertadr[mesh], scene.model.mesh_vertnum[mesh]
        drawn = scene.model.mesh_vert[start : start + count] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        assert np.allclose(drawn.min(axis=0), world.min(axis=0), atol=1e-4)
        assert np.allclose(drawn.max(axis=0), world.max(axis=0), atol=1e-4)
    assert house.items


def test_one_stands_on_floors_under_ceilings(built):
    for house, scene in built:
        for room in house.rooms:
            x, y = room.centre
            if any(stairs.rect.contains(x, y, -0.2) for stairs in house.stairs):
                continue
            floor = house.floors[room.floor]
            _, down = hit(scene, (x, y, floor.z_m + floor.ceiling_m - 0.01), (0, 0, -1))
            assert 0 <= down <= floor.ceiling_m + 1e-3
            if room.type != "balcony":
                _, up = hit(scene, (x, y, floor.z_m + 0.01), (0, 0, 1))
                assert 0 <= up <= floor.ceiling_m + 1e-3


def test_one_looks_through_doorways_and_not_through_walls(built):
    for house, scene in built:
        for opening in house.openings:
            z = house.floors[opening.floor].z_m + (opening.sill_m + opening.head_m) / 2
            off = 0.3
            across = (0.0, 1.0, 0.0) if opening.along == "x" else (1.0, 0.0, 0.0)
            start = (opening.x - off * across[0] + 0.03, opening.y - off * across[1] + 0.03, z)
            instance, distance = hit(scene, start, across)
            if opening.kind == "window":
                assert 0 <= distance < 2 * off
            else:
                assert instance == -1 or distance > off + house.wall_thickness_m / 2 or instance not in (0, opening.id)


def test_every_opening_has_a_visible_casing_on_both_faces(built):
    for house, scene in built:
        for opening in house.openings:
            if opening.kind == "window":
                continue
            z = house.floors[opening.floor].z_m + 0.5
            for face in (-1, 1):
                for side in (-1, 1):
                    shift, off = side * (opening.width_m / 2 + 0.03), face * 0.16
                    x, y = (opening.x + shift, opening.y + off) if opening.along == "x" else (opening.x + off, opening.y + shift)
                    toward = (0.0, -face, 0.0) if opening.along == "x" else (-face, 0.0, 0.0)
                    instance, distance = hit(scene, (x, y, z), toward)
                    if house.room_at(x, y, opening.floor) is not None:
                        assert instance == opening.id, (house.seed, opening.id, face, side)
                        assert distance < 0.1


def test_items_are_hit_from_above(built):
    house, scene = built[1]
    missed = 0
    items = [item for item in house.items if item.solid]
    for item in items:
        instance, distance = hit(scene, (item.x, item.y, item.z + item.size[2] + 0.02), (0, 0, -1))
        missed += not (instance == item.id or distance > 0)
    assert missed == 0


def test_same_house_same_model():
    house = furnish(generate_layout(4))
    a, b = compile_scene(house), compile_scene(house)
    assert np.array_equal(a.model.mesh_vert, b.model.mesh_vert)
    assert np.array_equal(a.model.geom_pos, b.model.geom_pos)
    assert np.array_equal(a.model.tex_data, b.model.tex_data)


def test_shadows_lie_on_the_floor_of_their_room_and_belong_to_no_thing(built):
    for house, scene in built:
        shadows = [piece for piece in scene.pieces if "shadow" in piece.stuff.key]
        assert {piece.room for piece in shadows} >= {item.room for item in house.items if item.solid}
        for piece in shadows:
            assert piece.instance == 0
            assert piece.room is not None
            room = house.rooms[piece.room]
            height = piece.triangles.points[:, 2] - house.floors[room.floor].z_m
            assert 0.0005 < height.min() == height.max() < 0.003
            corners = piece.triangles.points[piece.triangles.faces]
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            assert (across[:, 2] > -1e-9).all()
            half = house.wall_thickness_m / 2 + 1e-9
            for x, y, _ in piece.triangles.points:
                assert any(rect.contains(x, y, -half) for rect in room.rects)
