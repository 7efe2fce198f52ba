"""Pictures and pages, made from the record alone; computes nothing (DESIGN 5.9)."""

from spacevln.viewer.topdown import draw_topdown

__all__ = ["draw_topdown"]
