"""Pictures and pages, made from the record alone; computes nothing (DESIGN 5.9)."""

from spacevln.viewer.figure import draw_figure
from spacevln.viewer.memory_maps import draw_memory
from spacevln.viewer.pages import write_comparison, write_site
from spacevln.viewer.spatial_log import write_spatial_log
from spacevln.viewer.topdown import draw_topdown
from spacevln.viewer.video import write_video

__all__ = ["draw_figure", "draw_memory", "draw_topdown", "write_comparison", "write_site", "write_spatial_log", "write_video"]
