"""What client and worker say to each other, whichever simulator the worker runs.

Frame: Habitat's (x right, y up, -z forward), metres; rotations are [x, y, z, w].

Point arrays travel as bytes of little-endian float64, (N, 3) row by row (:func:`pack`, :func:`unpack`).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Dict, Tuple, Type, Union, get_type_hints

import numpy as np

PROTOCOL = 2
"""Raised by every change of a message; both ends must have the same."""

Vector = Tuple[float, ...]


class MessageError(ValueError):
    """Bytes that are no message of this protocol."""


@dataclass(frozen=True)
class Hello:
    """Client, first: which protocol, over TCP the token, and which simulator, "habitat" or "gn-bench"."""

    protocol: int
    token: str
    simulator: str


@dataclass(frozen=True)
class Welcome:
    """Worker: it is ready, and what it runs on."""

    protocol: int
    python: str
    simulator: str
    process: int


@dataclass(frozen=True)
class Ping:
    """Client asks whether the worker is there."""


@dataclass(frozen=True)
class Pong:
    """Worker: yes."""


@dataclass(frozen=True)
class Open:
    """Client: load a scene in Habitat-Sim. Everything that decides what an episode in it is like is said here.

    ``scene_dataset`` and ``cache`` may be empty: no scene dataset; navigation meshes are not kept. ``labels`` asks for
    the semantic sensor.
    """

    scene: str
    scene_dataset: str
    cache: str
    width_px: int
    height_px: int
    hfov_deg: float
    camera_height_m: float
    agent_height_m: float
    agent_radius_m: float
    cell_size_m: float
    cell_height_m: float
    max_climb_m: float
    max_slope_deg: float
    step_m: float
    turn_deg: float
    sliding: bool
    gpu_device: int
    seed: int
    labels: bool


@dataclass(frozen=True)
class Opened:
    """Worker: the scene is loaded, and its navigation mesh is the one that was asked for.

    ``mesh_source`` is "computed" or "cached"; ``mesh_digest`` is of the saved mesh, empty where none was saved.
    """

    mesh_area_m2: float
    mesh_source: str
    mesh_digest: str
    mesh_settings: Dict[str, float]
    categories: Dict[int, str]


@dataclass(frozen=True)
class OpenSplats:
    """Client: load a scene of Gaussian splats, a folder, in GN-Bench's simulator.

    ``hfov_deg`` is the horizontal field of view as it is drawn.
    """

    scene: str
    width_px: int
    height_px: int
    hfov_deg: float
    camera_height_m: float
    step_m: float
    turn_deg: float
    gpu_device: int
    seed: int


@dataclass(frozen=True)
class SplatsOpened:
    """Worker: the scene is loaded."""

    gaussians: int


@dataclass(frozen=True)
class Place:
    """Client: put the body here; nothing is snapped."""

    position: Vector
    rotation: Vector


@dataclass(frozen=True)
class Act:
    """Client: one primitive, "move_forward", "turn_left" or "turn_right"."""

    action: str


@dataclass(frozen=True)
class View:
    """Worker: where body and camera are after Place or Act; the image is in shared memory, or here.

    ``image`` is rgba, depth and labels one after the other (:mod:`.images`), empty where they are in shared memory.
    """

    position: Vector
    rotation: Vector
    camera_position: Vector
    camera_rotation: Vector
    collided: bool
    image: bytes


@dataclass(frozen=True)
class Distances:
    """Client: geodesic distance of each position to its nearest target."""

    positions: bytes
    targets: bytes


@dataclass(frozen=True)
class Path:
    """Client: the shortest way from a position to its nearest target."""

    start: Vector
    targets: bytes


@dataclass(frozen=True)
class Moves:
    """Client: how far it is to the nearest target after each of some straight moves from a position."""

    start: Vector
    ends: bytes
    targets: bytes


@dataclass(frozen=True)
class Numbers:
    """Worker: distances [m], ``inf`` where there is no way."""

    values: Vector


@dataclass(frozen=True)
class Points:
    """Worker: points of a path, none where there is no way."""

    points: bytes


@dataclass(frozen=True)
class Failed:
    """Worker: the request failed. ``kind`` is "prerequisite", "usage", or "simulator"; ``sentence`` is for people."""

    kind: str
    sentence: str


@dataclass(frozen=True)
class Bye:
    """Client: end."""


Message = Union[
    Hello, Welcome, Ping, Pong, Open, Opened, OpenSplats, SplatsOpened, Place, Act, View,
    Distances, Path, Moves, Numbers, Points, Failed, Bye,
]  # fmt: skip
KINDS: Dict[str, Type[Any]] = {kind.__name__: kind for kind in Message.__args__}  # type: ignore[attr-defined]
_TYPES: Dict[str, Dict[str, Any]] = {name: get_type_hints(kind) for name, kind in KINDS.items()}


def encode(message: Message) -> Tuple[str, Dict[str, Any]]:
    """A message as plain values."""
    fields = {field.name: getattr(message, field.name) for field in dataclasses.fields(message)}
    return type(message).__name__, fields


def decode(content: Any) -> Message:
    """The message that plain values say.

    Raises:
        MessageError: they say none.
    """
    if not (isinstance(content, (list, tuple)) and len(content) == 2 and content[0] in KINDS and isinstance(content[1], dict)):
        raise MessageError("neither kind nor fields of a message")
    name, fields = content
    types = _TYPES[name]
    if set(fields) != set(types):
        raise MessageError(f"{name} has the fields {sorted(types)}, not {sorted(map(str, fields))}")
    return KINDS[name](**{key: _checked(name, key, fields[key], kind) for key, kind in types.items()})  # type: ignore[no-any-return]


def _checked(name: str, key: str, value: Any, kind: Any) -> Any:
    if kind == Vector and isinstance(value, (list, tuple)) and all(isinstance(each, (int, float)) for each in value):
        return tuple(map(float, value))
    if kind == Dict[str, float] and isinstance(value, dict):
        return {str(each): float(number) for each, number in value.items()}
    if kind == Dict[int, str] and isinstance(value, dict):
        return {int(number): str(each) for number, each in value.items()}
    if kind is float and isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    if isinstance(kind, type) and type(value) is kind:
        return value
    raise MessageError(f"{name}.{key} cannot be a {type(value).__name__}")


def pack(points: Any) -> bytes:
    """Points (N, 3) as bytes."""
    return np.ascontiguousarray(points, dtype="<f8").reshape(-1, 3).tobytes()


def unpack(data: bytes) -> Any:
    """Points (N, 3) float64.

    Raises:
        MessageError: the bytes are no such array.
    """
    if len(data) % 24:
        raise MessageError(f"{len(data)} bytes are no array of points")
    return np.frombuffer(data, dtype="<f8").reshape(-1, 3)
