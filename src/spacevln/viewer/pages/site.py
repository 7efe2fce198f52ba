"""Writes the pages of a run beside its record: plain files that open from disk."""

from __future__ import annotations

import base64
import hashlib
import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup

from spacevln.core import RecordError, UsageError
from spacevln.recording import ResultFile, RunFile, SummaryFile, read_events, read_file, read_result
from spacevln.viewer.pages import summary as tell
from spacevln.viewer.pages.differing import first_difference
from spacevln.viewer.pages.story import Story

HERE = Path(__file__).parent
PAGE = "index.html"
COPIED = ("images/*_rgb.jpg", "images/*_external.jpg", "images/stage_*.png", "prompts/*.jpg", "prompts/*.png")
"""What pages show of an episode's record."""
FIRST_SHOWN = 300
"""Episodes of a long list that are laid out before one asks for all."""


@dataclass(frozen=True, slots=True)
class _Target:
    """Where the pages of a run go."""

    record: Path
    pages: Path

    @property
    def inside(self) -> bool:
        """Whether they lie in the record itself, so that pictures need no copy."""
        return self.record.resolve() == self.pages.resolve()

    def folder(self, episode: Path) -> Path:
        """Of an episode's page."""
        return self.pages / episode.relative_to(self.record)


def write_site(record: Path, out: Path | None = None, *, missing_only: bool = False) -> Path:
    """Write the page of a run and of each of its episodes, or of one episode.

    Args:
        record: directory of a run, or of an episode inside one.
        out: where the pages go, with copies of the pictures they show; by default they lie in the record.
        missing_only: leave pages of episodes that are newer than their record.

    Returns:
        The page to open.

    Raises:
        RecordError: it is no record, or it is damaged, or the pages cannot be written.
    """
    run = record if (record / "run.json").exists() else record.parent.parent
    file = read_file(run / "run.json", RunFile)
    target = _Target(run, out or run)
    folders = sorted(path.parent for path in (run / "episodes").glob("*/events.jsonl"))
    failed_early = sorted(path.parent for path in (run / "episodes").glob("*/result.json") if path.parent not in folders)
    every = sorted([*folders, *failed_early])
    chosen = every if run == record else [record]
    if not every or (run != record and record not in every):
        raise RecordError(f"{str(record)!r} holds no episode: give the directory of a run or of one of its episodes.")
    try:
        for folder in chosen:
            at = every.index(folder)
            around = (every[at - 1].name if at else None, every[at + 1].name if at + 1 < len(every) else None)
            if not (missing_only and _fresh(folder, target)):
                _write_episode(folder, target, file, around)
        _write_run(every, target, file)
    except OSError as error:
        raise RecordError(f"Cannot write pages into {str(target.pages)!r} ({error.strerror}): give a writable --out.") from error
    return (target.pages if run == record else target.folder(record)) / PAGE


def write_comparison(first: Path, second: Path, out: Path) -> Path:
    """Write a page with two records of one episode side by side, with copies of the pictures it shows.

    Args:
        first, second: directories of the episodes.
        out: a new directory, or one of an earlier comparison.

    Returns:
        The page.

    Raises:
        RecordError: a record is damaged, or the page cannot be written.
        UsageError: the records are of different tasks.
    """
    stories: list[tuple[ResultFile | None, Story]] = []
    sides: list[dict[str, Any]] = []
    for folder in (first, second):
        result, story = read_result(folder), Story(folder).read(read_events(folder))
        stories.append((result, story))
    texts = {story.started.task_text for _, story in stories if story.started}
    if len(texts) > 1:
        raise UsageError(f"{str(first)!r} and {str(second)!r} are records of different tasks: give two of one episode.")
    try:
        out.mkdir(parents=True, exist_ok=True)
        for name, folder, (result, story) in zip(("a", "b"), (first, second), stories, strict=True):
            _copy_pictures(folder, out / name)
            data = _moved(story.json(result), f"{name}/")
            sides.append({"name": name, "folder": _label(folder), "episode": tell.episode(folder, result, story), "data": data})
        differing = first_difference(sides[0]["data"], sides[1]["data"])
        data = {"sides": [side["data"] for side in sides], "differing": differing}
        _write(out / PAGE, "compare.jinja", ("kit", "compare"), sides=sides, differing=differing, data=_json(data))
    except OSError as error:
        raise RecordError(f"Cannot write {str(out)!r} ({error.strerror}): give a writable --out.") from error
    return out / PAGE


def _label(folder: Path) -> str:
    """Run and episode of a directory."""
    return f"{folder.resolve().parent.parent.name} / {folder.resolve().name}"


def _moved(data: dict[str, Any], prefix: str) -> dict[str, Any]:
    """The same story with its pictures in a folder."""
    for step in data["steps"]:
        step["rgb"] = step["rgb"] and prefix + step["rgb"]
    for stage in data["stages"]:
        for view in stage["views"]:
            view["rgb"] = view["rgb"] and prefix + view["rgb"]
        if stage.get("memory") and stage["memory"]["image"]:
            stage["memory"]["image"] = prefix + stage["memory"]["image"]
    return data


def _fresh(folder: Path, target: _Target) -> bool:
    page = target.folder(folder) / PAGE
    sources = [path for path in (folder / "events.jsonl", folder / "result.json") if path.exists()]
    return page.exists() and all(page.stat().st_mtime >= path.stat().st_mtime for path in sources)


def _write_episode(folder: Path, target: _Target, run: RunFile, around: tuple[str | None, str | None]) -> None:
    result = read_result(folder)
    story = Story(folder)
    if (folder / "events.jsonl").exists():
        story.read(read_events(folder))
    place = target.folder(folder)
    place.mkdir(parents=True, exist_ok=True)
    if not target.inside:
        _copy_pictures(folder, place)
    data = story.json(result)
    _write(
        place / PAGE,
        "episode.jinja",
        ("kit", "episode"),
        run=tell.run(run),
        run_page="../../index.html",
        e=tell.episode(folder, result, story),
        diagnosis=result.diagnosis if result else None,
        before=around[0],
        after=around[1],
        has_truth=bool(data["goals"]),
        has_external=any(step["external"] for step in data["steps"]),
        data=_json(data),
    )


def _write_run(folders: Sequence[Path], target: _Target, run: RunFile) -> None:
    summary_path = target.record / "summary.json"
    summary = read_file(summary_path, SummaryFile) if summary_path.exists() else None
    results = [(folder, read_result(folder)) for folder in folders]
    lines = [tell.line(folder, result) for folder, result in results]
    costs = any(line["calls"] for line in lines)
    _write(
        target.pages / PAGE,
        "run.jinja",
        ("run",),
        run=tell.run(run),
        summary=None if summary is None else tell.summary(summary),
        diagnoses=[] if summary is None else tell.diagnoses(summary, [result for _, result in results if result]),
        kinds=[] if summary is None else tell.kinds(summary),
        episodes=lines,
        first=FIRST_SHOWN,
        outcomes=sorted({line["outcome"]["kind"] for line in lines}),
        columns=tell.columns(costs=costs),
        costs=costs,
        charts=tell.charts([result for _, result in results if result]),
    )


def _copy_pictures(folder: Path, place: Path) -> None:
    for pattern in COPIED:
        for picture in sorted(folder.glob(pattern)):
            copy = place / picture.relative_to(folder)
            copy.parent.mkdir(parents=True, exist_ok=True)
            if not copy.exists() or copy.stat().st_size != picture.stat().st_size:
                shutil.copyfile(picture, copy)


def _write(path: Path, template: str, scripts: tuple[str, ...], **values: Any) -> None:
    """Render a page whose only script and style are ours: its policy names their hashes."""
    style = Markup(_asset("style.css"))  # noqa: S704 - our own file
    script = Markup("\n".join(_asset(f"{name}.js") for name in scripts))  # noqa: S704 - our own files
    text = (
        _templates()
        .get_template(template)
        .render(style=style, script=script, style_hash=_digest(style), script_hash=_digest(script), **values)
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode("utf-8", "replace"))


@cache
def _templates() -> Environment:
    return Environment(
        loader=PackageLoader("spacevln.viewer.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


@cache
def _asset(name: str) -> str:
    return (HERE / "static" / name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _json(data: Any) -> Markup:
    """JSON that is safe inside a script element."""
    return htmlsafe_json_dumps(data, dumps=lambda value, **_: json.dumps(value, separators=(",", ":"), allow_nan=False))
