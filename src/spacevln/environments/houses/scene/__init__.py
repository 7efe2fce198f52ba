"""From a house to a MuJoCo model: few geoms, because everything of one look within an item or a room is one mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from spacevln.environments.houses.furniture.mesh import Triangles
from spacevln.environments.houses.materials import Material, texture
from spacevln.environments.houses.plan import House
from spacevln.environments.houses.scene.openings import opening_pieces
from spacevln.environments.houses.scene.pieces import Piece, item_pieces
from spacevln.environments.houses.scene.shadows import shadow_pieces
from spacevln.environments.houses.scene.structure import lawn_pieces, slab_pieces, stair_pieces, wall_pieces

_AMBIENT = 0.44
_HEADLIGHT = 0.2
_LIGHTS = (((0.45, 0.25, -1.0), 0.34), ((-0.6, -0.9, -0.25), 0.16), ((0.9, -0.5, 0.1), 0.1))
"""Directions and strengths: from above, and two weak ones that tell walls apart."""


@dataclass(frozen=True, slots=True, eq=False)
class CompiledScene:
    """A house as a MuJoCo model of static geoms.

    Args:
        model: geom k draws ``pieces[k]``.
        geom_instance: (ngeom,) int32, instance id of every geom, 0 = structure.
        geom_room: (ngeom,) int32, id of the room that a geom is in, -1 = between or outside rooms.
        pieces: the triangles and materials, for export.
    """

    model: mujoco.MjModel
    geom_instance: NDArray[np.int32]
    geom_room: NDArray[np.int32]
    pieces: tuple[Piece, ...]


def scene_pieces(house: House) -> tuple[Piece, ...]:
    """Everything that is drawn of a house, in a fixed order."""
    pieces = [*wall_pieces(house), *slab_pieces(house), *shadow_pieces(house), *stair_pieces(house), *lawn_pieces(house)]
    for opening in house.openings:
        pieces += opening_pieces(house, opening)
    for item in house.items:
        pieces += item_pieces(item)
    return tuple(pieces)


def compile_scene(house: House) -> CompiledScene:
    """Compile a furnished house.

    Args:
        house: with ``styles`` for every room.
    """
    pieces = scene_pieces(house)
    spec = mujoco.MjSpec()
    _settings(spec)
    meshes: dict[object, str] = {}
    materials: dict[str, str] = {}
    textures: set[str] = set()
    for index, piece in enumerate(pieces):
        stuff = piece.stuff
        if stuff.draw not in materials:
            _add_material(spec, stuff, textures)
            materials[stuff.draw] = stuff.draw
        shape = piece.shape if piece.shape is not None else index
        mesh = meshes.get(shape)  # hashed once: a shape is long
        if mesh is None:
            mesh = meshes[shape] = f"mesh{index}"
            _add_mesh(spec, mesh, piece.triangles)
        half = piece.yaw_rad / 2
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=mesh,
            material=stuff.draw,
            pos=piece.position_m,
            quat=(math.cos(half), 0.0, 0.0, math.sin(half)),
            contype=0,
            conaffinity=0,
        )
    model = spec.compile()
    return CompiledScene(
        model,
        np.array([piece.instance for piece in pieces], np.int32),
        np.array([-1 if piece.room is None else piece.room for piece in pieces], np.int32),
        pieces,
    )


def _settings(spec: mujoco.MjSpec) -> None:
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 0
    spec.visual.headlight.ambient[:] = _AMBIENT
    spec.visual.headlight.diffuse[:] = _HEADLIGHT
    spec.visual.headlight.specular[:] = 0.1
    for direction, strength in _LIGHTS:
        spec.worldbody.add_light(
            type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
            dir=direction,
            diffuse=(strength, strength, strength),
            ambient=(0.0, 0.0, 0.0),
            specular=(0.05, 0.05, 0.05),
            castshadow=False,
        )


def _add_material(spec: mujoco.MjSpec, stuff: Material, textures: set[str]) -> None:
    if stuff.texture not in textures:
        textures.add(stuff.texture)
        image = texture(stuff.texture)
        made = spec.add_texture(
            name=stuff.texture, type=mujoco.mjtTexture.mjTEXTURE_2D, width=image.shape[1], height=image.shape[0], nchannel=3
        )
        # MuJoCo's first row is at v = 0, the bottom
        made.data = np.ascontiguousarray(image[::-1]).tobytes()
    made_material = spec.add_material(
        name=stuff.draw,
        rgba=(*stuff.rgb, 1.0),
        specular=stuff.specular,
        shininess=stuff.shininess,
        emission=stuff.emission,
        reflectance=0.0,
    )
    made_material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = stuff.texture


def _add_mesh(spec: mujoco.MjSpec, name: str, triangles: Triangles) -> None:
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    # lists go into the bindings twice as fast as arrays; without indices of their own, normals and uv share the faces'
    mesh.uservert = triangles.points.ravel().tolist()
    mesh.usernormal = triangles.normals.ravel().tolist()
    mesh.usertexcoord = triangles.uv.ravel().tolist()
    mesh.userface = triangles.faces.ravel().tolist()
