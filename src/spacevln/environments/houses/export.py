"""A house as one glTF file (.glb), so that other programs and simulators can load it."""

from __future__ import annotations

import importlib
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from spacevln.core.errors import PrerequisiteError, UsageError
from spacevln.environments.houses.materials import Material, texture
from spacevln.environments.houses.plan import House
from spacevln.environments.houses.scene import scene_pieces
from spacevln.environments.houses.scene.pieces import Piece

GLTF_FROM_SCENE = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""glTF is y-up: (x, y, z) of the scene becomes (x, z, -y)."""


def export_glb(house: House, path: Path) -> Path:
    """Write a furnished house with textures; node names carry the instance id and category, e.g. ``"17 sofa 0"``.

    Args:
        house: furnished.
        path: of the file; its folder exists.

    Raises:
        PrerequisiteError: the extra ``export`` is not installed.
        UsageError: the file cannot be written.
    """
    trimesh = load_trimesh()
    scene = trimesh.Scene()
    names = {item.id: item.category for item in house.items}
    names |= {opening.id: opening.kind for opening in house.openings}
    names |= {stairs.id: "stairs" for stairs in house.stairs}
    materials: dict[str, Any] = {}
    for index, piece in enumerate(scene_pieces(house)):
        if piece.stuff.draw not in materials:
            materials[piece.stuff.draw] = _material(trimesh, piece.stuff)
        mesh = trimesh.Trimesh(
            vertices=piece.triangles.points,
            faces=piece.triangles.faces,
            vertex_normals=piece.triangles.normals,
            visual=trimesh.visual.TextureVisuals(uv=piece.triangles.uv, material=materials[piece.stuff.draw]),
            process=False,
        )
        label = f"{piece.instance} {names.get(piece.instance, 'structure')} {index}"
        scene.add_geometry(mesh, node_name=label, geom_name=label, transform=GLTF_FROM_SCENE @ placed(piece))
    try:
        path.write_bytes(scene.export(file_type="glb"))
    except OSError as error:
        raise UsageError(f"{str(path)!r} cannot be written ({error.strerror}): give a file that you may write.") from error
    return path


def placed(piece: Piece) -> NDArray[np.float64]:
    """T_scene_piece (4, 4)."""
    c, s = math.cos(piece.yaw_rad), math.sin(piece.yaw_rad)
    x, y, z = piece.position_m
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1.0]])


def _material(trimesh: Any, stuff: Material) -> Any:
    return trimesh.visual.material.PBRMaterial(
        name=stuff.draw,
        baseColorTexture=Image.fromarray(texture(stuff.texture)),
        baseColorFactor=[*(round(255 * channel) for channel in stuff.rgb), 255],
        metallicFactor=0.0,
        roughnessFactor=1.0 - 0.7 * stuff.specular,
    )


def load_trimesh() -> Any:
    """The library that writes glTF.

    Raises:
        PrerequisiteError: it is not installed.
    """
    try:
        return importlib.import_module("trimesh")
    except ImportError as error:
        raise PrerequisiteError('Writing .glb files needs trimesh: install it with `pip install "spacevln[export]"`.') from error
