import numpy as np

from spacevln.core.sensing import Camera
from spacevln.environments.houses.furniture import furnish
from spacevln.environments.houses.furniture.sheets import category_sheet, grid, render_views, room_views
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.layout import generate_layout

SMALL = Camera(width_px=64, height_px=48, hfov_deg=79.0, height_m=0.88)


def test_category_sheet_shows_every_category_once_in_a_seeded_order():
    names = ("sofa", "painting", "table lamp", "chandelier", "rug")
    image, shown = category_sheet(np.random.default_rng(3), names, columns=3, renderer="raycast")
    assert sorted(shown) == sorted(names)
    assert image.shape == (2 * 260, 3 * 260, 3)
    again, order = category_sheet(np.random.default_rng(3), names, columns=3, renderer="raycast")
    assert order == shown
    assert np.array_equal(image, again)
    crops = [image[i * 260 : i * 260 + 256, j * 260 : j * 260 + 256] for i in range(2) for j in range(3)][: len(names)]
    # each crop shows the thing, not a bare wall
    assert all(crop.std() > 8 for crop in crops)


def test_room_views_are_taken_from_where_one_can_stand():
    house = furnish(generate_layout(6))
    space = Walkable(house)
    for room in house.rooms:
        for view in room_views(house, room, space, 2, SMALL):
            x, y, z = view.T_scene_camera[:3, 3]
            assert room.contains(x, y)
            assert space.is_walkable(x, y, z - SMALL.height_m, 0.25)
            assert np.allclose(view.T_scene_camera[:3, :3].T @ view.T_scene_camera[:3, :3], np.eye(3), atol=1e-9)


def test_rooms_are_neither_dark_nor_flat():
    house = furnish(generate_layout(6))
    space = Walkable(house)
    views = [view for room in house.rooms for view in room_views(house, room, space, 1, SMALL)]
    for view, image in zip(views, render_views(house, views, "raycast"), strict=True):
        assert 60 < image.mean() < 235, view.name
        assert image.std() > 8, view.name
        assert (image.max(axis=2) < 12).mean() < 0.3, view.name


def test_grid_keeps_images_apart():
    sheet = grid([np.zeros((4, 6, 3), np.uint8)] * 3, 2, margin_px=2)
    assert sheet.shape == (12, 16, 3)
    assert (sheet[4:6] == 255).all()
