"""Saving Spatial Cognitive Memory and loading it again, for repeated episodes in one building (DESIGN 5.3).

One ``.npz`` file of plain arrays, no pickle: the metric map's (``map/...``, see ``mapping.persistence``), and of Hierarchical
Spatial Memory a JSON header with the waypoints, edges, thresholds and regions, beside the cells of their supports and the
points of their ways. Local Landmark Memory belongs to a stage and is not kept. The same memory gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError

from spacevln.core import Pose, SpatialWaypoint, UsageError
from spacevln.mapping import MetricMap
from spacevln.mapping.persistence import read, write
from spacevln.memory.graph import Edge, WaypointGraph
from spacevln.memory.hierarchical import HierarchicalSpatialMemory
from spacevln.memory.regions import Region, Regions, RegionsState, Support
from spacevln.memory.thresholds import Threshold, Thresholds

FORMAT: Literal["spacevln-memory/1.0"] = "spacevln-memory/1.0"
"""Name and version of the format; the first number changes when an older reader cannot read it."""

_HEADER, _CELLS, _WAYS = "memory/header", "memory/support", "memory/ways"
Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, eq=False)
class BuildingMemory:
    """What is known of a building, in a frame of its own: all that an agent gets of earlier episodes.

    Args:
        metric_map: every floor.
        hierarchical: waypoints, graph, regions, chains.
    """

    metric_map: MetricMap
    hierarchical: HierarchicalSpatialMemory

    def start_episode(self) -> None:
        """Begin a new way in what is known; what earlier episodes walked stays waypoints and is no chain of this one."""
        self.metric_map.start_episode()
        self.hierarchical.start_episode()


@dataclass(frozen=True, slots=True, eq=False)
class SavedMemory:
    """What an episode leaves for the next one in the same building.

    Args:
        scene: name of the building.
        T_scene_episode: where the origin of the memory's frame lies in the scene: the start pose of the episode that began
            the memory. It registers the start of a later episode; the agent never gets it.
        building: what is known.
    """

    scene: str
    T_scene_episode: Pose
    building: BuildingMemory

    def start_of(self, start: Pose) -> Pose:
        """A scene pose, e.g. the start of the next episode, in the memory's frame."""
        return start.relative_to(self.T_scene_episode)


def save_memory(path: str | Path, memory: SavedMemory) -> None:
    """Write a memory; a file that was there is replaced whole or not at all."""
    write({**memory.building.metric_map.to_arrays(), **_to_arrays(memory)}, Path(path))


def load_memory(path: str | Path) -> SavedMemory:
    """Read what :func:`save_memory` wrote; nothing in the file is executed.

    Raises:
        UsageError: the file is missing, damaged, no memory, or of another version.
    """
    arrays = read(Path(path))
    if _HEADER not in arrays:
        raise UsageError(f"{path} holds no Spatial Cognitive Memory: give the memory.npz of an episode's record.")
    text = arrays[_HEADER].tobytes()
    try:
        header = _Header.model_validate_json(text)
        hierarchical = _restored(header, arrays)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"]) or "the header"
        raise UsageError(f"{path} is no {FORMAT}: {place}: {first['msg']}; explore the building anew.") from error
    except (KeyError, IndexError, ValueError) as error:
        raise UsageError(f"{path} is damaged ({error!r}): give the memory.npz of another episode.") from error
    building = BuildingMemory(MetricMap.from_arrays(arrays), hierarchical)
    return SavedMemory(header.scene, header.T_scene_episode, building)


class _Header(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["spacevln-memory/1.0"]
    scene: str
    T_scene_episode: Pose
    waypoints: tuple[SpatialWaypoint, ...]
    chain_starts: tuple[int, ...]
    edges: tuple[Edge, ...]
    thresholds: tuple[Threshold, ...]
    complete: tuple[bool, ...]  # of each waypoint's support
    thresholds_seen: tuple[tuple[int, ...], ...]
    joined: tuple[tuple[int, int, bool], ...]
    regions: tuple[Region, ...]


def _to_arrays(memory: SavedMemory) -> dict[str, NDArray[Any]]:
    hierarchical = memory.building.hierarchical
    graph, regions = hierarchical.graph, hierarchical.regions.state
    header = _Header(
        format=FORMAT,
        scene=memory.scene,
        T_scene_episode=memory.T_scene_episode,
        waypoints=hierarchical.waypoints,
        chain_starts=hierarchical.chain_starts,
        edges=graph.edges,
        thresholds=tuple(hierarchical.thresholds),
        complete=tuple(support.complete for support in regions.supports),
        thresholds_seen=tuple(support.thresholds for support in regions.supports),
        joined=tuple((a, b, joined) for (a, b), joined in regions.joined.items()),
        regions=regions.regions,
    )
    return {
        _HEADER: np.frombuffer(header.model_dump_json().encode(), np.uint8),
        **_packed(_CELLS, [support.cells for support in regions.supports], np.zeros(0, np.int64)),
        **_packed(_WAYS, [graph.path_of(edge) for edge in graph.edges], np.zeros((0, 2))),
    }


def _restored(header: _Header, arrays: Arrays) -> HierarchicalSpatialMemory:
    cells, ways = _unpacked(_CELLS, arrays), _unpacked(_WAYS, arrays)
    supports = tuple(map(Support, cells, header.complete, header.thresholds_seen))
    if not len(supports) == len(header.waypoints) == sum(len(region.waypoints) for region in header.regions):
        raise ValueError(f"{len(header.waypoints)} waypoints, {len(supports)} supports")
    return HierarchicalSpatialMemory.restored(
        header.waypoints,
        header.chain_starts,
        WaypointGraph.restored(tuple(zip(header.edges, ways, strict=True))),
        Regions.restored(RegionsState(supports, {(a, b): joined for a, b, joined in header.joined}, header.regions)),
        Thresholds(header.thresholds),
    )


def _packed(name: str, parts: Sequence[NDArray[Any]], empty: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Arrays of different length end to end, and where each ends."""
    return {
        f"{name}/values": np.concatenate([empty, *parts]),
        f"{name}/ends": np.cumsum([len(part) for part in parts], dtype=np.int64),
    }


def _unpacked(name: str, arrays: Arrays) -> list[NDArray[Any]]:
    ends = arrays[f"{name}/ends"]
    return np.split(arrays[f"{name}/values"], ends[:-1]) if len(ends) else []
