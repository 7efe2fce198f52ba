"""Contact sheets: crops of every category and views of rooms, for looking at them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core.geometry import Float
from spacevln.core.sensing import Camera
from spacevln.environments.houses.furniture.kit import CATALOGUE, design
from spacevln.environments.houses.furniture.walls import footprint_of
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.plan import Floor, House, Item, Rect, Room
from spacevln.environments.houses.rendering.choice import make_renderer, renderer_info
from spacevln.environments.houses.rendering.protocol import Drawable
from spacevln.environments.houses.scene import compile_scene

_STAGE_M = 11.0
Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class View:
    """A camera in a house that shows something.

    Args:
        name: what it shows.
        T_scene_camera: (4, 4), camera frame (x along the optical axis, y left, z up) to the scene.
        camera: intrinsics.
    """

    name: str
    T_scene_camera: Float
    camera: Camera


def look_at(eye: tuple[float, float, float], target: tuple[float, float, float]) -> Float:
    """Camera frame at ``eye`` turned to ``target``."""
    forward = np.array(target, float) - np.array(eye, float)
    forward /= np.linalg.norm(forward)
    left = np.cross([0.0, 0.0, 1.0], forward)
    left /= np.linalg.norm(left)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = forward, left, np.cross(forward, left), eye
    return T


def stage(category: str, look: int = 0, form: int = 0) -> tuple[House, View]:
    """One object alone in a plain room, and a camera that frames it from its front, a little from the side and above."""
    made = design(category, look, form)
    stand = CATALOGUE[category].stand
    half = _STAGE_M / 2
    z = {"wall": min(1.2, 2.55 - made.size[2]), "ceiling": 2.58 - made.size[2], "top": 0.75}.get(stand, 0.002)
    y = -half + made.size[1] / 2 + 0.003 if stand == "wall" else 0.0
    items = [Item(1, category, made.attributes, 0, 0, 0.0, y, z, 0.0, made.size, made.parts, True)]
    if stand == "top":
        table = design("console table", 0, 0)
        items.append(
            Item(2, "console table", table.attributes, 0, 0, 0.0, 0.0, z - table.size[2] - 0.001, 0.0, table.size, table.parts)
        )
    room = Room(0, "office", 0, (Rect(-half, -half, half, half),))
    house = House(0, (Floor(0, 0.0, 2.6),), (room,), (), (), tuple(items), styles=(("planks-maple", "wall-paint-ivory"),))
    centre = (0.0, y, z + made.size[2] / 2)
    radius = 0.5 * math.dist((0, 0, 0), made.size)
    camera = Camera(width_px=256, height_px=256, hfov_deg=46.0, height_m=0.88)
    away = max(0.5, radius / math.tan(math.radians(46.0 / 2)) * 1.1)
    side, rise = (0.25, -0.05) if stand in ("wall", "ceiling") else (0.55, 0.42)
    direction = np.array([side, 1.0, rise])
    eye = np.array(centre) + direction / np.linalg.norm(direction) * away
    return house, View(category, look_at((float(eye[0]), float(eye[1]), float(eye[2])), centre), camera)


def room_views(house: House, room: Room, space: Walkable, count: int = 2, camera: Camera | None = None) -> list[View]:
    """Views of a room at the agent's eye height from where the agent can stand: the places that see most of it, far apart.

    Args:
        house: that the room is in.
        room: to be seen.
        space: of this house.
        count: how many views.
        camera: by default 640 by 480 with 79 degrees.
    """
    seen = camera or Camera(width_px=640, height_px=480, hfov_deg=79.0, height_m=0.88)
    z = house.floors[room.floor].z_m
    rect = max(room.rects, key=lambda r: r.area)
    cx, cy = rect.centre
    xs, ys = np.linspace(rect.x0 + 0.3, rect.x1 - 0.3, 9), np.linspace(rect.y0 + 0.3, rect.y1 - 0.3, 9)
    places = [(float(x), float(y)) for x in xs for y in ys if space.is_walkable(float(x), float(y), z, 0.25)]
    chosen: list[tuple[float, float]] = []
    while places and len(chosen) < count:
        best = max(
            places,
            key=lambda p: (
                min([math.dist(p, (cx, cy)), *(math.dist(p, c) for c in chosen)]) - 0.5 * _blocked(house, room, p, (cx, cy))
            ),
        )
        chosen.append(best)
        places.remove(best)
    height = z + seen.height_m
    return [View(room.type, look_at((x, y, height), (cx, cy, height)), seen) for x, y in chosen]


def _blocked(house: House, room: Room, eye: tuple[float, float], target: tuple[float, float]) -> int:
    """How many of the nearest points on the way to the target lie in front of something as high as the eye."""
    tall = [footprint_of(item) for item in house.items if item.room == room.id and item.solid and item.size[2] > 0.8]
    length = max(math.dist(eye, target), 1e-6)
    found = 0
    for reach in (0.3, 0.5, 0.7, 0.9, 1.1):
        share = min(reach / length, 1.0)
        x, y = eye[0] + (target[0] - eye[0]) * share, eye[1] + (target[1] - eye[1]) * share
        found += any(rect.contains(x, y, -0.25) for rect in tall)
    return found


def grid(images: list[Image], columns: int, margin_px: int = 4) -> Image:
    """Images of one size on a white sheet, row by row."""
    height, width = images[0].shape[:2]
    rows = -(-len(images) // columns)
    sheet = np.full((rows * (height + margin_px), columns * (width + margin_px), 3), 255, np.uint8)
    for k, image in enumerate(images):
        i, j = divmod(k, columns)
        sheet[i * (height + margin_px) :, j * (width + margin_px) :][:height, :width] = image
    return sheet


def render_views(house: House, views: Sequence[View], renderer: str = "auto") -> list[Image]:
    """Pictures of a house.

    Args:
        house: furnished.
        views: what to see.
        renderer: ``"auto"``, ``"gl"`` or ``"raycast"``.

    Raises:
        PrerequisiteError: OpenGL is demanded and there is none.
    """
    compiled = compile_scene(house)
    width, height = max(view.camera.width_px for view in views), max(view.camera.height_px for view in views)
    drawn = make_renderer(renderer_info(renderer), Drawable(house, compiled.model, compiled.geom_instance), width, height)
    try:
        return [drawn.render(view.T_scene_camera, view.camera).rgb for view in views]
    finally:
        drawn.close()


def category_sheet(
    rng: np.random.Generator, categories: Sequence[str] | None = None, columns: int = 6, renderer: str = "auto"
) -> tuple[Image, tuple[str, ...]]:
    """An unlabelled sheet of shuffled categories in random looks, and what it shows, row by row."""
    names = list(CATALOGUE) if categories is None else list(categories)
    shown = [names[int(k)] for k in rng.permutation(len(names))]
    crops = []
    for name in shown:
        house, view = stage(name, int(rng.integers(len(CATALOGUE[name].looks))), int(rng.integers(3)))
        crops += render_views(house, [view], renderer)
    return grid(crops, columns), tuple(shown)


def room_sheet(house: House, renderer: str = "auto", columns: int = 2) -> tuple[Image, tuple[str, ...]]:
    """Two views of every room of a house side by side, and the rooms' types, row by row."""
    space = Walkable(house)
    pairs = [(room.type, room_views(house, room, space)) for room in house.rooms]
    pairs = [(name, views) for name, views in pairs if len(views) == 2]
    images = render_views(house, [view for _, views in pairs for view in views], renderer)
    doubles = [np.hstack(images[k : k + 2]) for k in range(0, len(images), 2)]
    return grid(doubles, columns), tuple(name for name, _ in pairs)
