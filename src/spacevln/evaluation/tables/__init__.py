"""The paper's tables, from run directories and from the published rows."""

from spacevln.evaluation.tables.build import Table, build_table, shape_for
from spacevln.evaluation.tables.render import FORMATS, render
from spacevln.evaluation.tables.shapes import SHAPES

__all__ = ["FORMATS", "SHAPES", "Table", "build_table", "render", "shape_for"]
