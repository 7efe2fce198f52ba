"""Static pages of a run and its episodes, from the record alone (DESIGN 5.9)."""

from spacevln.viewer.pages.site import write_comparison, write_site

__all__ = ["write_comparison", "write_site"]
