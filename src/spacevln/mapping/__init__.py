"""A tiled metric map of a posed RGB-D stream: free space, obstacles, floors, geodesics, frontiers (DESIGN 5.2).

Stand-alone: needs ``spacevln.core`` only, no simulator and no agent.
"""

from spacevln.mapping.crops import MapCrop
from spacevln.mapping.floors import StairConnector
from spacevln.mapping.geodesics import GeodesicField
from spacevln.mapping.incline import Incline
from spacevln.mapping.metric_map import MetricMap
from spacevln.mapping.outlook import unknown_bearings

__all__ = ["GeodesicField", "Incline", "MapCrop", "MetricMap", "StairConnector", "unknown_bearings"]
