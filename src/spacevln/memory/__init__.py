"""Spatial Cognitive Memory M_t = {W_t, L_t} (paper Sec. 3.2): Hierarchical Spatial Memory and Local Landmark Memory."""

from spacevln.memory.arrival import ARRIVAL_RADIUS_M, reached_space
from spacevln.memory.graph import Edge, EdgeKind, WaypointGraph
from spacevln.memory.hierarchical import HierarchicalSpatialMemory
from spacevln.memory.landmarks import LocalLandmarkMemory, summarise
from spacevln.memory.metric import MemoryMap
from spacevln.memory.persistence import BuildingMemory, SavedMemory, load_memory, save_memory
from spacevln.memory.regions import Region
from spacevln.memory.spatial_cognitive import SpatialCognitiveMemory

__all__ = [
    "ARRIVAL_RADIUS_M",
    "BuildingMemory",
    "Edge",
    "EdgeKind",
    "HierarchicalSpatialMemory",
    "LocalLandmarkMemory",
    "MemoryMap",
    "Region",
    "SavedMemory",
    "SpatialCognitiveMemory",
    "WaypointGraph",
    "load_memory",
    "reached_space",
    "save_memory",
    "summarise",
]
