"""Tables in the shape of the paper's, before they become text: rows and cells from runs and from the published rows."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from spacevln.assembly import ABLATIONS
from spacevln.core import UnknownNameError
from spacevln.evaluation.runs import Run
from spacevln.evaluation.statistics import interval
from spacevln.evaluation.tables.ablation import ABLATION_WORDS, ablation_label, idle_note, idle_presets, paper_place
from spacevln.evaluation.tables.published import PublishedRow, PublishedTable, published, source
from spacevln.evaluation.tables.shapes import HEADERS, SHAPES, TITLES, Shape

OVERALL = "Overall"
KNOWING = ("oracle", "reference")
"""Drivers that read the truth; they compete with nobody."""
OURS = "This repository"
"""Group of our rows."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A number of a table.

    Args:
        value: None is printed as a dash.
        low, high: its 95 % interval, where there is one.
        note: printed after it, e.g. ``"10/18"``; instead of it where there is none, e.g. ``"n/a"``.
    """

    value: float | None
    low: float | None = None
    high: float | None = None
    note: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """A metric of a block.

    Args:
        block: benchmark or area.
        metric: a name of :data:`~spacevln.evaluation.runs.EPISODE_METRICS`.
        header: what is printed over it.
        better: ``"up"``, ``"down"``, or ``""`` where neither is.
        digits: after the point.
    """

    block: str
    metric: str
    header: str
    better: str
    digits: int = 1


@dataclass(frozen=True, slots=True)
class Row:
    """A method.

    Args:
        flags: check marks by name: true, false, or None where the thing does not apply.
        cells: by (block, metric).
        own: a row of SpaceVLN.
        ranked: it takes part in the marking of best values.
    """

    method: str
    group: str
    flags: Mapping[str, bool | None]
    cells: Mapping[tuple[str, str], Cell]
    own: bool = False
    ranked: bool = True


@dataclass(frozen=True, slots=True)
class Table:
    """A table, its rows in order, rows of one group together."""

    title: str
    flags: tuple[str, ...]
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()


_SHAPE_OF_SUITE = {"hm3d-ovon": "ovon", "houses-objectnav": "ovon", "gn-bench": "gn-bench"}


def shape_for(runs: Sequence[Run]) -> str:
    """The shape of the paper's main table for these runs; of several kinds together, everything."""
    shapes = {_SHAPE_OF_SUITE.get(run.suite, "vln") for run in runs}
    return shapes.pop() if len(shapes) == 1 else "full"


def build_table(runs: Sequence[Run], shape: str, *, with_published: bool = False) -> Table:
    """A table of runs.

    Args:
        runs: one row each; rows with the same label are one, so that a method has one row over several benchmarks.
        shape: one of :data:`SHAPES`.
        with_published: print the paper's rows above.

    Raises:
        UnknownNameError: there is no such shape.
    """
    if shape not in SHAPES:
        raise UnknownNameError("table", shape, SHAPES)
    form, printed = SHAPES[shape], published(shape)
    shown = printed if with_published else None
    rows = [_published_row(row, form, shown) for row in shown.rows] if shown else []
    labels = dict.fromkeys(_label(run, shape) for run in runs)
    rows += [_row(label, [run for run in runs if _label(run, shape) == label], form) for label in labels]
    idle = idle_presets(runs) if shape == "ablation" else {}
    rows += [_idle_row(preset, form, dict.fromkeys(run.suite for run in runs)) for preset in idle]
    if shape == "ablation":
        rows.sort(key=lambda row: (row.group == OURS, row.group == OURS and paper_place(row.method)))
    blocks = dict.fromkeys(block for row in rows for block, _ in row.cells)
    columns = [
        Column(block, metric, *HEADERS[metric], form.digits.get(metric, 1))
        for block in sorted(blocks, key=lambda block: block == OVERALL)
        for metric in form.metrics
        if any(_given(row, block, metric) for row in rows)
    ]
    title = f"{printed.paper}. {printed.caption}" if printed else TITLES[shape]
    notes = [f"Published rows: {source()}."] if shown else []
    notes += [*map(_note, runs), *(idle_note(preset, other) for preset, other in idle.items())]
    return Table(title, form.flags, tuple(columns), tuple(rows), tuple(notes))


def _given(row: Row, block: str, metric: str) -> bool:
    cell = row.cells.get((block, metric))
    return cell is not None and cell.value is not None


def _published_row(row: PublishedRow, form: Shape, table: PublishedTable) -> Row:
    cells = {}
    for key, value in row.values.items():
        block, _, metric = key.partition(":")
        if metric in form.metrics:
            count = row.values.get(f"{block}:successes") if metric == "SR" else None
            cells[block, metric] = Cell(value, note="" if count is None else f"{count:.0f}/{table.totals[block]}")
    ranked = not form.ranked_groups or row.group in form.ranked_groups
    return Row(row.method, row.group, row.flags, cells, row.own, ranked)


def _row(label: str, runs: Sequence[Run], form: Shape) -> Row:
    cells: dict[tuple[str, str], Cell] = {}
    for run in runs:
        for block, part in _blocks(run, form):
            for metric in form.metrics:
                cells[block, metric] = _cell(part, metric, counted=form.by_area and metric == "SR")
    first = runs[0]
    flags = {flag: _flag(first, flag) for flag in form.flags}
    return Row(label, OURS, flags, cells, own=first.driver == "agent", ranked=first.driver not in KNOWING)


def _blocks(run: Run, form: Shape) -> Iterable[tuple[str, Run]]:
    if not form.by_area:
        yield run.suite, run
        return
    areas = dict.fromkeys(str(result.tags["area"]) for result in run.results.values() if "area" in result.tags)
    for area in areas:
        yield area, run.tagged("area", area)
    yield OVERALL, run


def _cell(run: Run, metric: str, *, counted: bool) -> Cell:
    values = list(run.values(metric).values())
    if not values:
        return Cell(None)
    if metric in ("gpu_gb", "memory_gb"):
        return Cell(max(values))
    found = interval(values)
    note = f"{sum(value > 0 for value in values)}/{len(values)}" if counted else ""
    return Cell(found.mean, found.low, found.high, note)


_COMPONENT_OF_FLAG = {
    "HSM": "hsm",
    "L-LM": "landmark_memory",
    "P-SCoT": "planner_scot",
    "E-SCoT": "executor_scot",
    "SC": "stagewise",
}


def _flag(run: Run, flag: str) -> bool | None:
    """Check mark of a run; None where rules reason, which have no prompt to leave fields out of."""
    if flag in ("TF", "ZS"):
        return True
    configuration = run.file.configuration
    reasoner = {"P-SCoT": "planner", "E-SCoT": "executor"}.get(flag)
    if run.driver != "agent" or (reasoner is not None and configuration.get(reasoner) == "rules"):
        return None
    return bool(configuration.get("components", {}).get(_COMPONENT_OF_FLAG[flag], True))


def _label(run: Run, shape: str) -> str:
    return (ablation_label(run) if shape == "ablation" else None) or run.label


def _idle_row(preset: str, form: Shape, blocks: Iterable[str]) -> Row:
    """A row of Table 4 that the other rows' reasoner knows nothing of."""
    components = ABLATIONS[preset]
    flags = {flag: None if flag.endswith("SCoT") else bool(getattr(components, _COMPONENT_OF_FLAG[flag])) for flag in form.flags}
    cells = {(block, metric): Cell(None, note="n/a") for block in blocks for metric in form.metrics}
    return Row(ABLATION_WORDS[preset], OURS, flags, cells, own=True, ranked=False)


def _note(run: Run) -> str:
    results = run.results.values()
    counted = Counter(str(result.status) for result in results)
    statuses = ", ".join(f"{count} {name}" for name, count in sorted(counted.items()))
    unreachable = sum(result.truth is not None and result.metrics.NE is None for result in results)
    line = f"{run.label}: {len(run.results)} episodes of {run.file.suite}; {statuses}"
    line += f"; {unreachable} unreachable, left out of NE" if unreachable else ""
    forced = sum(result.forced_stop for result in results)
    return line + (f"; {forced} STOPs forced" if forced else "")


def best(table: Table, column: Column) -> tuple[float | None, float | None]:
    """Best and second-best printed value of a column among the ranked rows; None where fewer than two rows have one."""
    if not column.better:
        return None, None
    cells = [row.cells.get((column.block, column.metric)) for row in table.rows if row.ranked]
    values = {round(cell.value, column.digits) for cell in cells if cell is not None and cell.value is not None}
    ordered = sorted((value for value in values if math.isfinite(value)), reverse=column.better == "up")
    if len(ordered) < 2:
        return None, None
    return ordered[0], ordered[1]
