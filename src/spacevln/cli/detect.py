"""``spacevln detect``: what a detector finds in a picture, printed and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.detector_options import choice_from, model_choice_options

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from spacevln.core import Detection, Observation

MILLIMETRES = 1000.0


@click.command()
@click.argument("image", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("phrases", nargs=-1, required=True, metavar="PHRASE...")
@click.option(
    "--depth",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    default=None,
    help="Depth of the same size: .npy in metres, or a 16-bit .png in millimetres.",
)
@click.option("--hfov", type=click.FloatRange(1, 179), default=79.0, show_default=True, help="Horizontal field of view, degrees.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=None, help="Picture to write.")
@model_choice_options
def detect(image: Path, phrases: tuple[str, ...], depth: Path | None, hfov: float, out: Path | None, **options: Any) -> int:
    """Find PHRASE... in IMAGE, e.g. spacevln detect room.jpg "white sofa" doorway.

    With --depth every line also says how far away and in which direction the thing is.
    """
    from spacevln.perception.lifting import lift
    from spacevln.perception.open_vocabulary.drawing import draw_detections
    from spacevln.perception.open_vocabulary.opening import open_detector

    observation = _observation(image, depth, hfov)
    detector = open_detector(choice_from(options))
    (found,) = detector.detect([observation], phrases)
    for detection in found:
        sightings = lift(observation, [detection]) if depth is not None else ()
        click.echo(_line(detection, sightings))
    if not found:
        click.echo("nothing found")
    picture = out or image.with_name(f"{image.stem}-detections.png")
    _write(picture, draw_detections(observation.rgb, found))
    click.echo(f"picture  {picture}")
    return 0


def _line(detection: Detection, sightings: Any) -> str:
    from math import degrees

    x0, y0, x1, y1 = detection.box_px
    line = f"{detection.confidence:.2f}  {detection.category}  box {x0},{y0} to {x1},{y1}"
    if detection.mask is not None:
        line += f"  mask {int(detection.mask.sum())} px"
    for sighting in sightings:
        side = "left" if sighting.bearing_rad > 0 else "right"
        line += f"  {sighting.distance_m:.2f} m away, {abs(degrees(sighting.bearing_rad)):.0f} degrees {side}"
        line += ", a way through" if sighting.is_passage else ""
    return line


def _observation(image: Path, depth: Path | None, hfov: float) -> Observation:
    """The picture as an observation from the origin.

    Raises:
        UsageError: a file is no picture, or sizes differ.
    """
    import cv2
    import numpy as np

    from spacevln.core import Camera, Observation, Pose, UsageError

    bgr = cv2.imread(str(image), cv2.IMREAD_COLOR)
    if bgr is None:
        raise UsageError(f"{str(image)!r} is no picture: give a .jpg or .png file.")
    height, width = bgr.shape[:2]
    depth_m = np.zeros((height, width), np.float32) if depth is None else _depth(depth)
    return Observation(
        cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB).astype(np.uint8), depth_m, Pose(0, 0), Camera(width, height, hfov, 0.88)
    )


def _depth(path: Path) -> NDArray[np.float32]:
    import cv2
    import numpy as np

    from spacevln.core import UsageError

    if path.suffix == ".npy":
        try:
            metres = np.load(path, allow_pickle=False)
        except (OSError, ValueError) as error:
            raise UsageError(f"{str(path)!r} is no array of depths ({error}): save it with numpy.save.") from error
        return np.asarray(metres, np.float32)
    millimetres = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if millimetres is None or millimetres.dtype != np.uint16 or millimetres.ndim != 2:
        raise UsageError(f"{str(path)!r} is no depth image: give a 16-bit .png in millimetres, or a .npy in metres.")
    return (millimetres / MILLIMETRES).astype(np.float32)


def _write(path: Path, rgb: NDArray[np.uint8]) -> None:
    import cv2

    from spacevln.core import UsageError

    try:
        path.write_bytes(cv2.imencode(".png", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))[1].tobytes())
    except OSError as error:
        raise UsageError(f"{str(path)!r} cannot be written ({error.strerror}): give another --out.") from error
