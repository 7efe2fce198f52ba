"""A house as Habitat-Sim loads it: the furnished house, a semantic copy of it, what its colours mean, and how to stand it up.

File formats: Habitat-Sim's stage and scene dataset configurations, and HM3D's semantic annotations (a texture with a
colour for each instance, and a text file of id, colour, name and room).
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from spacevln.core.errors import UsageError
from spacevln.core.geometry import Float
from spacevln.environments.houses.export import GLTF_FROM_SCENE, export_glb, load_trimesh, placed
from spacevln.environments.houses.labels import house_labels
from spacevln.environments.houses.plan import House
from spacevln.environments.houses.scene import scene_pieces

DATASET_FILE = "houses.scene_dataset_config.json"
_STAGE_UP, _STAGE_FRONT = (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)
_BLOCK_PX = 4
"""Side of an instance's block in the texture, so that no filter mixes two."""
_COLOUR_STEP, _COLOURS = 0x9E3779, 1 << 24


def export_for_habitat(house: House, folder: Path) -> Path:
    """Write ``houses/<name>/<name>.glb`` with its stage configuration and its semantic annotations.

    Args:
        house: furnished.
        folder: of all scenes; ``houses.scene_dataset_config.json`` in it lists every house that is written there.

    Returns:
        The .glb file.

    Raises:
        PrerequisiteError: the extra ``export`` is not installed.
        UsageError: a file cannot be written.
    """
    home = folder / "houses" / house.name
    try:
        home.mkdir(parents=True, exist_ok=True)
        path = export_glb(house, home / f"{house.name}.glb")
        (home / f"{house.name}.semantic.glb").write_bytes(_semantic_glb(house))
        (home / f"{house.name}.semantic.txt").write_text("\n".join(_annotations(house)) + "\n", encoding="utf-8")
        _write_json(home / f"{house.name}.stage_config.json", _stage(house.name))
        _write_json(folder / DATASET_FILE, {"stages": {"paths": {".json": ["houses/*"]}}})
    except OSError as error:
        raise UsageError(f"{str(home)!r} cannot be written ({error.strerror}): give a folder that you may write.") from error
    return path


def semantic_colour(instance: int) -> tuple[int, int, int]:
    """Red, green and blue of an instance: another for each, far apart for neighbours; black for the structure, 0."""
    value = instance * _COLOUR_STEP % _COLOURS  # an odd step reaches every colour once
    return value >> 16, value >> 8 & 255, value & 255


def _stage(name: str) -> dict[str, Any]:
    return {
        "render_asset": f"{name}.glb",
        "semantic_asset": f"{name}.semantic.glb",
        "semantic_descriptor_filename": f"{name}.semantic.txt",
        "has_semantic_textures": True,
        "up": _STAGE_UP,
        "front": _STAGE_FRONT,
        "semantic_up": _STAGE_UP,
        "semantic_front": _STAGE_FRONT,
        "force_flat_shading": True,
    }


def _annotations(house: House) -> Iterator[str]:
    """HM3D's lines; attributes stand in brackets behind the name, as HM3D has no place for them."""
    rooms = {item.id: item.room for item in house.items}
    yield "HM3D Semantic Annotations"
    for instance, label in sorted(house_labels(house).items()):
        words = f"{label.category} ({' '.join(label.attributes)})" if label.attributes else label.category
        yield f'{instance},{"".join(f"{part:02X}" for part in semantic_colour(instance))},"{words}",{rooms.get(instance, 0)}'


def _semantic_glb(house: House) -> bytes:
    """Every triangle of the house, coloured by what it belongs to."""
    trimesh = load_trimesh()
    pieces = scene_pieces(house)
    row = {instance: k for k, instance in enumerate(sorted({piece.instance for piece in pieces}))}
    colours = np.array([semantic_colour(instance) for instance in row], np.uint8)
    picture = Image.fromarray(colours[:, None].repeat(_BLOCK_PX, 0).repeat(_BLOCK_PX, 1))
    points, faces, uv, count = [], [], [], 0
    for piece in pieces:
        T_gltf_piece = GLTF_FROM_SCENE @ placed(piece)
        corners: Float = piece.triangles.points @ T_gltf_piece[:3, :3].T + T_gltf_piece[:3, 3]
        points.append(corners)
        faces.append(piece.triangles.faces + count)
        uv.append(np.tile([0.5, 1 - (row[piece.instance] + 0.5) / len(row)], (len(corners), 1)))
        count += len(corners)
    material = trimesh.visual.material.PBRMaterial(name="instances", baseColorTexture=picture, metallicFactor=0.0)
    mesh = trimesh.Trimesh(
        vertices=np.concatenate(points),
        faces=np.concatenate(faces),
        visual=trimesh.visual.TextureVisuals(uv=np.concatenate(uv), material=material),
        process=False,
    )
    data: bytes = trimesh.Scene(mesh).export(file_type="glb")
    return data


def _write_json(path: Path, content: dict[str, Any]) -> None:
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
