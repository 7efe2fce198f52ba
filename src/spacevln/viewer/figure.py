"""The paper's qualitative figures for any episode: the planner's row and the executor's row, as PNG and PDF."""

from __future__ import annotations

from pathlib import Path

from PIL import Image, ImageDraw

from spacevln.core import RecordError, UsageError
from spacevln.viewer.scenes import CHOSEN, Scenes, font, paragraph
from spacevln.viewer.topdown import INK, SOFT

WIDTH = 1800
PAD = 20
HEAD = 34
SHOTS, SHOT_PX = 4, (288, 216)


def draw_figure(directory: Path, out: Path, *, stage: int | None = None, failure: bool = False) -> tuple[Path, Path]:
    """Draw an episode's figure.

    Args:
        directory: of the episode's record.
        out: where it goes, without a suffix; ``.png`` and ``.pdf`` are written.
        stage: from 0; by default the decisive one of a failure, else the longest.
        failure: add why the episode failed and what the agent thought at the decisive stage.

    Raises:
        RecordError: the record holds no stage, or the files cannot be written.
        UsageError: there is no such stage, or ``failure`` is asked of an episode without a diagnosis.
    """
    scenes = Scenes(directory)
    stages = [number for number, each in enumerate(scenes.stages) if each["views"] and each.get("subtask")]
    if not stages:
        raise RecordError(f"{str(directory)!r} holds no planner stage: there is nothing to draw.")
    if stage is not None and stage not in stages:
        raise UsageError(f"There is no stage {stage + 1}: the episode has 1 to {stages[-1] + 1}.")
    diagnosis = scenes.result.diagnosis if scenes.result else None
    if failure and diagnosis is None:
        raise UsageError(f"{str(directory)!r} has no diagnosis: give a failed episode, or leave --failure out.")
    decisive = diagnosis.stage if diagnosis is not None and diagnosis.stage in stages else None
    longest = max(stages, key=lambda number: scenes.stages[number].get("last", 0) - scenes.stages[number].get("planned", 0))
    chosen = stage if stage is not None else decisive if decisive is not None else longest
    acted = chosen if _moved(scenes, chosen) or not chosen else chosen - 1  # the last stage only stops
    shots = _shots(scenes, acted)
    rows = [_head(scenes), _planner(scenes, chosen), _executor(scenes, acted, shots)]
    if any(scenes.steps[index]["external"] for index in shots):
        rows.append(_external(scenes, shots))
    if failure and diagnosis is not None:
        thought = scenes.stages[chosen]["subtask"]["thought"]
        excerpt = " ".join(thought[name] for name in ("progress", "decision") if thought[name])
        rows.append(
            _words(f"Failure: {diagnosis.name} ({diagnosis.paper}). {diagnosis.reason}", f"The planner thought: {excerpt}")
        )
    sheet = Image.new("RGB", (WIDTH, sum(row.height for row in rows)), "white")
    y = 0
    for row in rows:
        sheet.paste(row, (0, y))
        y += row.height
    files = (out.with_suffix(".png"), out.with_suffix(".pdf"))
    try:
        sheet.save(files[0])
        sheet.save(files[1], resolution=200.0)
    except OSError as error:
        raise RecordError(f"Cannot write {str(files[0])!r} ({error.strerror}): give a writable --out.") from error
    return files


def _head(scenes: Scenes) -> Image.Image:
    row = Image.new("RGB", (WIDTH, 84), "white")
    paragraph(ImageDraw.Draw(row), (PAD, 16), scenes.task, WIDTH - 2 * PAD, 22, lines=2)
    return row


def _words(*texts: str) -> Image.Image:
    row = Image.new("RGB", (WIDTH, 300), "white")
    draw, y = ImageDraw.Draw(row), 6
    for text in texts:
        y = paragraph(draw, (PAD, y), text, WIDTH - 2 * PAD, 19, lines=3) + 4
    return row.crop((0, 0, WIDTH, y + 10))


def _planner(scenes: Scenes, number: int) -> Image.Image:
    """Surrounding views, rendered map, planning decision, and the global path."""
    stage = scenes.stages[number]
    subtask = stage["subtask"]
    row = Image.new("RGB", (WIDTH, 450), "white")
    draw = ImageDraw.Draw(row)
    for x, title in (
        (PAD, f"Surrounding views, stage {number + 1}"),
        (700, "Semantic map"),
        (1060, "Planning decision"),
        (1420, "Global path"),
    ):
        draw.text((x, 4), title, INK, font(18))
    views = sorted(stage["views"], key=lambda view: -view["heading"])
    for k, view in enumerate(views):
        x, y = PAD + (k % 4) * 166, HEAD + (k // 4) * 138
        row.paste(scenes.picture(view["rgb"], (158, 118), "not turned to"), (x, y))
        mark = view["label"] == subtask["direction"] and not subtask["complete"]
        if mark:
            draw.rectangle((x - 3, y - 3, x + 160, y + 120), outline=CHOSEN, width=4)
        draw.text((x + 2, y + 120), view["label"], CHOSEN if mark else SOFT, font(13))
    memory = stage.get("memory")
    row.paste(scenes.picture(memory["image"] if memory else None, (340, 400)), (700, HEAD))
    ticks = {"verified": "done", "current": "here", "pending": "to do"}
    y = (
        paragraph(
            draw, (1060, HEAD + 4), "The task is done." if subtask["complete"] else subtask["instruction"], 340, 18, lines=4
        )
        + 6
    )
    for anchor in subtask["chain"]:
        y = paragraph(draw, (1060, y), f"{ticks[anchor['status']]}: {anchor['text']}", 340, 14, lines=1)
    for name in ("progress", "decision"):
        y = paragraph(draw, (1060, y + 6), f"{name}: {subtask['thought'][name]}", 340, 14, lines=5, soft=True)
    row.paste(scenes.map(len(scenes.steps) - 1, (360, 400)), (1420, HEAD))
    return row


def _moved(scenes: Scenes, number: int) -> bool:
    """Whether anything was executed in a stage."""
    return any(decision["stage"] == number for decision in scenes.story["decisions"])


def _shots(scenes: Scenes, number: int) -> list[int]:
    """A few steps of a stage, evenly spread."""
    steps = [index for index, step in enumerate(scenes.steps) if step["stage"] == number and step["phase"] != "lookaround"]
    return sorted({steps[round(k * (len(steps) - 1) / (SHOTS - 1))] for k in range(SHOTS)}) if steps else []


def _external(scenes: Scenes, shots: list[int]) -> Image.Image:
    """The robot from outside at the executor's steps."""
    row = Image.new("RGB", (WIDTH, HEAD + SHOT_PX[1] + 14), "white")
    ImageDraw.Draw(row).text((PAD, 4), "External camera", INK, font(18))
    for k, index in enumerate(shots):
        row.paste(scenes.picture(scenes.steps[index]["external"], SHOT_PX), (PAD + k * 300, HEAD))
    return row


def _executor(scenes: Scenes, number: int, shots: list[int]) -> Image.Image:
    """One stage: first-person views with their action, landmark memory, and the local path."""
    row = Image.new("RGB", (WIDTH, 330), "white")
    draw = ImageDraw.Draw(row)
    draw.text((PAD, 4), f"Execution of stage {number + 1}", INK, font(18))
    for k, index in enumerate(shots):
        x = PAD + k * 300
        row.paste(scenes.view(index, SHOT_PX), (x, HEAD))
        step = scenes.steps[index]
        decision = None if step["decision"] is None else scenes.story["decisions"][step["decision"]]
        draw.text((x, HEAD + 220), f"step {step['step']}: {decision['action'] if decision else step['action']}", INK, font(15))
        if decision:
            paragraph(draw, (x, HEAD + 242), decision["thought"]["action"], 280, 13, lines=2, soft=True)
    draw.text((1230, 4), "Landmark memory", INK, font(18))
    made = [decision for decision in scenes.story["decisions"] if decision["stage"] == number]
    pool = made[-1]["pool"] if made else []
    y = HEAD + 4
    for candidate in pool:
        arrived = ", arrived" if candidate["arrived"] else ""
        text = f"{candidate['name']}: {candidate['m']:.1f} m, confidence {candidate['confidence']:.2f}{arrived}"
        y = paragraph(draw, (1230, y), text, 180, 14, lines=4) + 6
    if not pool:
        draw.text((1230, y), "empty", SOFT, font(14))
    draw.text((1420, 4), "Local path", INK, font(18))
    row.paste(scenes.map(shots[-1] if shots else len(scenes.steps) - 1, (360, 270), around_m=2.5), (1420, HEAD))
    return row
