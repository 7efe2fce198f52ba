"""An episode as an MP4: what it saw, its map, and what it thought."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from spacevln.core import PrerequisiteError, RecordError
from spacevln.viewer.scenes import CHOSEN, Scenes, font, framed, paragraph
from spacevln.viewer.topdown import SOFT

SIZE = (1280, 720)
PANE = (632, 474)
INSET = (220, 165)
"""Of the external camera, in a corner of the first-person view."""
FRAMES_PER_S = 8


def write_video(directory: Path, out: Path, *, frames_per_s: int = FRAMES_PER_S) -> Path:
    """Write an episode's video: first-person view, map, subtask and reasoning.

    Args:
        directory: of the episode's record.
        out: the MP4.
        frames_per_s: steps shown per second.

    Raises:
        PrerequisiteError: PyAV is not installed.
        RecordError: the record holds no step, or the file cannot be written.
    """
    try:
        import av
    except ImportError as error:
        raise PrerequisiteError("A video needs PyAV: pip install 'spacevln[video]'.") from error
    scenes = Scenes(directory)
    if not scenes.steps:
        raise RecordError(f"{str(directory)!r} holds no step: there is nothing to film.")
    try:
        with av.open(str(out), "w", format="mp4") as container:
            stream = container.add_stream("libx264", rate=frames_per_s)
            stream.width, stream.height = SIZE
            stream.pix_fmt = "yuv420p"
            stream.options = {"crf": "23", "preset": "veryfast"}
            for index in range(len(scenes.steps)):
                picture = av.VideoFrame.from_ndarray(np.asarray(frame(scenes, index)), format="rgb24")
                container.mux(stream.encode(picture))
            container.mux(stream.encode())
    except OSError as error:
        raise RecordError(f"Cannot write {str(out)!r} ({error.strerror}): give a writable --out.") from error
    return out


def frame(scenes: Scenes, index: int) -> Image.Image:
    """One frame of the video."""
    step = scenes.steps[index]
    stage = scenes.stages[step["stage"]]
    sheet = Image.new("RGB", SIZE, "white")
    sheet.paste(scenes.view(index, PANE), (5, 5))
    if step["external"]:
        sheet.paste(framed(scenes.picture(step["external"], INSET)), (PANE[0] - INSET[0] - 3, 10))
    sheet.paste(scenes.map(index, PANE), (643, 5))
    draw = ImageDraw.Draw(sheet)
    y = paragraph(draw, (14, 488), scenes.task, 1250, 16, lines=2, soft=True)
    subtask = stage.get("subtask") if index > stage.get("planned", index) else None
    if subtask is None:
        draw.text((14, y + 6), "Looking around", CHOSEN, font(20))
        ended = scenes.stages[step["stage"] - 1].get("end") if step["stage"] else None
        if ended:
            draw.text((14, y + 40), f"The last stage ended by {ended.replace('_', ' ')}.", SOFT, font(15))
    else:
        text = "The task is done." if subtask["complete"] else subtask["instruction"]
        y = paragraph(draw, (14, y + 6), text, 1250, 20, lines=2)
        y = paragraph(draw, (14, y + 4), subtask["thought"]["decision"], 1250, 15, lines=2, soft=True)
        if step["decision"] is not None:
            decision = scenes.story["decisions"][step["decision"]]
            paragraph(draw, (14, y + 4), f"{decision['action']}: {decision['thought']['action']}", 1250, 15, lines=2)
    where = f"step {step['step']} of {len(scenes.steps)}, stage {step['stage'] + 1} of {len(scenes.stages)}: {step['action']}"
    draw.text((14, 694), where, SOFT, font(15))
    return sheet
