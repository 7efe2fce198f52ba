"""Tables as Markdown, LaTeX and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from itertools import groupby

from spacevln.core import UnknownNameError
from spacevln.evaluation.tables.build import Cell, Column, Row, Table, best

FORMATS = ("md", "latex", "csv")
BENCHMARK_NAMES = {
    "r2r-ce": "R2R-CE",
    "rxr-ce": "RxR-CE",
    "hm3d-ovon": "HM3D-OVON",
    "gn-bench": "GN-Bench",
    "houses-vln": "houses-vln",
    "houses-objectnav": "houses-objectnav",
}
DASH = "--"
_LATEX = {"&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}"}


def render(table: Table, form: str, *, intervals: bool = False) -> str:
    """A table as text, with a line break at its end.

    Args:
        table: what to print.
        form: one of :data:`FORMATS`.
        intervals: print 95 % intervals behind the values.

    Raises:
        UnknownNameError: there is no such format.
    """
    match form:
        case "md":
            return _markdown(table, intervals=intervals)
        case "latex":
            return _latex(table, intervals=intervals)
        case "csv":
            return _csv(table, intervals=intervals)
        case _:
            raise UnknownNameError("format", form, FORMATS)


def block_name(block: str) -> str:
    """How a benchmark is printed."""
    return BENCHMARK_NAMES.get(block, block)


def _number(cell: Cell | None, column: Column, *, intervals: bool) -> str:
    if cell is None or cell.value is None:
        return DASH if cell is None or not cell.note else cell.note
    text = f"{cell.value:.{column.digits}f}"
    if cell.note:
        text += f" ({cell.note})"
    if intervals and cell.low is not None and cell.high is not None:
        text += f" [{cell.low:.{column.digits}f}, {cell.high:.{column.digits}f}]"
    return text


def _rank(table: Table, row: Row, column: Column) -> int:
    """1 and 2 for the best and second-best value of a column, 0 for the others."""
    cell = row.cells.get((column.block, column.metric))
    if cell is None or cell.value is None or not row.ranked:
        return 0
    value = round(cell.value, column.digits)
    return next((rank for rank, mark in enumerate(best(table, column), start=1) if mark == value), 0)


def _groups(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    return [(name, list(group)) for name, group in groupby(rows, key=lambda row: row.group)]


def _markdown(table: Table, *, intervals: bool) -> str:
    arrow = {"up": " ↑", "down": " ↓", "": ""}
    single = len({column.block for column in table.columns}) == 1
    heads = [
        (column.header if single else f"{block_name(column.block)} {column.header}") + arrow[column.better]
        for column in table.columns
    ]
    width = 1 + len(table.flags) + len(heads)
    lines = [_pipes(["Method", *table.flags, *heads]), _pipes(["---", *[":-:"] * len(table.flags), *["--:"] * len(heads)])]
    groups = _groups(table.rows)
    for name, rows in groups:
        if name and len(groups) > 1:
            lines.append(_pipes([f"*{name}*", *[""] * (width - 1)]))
        for row in rows:
            cells = []
            for column in table.columns:
                text = _number(row.cells.get((column.block, column.metric)), column, intervals=intervals)
                cells.append({0: text, 1: f"**{text}**", 2: f"<u>{text}</u>"}[_rank(table, row, column)])
            marks = [{True: "✓", False: "✗", None: "n/a"}[row.flags.get(flag)] for flag in table.flags]
            lines.append(_pipes([f"**{row.method}**" if row.own else row.method, *marks, *cells]))
    blocks = list(dict.fromkeys(block_name(column.block) for column in table.columns))
    title = table.title + (f" Ours on {blocks[0]}." if single else "")
    notes = [f"- {note}" for note in table.notes]
    return "\n".join([title, "", *lines, *([""] if notes else []), *notes]) + "\n"


def _pipes(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"


def _latex(table: Table, *, intervals: bool) -> str:
    arrow = {"up": r"$\uparrow$", "down": r"$\downarrow$", "": ""}
    flags = len(table.flags)
    blocks = [(block, len(list(group))) for block, group in groupby(table.columns, key=lambda column: column.block)]
    layout = "l" + ("|" + "c" * flags if flags else "") + "".join("|" + "c" * count for _, count in blocks)
    spans = "".join(f" & \\multicolumn{{{count}}}{{c}}{{\\textbf{{{_tex(block_name(block))}}}}}" for block, count in blocks)
    heads = "".join(f" & \\textbf{{{_tex(column.header)}}}{arrow[column.better]}" for column in table.columns)
    lines = [
        r"\begin{table}[t]",
        r"\centering",
        f"\\caption{{{_tex(table.title)}}}",
        f"\\begin{{tabular}}{{{layout}}}",
        r"\toprule",
        r"\textbf{Method}" + " &" * flags + spans + r" \\",
        "".join(f" & \\textbf{{{_tex(flag)}}}" for flag in table.flags) + heads + r" \\",
    ]
    width = 1 + flags + len(table.columns)
    groups = _groups(table.rows)
    for name, rows in groups:
        lines.append(r"\midrule")
        if name and len(groups) > 1:
            lines.append(f"\\multicolumn{{{width}}}{{l}}{{\\textbf{{\\textit{{{_tex(name)}}}}}}} \\\\")
        for row in rows:
            cells = []
            for column in table.columns:
                text = _tex(_number(row.cells.get((column.block, column.metric)), column, intervals=intervals))
                cells.append({0: text, 1: f"\\textbf{{{text}}}", 2: f"\\underline{{{text}}}"}[_rank(table, row, column)])
            marks = [{True: r"\checkmark", False: r"$\times$", None: "n/a"}[row.flags.get(flag)] for flag in table.flags]
            method = f"\\textbf{{{_tex(row.method)}}}" if row.own else _tex(row.method)
            lines.append(" & ".join([method, *marks, *cells]) + r" \\")
    notes = [f"% {note}" for note in table.notes]
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", r"\end{table}", *notes]) + "\n"


def _tex(text: str) -> str:
    return "".join(_LATEX.get(char, char) for char in text)


def _csv(table: Table, *, intervals: bool) -> str:
    """One line per row; values with four decimals, as other programs read them."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    heads: list[str] = []
    for column in table.columns:
        name = f"{column.block}:{column.metric}"
        heads += [name, f"{name}:low", f"{name}:high"] if intervals else [name]
    writer.writerow(["group", "method", *table.flags, *heads])
    for row in table.rows:
        cells: list[str] = []
        for column in table.columns:
            cell = row.cells.get((column.block, column.metric)) or Cell(None)
            values = [cell.value, cell.low, cell.high] if intervals else [cell.value]
            cells += [cell.note if cell.value is None else "" if value is None else f"{value:.4f}" for value in values]
        marks = [{True: "1", False: "0", None: ""}[row.flags.get(flag)] for flag in table.flags]
        writer.writerow([row.group, row.method, *marks, *cells])
    return out.getvalue()
