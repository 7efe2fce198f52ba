"""Saving a map and loading it again: named arrays and one JSON header in an ``.npz`` file, no pickle.

The header says format and version; a layer is its tile keys (N, 2) and its tiles (N, 240, 240). The same map gives the same
bytes whatever the order in which its tiles were touched.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from spacevln.core import Pose, UsageError
from spacevln.mapping.floors import FloorTracker, StairConnector
from spacevln.mapping.tiles import TILE_CELLS, TiledLayer
from spacevln.mapping.traces import Trace

FORMAT = "spacevln.metric-map"
VERSION = 1
Arrays = Mapping[str, NDArray[Any]]
_HEADER = "map/header"


@dataclass(frozen=True, slots=True, eq=False)
class MapState:
    """All that a map holds between two frames."""

    resolution_m: float
    agent_radius_m: float
    tracker: FloorTracker
    trace: Trace


def pack(state: MapState) -> dict[str, NDArray[Any]]:
    """The state as named arrays; every name begins with ``map/``."""
    tracker, trace = state.tracker, state.trace
    arrays: dict[str, NDArray[Any]] = {"map/trace": trace.episode}
    for floor in tracker.floors.values():
        layers = {"seen": floor.seen, "solid": floor.solid, "ground": floor.ground}
        layers |= {f"semantic/{index}": floor.semantic[term] for index, term in enumerate(sorted(floor.semantic))}
        for name, layer in layers.items():
            keys = sorted(layer.tiles)
            tiles = [layer.tiles[key] for key in keys]
            arrays[f"map/{floor.id}/{name}/keys"] = np.array(keys, np.int64).reshape(-1, 2)
            arrays[f"map/{floor.id}/{name}/tiles"] = np.array(tiles, layer.dtype).reshape(-1, TILE_CELLS, TILE_CELLS)
    header = {
        "format": FORMAT,
        "version": VERSION,
        "resolution_m": state.resolution_m,
        "agent_radius_m": state.agent_radius_m,
        "floors": [
            {"id": floor.id, "z_m": floor.z_m, "bounds": floor.bounds, "version": floor.version, "terms": sorted(floor.semantic)}
            for floor in sorted(tracker.floors.values(), key=lambda floor: floor.id)
        ],
        "current": None if tracker.current is None else tracker.current.id,
        "connectors": [asdict(connector) for connector in tracker.connectors],
        "last": None if tracker.last is None else asdict(tracker.last),
        "left_at": None if tracker.left_at is None else asdict(tracker.left_at),
        "climbed_m": tracker.climbed_m,
        "stage_from": trace.stage_from,
    }
    arrays[_HEADER] = np.frombuffer(json.dumps(header, sort_keys=True).encode(), np.uint8)
    return arrays


def unpack(arrays: Arrays) -> MapState:
    """Inverse of :func:`pack`; arrays of other names are ignored.

    Raises:
        UsageError: this is no map, or one of another version.
    """
    header = _header(arrays)
    try:
        tracker = FloorTracker(header["agent_radius_m"] / header["resolution_m"])
        for row in header["floors"]:
            floor = tracker.open(row["id"], row["z_m"])
            floor.seen = _layer(arrays, f"map/{floor.id}/seen", np.uint8)
            floor.solid = _layer(arrays, f"map/{floor.id}/solid", np.uint8)
            floor.ground = _layer(arrays, f"map/{floor.id}/ground", np.int8)
            for index, term in enumerate(row["terms"]):
                floor.semantic[term] = _layer(arrays, f"map/{floor.id}/semantic/{index}", np.uint8)
            floor.bounds = None if row["bounds"] is None else tuple(row["bounds"])
            floor.version = row["version"]
            floor.reachable.changed.update(floor.seen.tiles)
        for row in header["connectors"]:
            tracker.connectors.append(StairConnector(**row | {"start": Pose(**row["start"]), "end": Pose(**row["end"])}))
        tracker.current = None if header["current"] is None else tracker.floors[header["current"]]
        tracker.last = None if header["last"] is None else Pose(**header["last"])
        tracker.left_at = None if header["left_at"] is None else Pose(**header["left_at"])
        tracker.climbed_m = header["climbed_m"]
        trace = Trace.restored(arrays["map/trace"], header["stage_from"])
        return MapState(header["resolution_m"], header["agent_radius_m"], tracker, trace)
    except (KeyError, TypeError) as error:
        raise UsageError(f"The saved map is incomplete or damaged ({error!r}): save it anew with MetricMap.save.") from error


def write(arrays: Arrays, path: Path) -> None:
    """Write arrays as one compressed ``.npz`` file; a file that was there is replaced whole or not at all."""
    part = path.with_name(path.name + ".part")
    with part.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
    part.replace(path)


def read(path: Path) -> dict[str, NDArray[Any]]:
    """Read what :func:`write` wrote; nothing in the file is executed.

    Raises:
        UsageError: there is no such file, or it is no archive of plain arrays.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, AttributeError, zipfile.BadZipFile) as error:
        raise UsageError(f"{path} cannot be read as a saved map ({error}): give a file that MetricMap.save wrote.") from error


def _header(arrays: Arrays) -> dict[str, Any]:
    if _HEADER not in arrays:
        raise UsageError(f"There is no metric map among the {len(arrays)} arrays: give what MetricMap.save wrote.")
    try:
        header = json.loads(arrays[_HEADER].tobytes())
    except ValueError as error:
        raise UsageError(f"The header of the saved map is damaged ({error}): save it anew with MetricMap.save.") from error
    found = (header.get("format"), header.get("version")) if isinstance(header, dict) else (None, None)
    if found != (FORMAT, VERSION):
        raise UsageError(f"The saved map is {found[0]} version {found[1]}, readable is {FORMAT} version {VERSION}: map it anew.")
    return dict(header)


def _layer(arrays: Arrays, name: str, dtype: DTypeLike) -> TiledLayer:
    keys, tiles = arrays[f"{name}/keys"], arrays[f"{name}/tiles"]
    layer = TiledLayer(dtype)
    if keys.shape != (len(tiles), 2) or tiles.shape[1:] != (TILE_CELLS, TILE_CELLS) or tiles.dtype != layer.dtype:
        raise UsageError(
            f"Layer {name} of the saved map has keys {keys.shape} and tiles {tiles.shape} {tiles.dtype}: it is damaged."
        )
    layer.tiles = {(int(i), int(j)): tile.copy() for (i, j), tile in zip(keys, tiles, strict=True)}
    return layer
