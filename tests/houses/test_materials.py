import numpy as np
import pytest

from spacevln.core.errors import UnknownNameError
from spacevln.environments.houses.furniture import CATALOGUE, design
from spacevln.environments.houses.furniture.styles import FLOORS, WALLS
from spacevln.environments.houses.layout import ROOM_TYPES
from spacevln.environments.houses.materials import COLOURS, material, texture
from spacevln.environments.houses.materials.patterns import PATTERNS
from spacevln.environments.houses.materials.pictures import PICTURES


def used_materials() -> set[str]:
    keys = {
        part.material for name, kind in CATALOGUE.items() for look in range(len(kind.looks)) for part in design(name, look).parts
    }
    return keys | {key for styles in (FLOORS, WALLS) for options in styles.values() for key in options}


def test_every_used_material_exists_with_a_small_texture():
    for key in sorted(used_materials()):
        image = texture(material(key).texture)
        assert image.dtype == np.uint8
        assert image.ndim == 3
        assert image.shape[2] == 3
        assert max(image.shape[:2]) <= 256


def test_textures_are_repeatable():
    for name in [*PATTERNS, *(f"{picture}-1" for picture in PICTURES), "wall-damask-sage"]:
        before = texture(name).copy()
        texture.cache_clear()
        assert np.array_equal(before, texture(name)), name


def test_palette_addresses_every_flat_colour():
    image = texture("palette")
    height, width = image.shape[:2]
    for colour, rgb in COLOURS.items():
        u, v = material(f"plain-{colour}").palette_uv
        assert tuple(image[int((1 - v) * height), int(u * width)]) == rgb


def test_patterns_are_neither_black_nor_burnt_out():
    for name in PATTERNS:
        assert 90 < texture(name).mean() < 252, name


@pytest.mark.parametrize("key", ["plain-octarine", "velvet-red", "wall-bamboo-red", "painting-x", "nothing"])
def test_unknown_names_are_refused(key):
    with pytest.raises(UnknownNameError):
        material(key)


def test_every_room_type_has_styles():
    assert set(FLOORS) == set(WALLS) == set(ROOM_TYPES)
