"""The pictures that a model sees: look-around views, the front view with its landmarks, the rendered map."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core import Camera, ContractError, LandmarkPool, Observation, ObstacleDistances, Sighting, View
from spacevln.language.names import full_name
from spacevln.reasoning.spatial_cot.lettering import INK, PAPER, PLATE, Colour, letters

Picture = NDArray[np.uint8]

BLOCKED: Colour = (176, 24, 32)
NARROW: Colour = (156, 92, 0)
BLOCKED_M, NARROW_M = 0.5, 1.0  # distances below these are written in their colours [authors' code]
REACH_M = 5.0  # of the depth that is trusted [paper]
BAND_PX = 24  # of white above a picture, for its words
SHOWN_SIGHTINGS = 3  # of a view; the nearest ones
SAME_THING_M = 0.8  # between a sighting and the fused position of its landmark
MAP_PNG_COMPRESSION = 3
MOSAIC_COLUMNS = 4
MOSAIC_GAP_PX = 4


def obstacle_words(distance_m: float) -> str:
    """Rounded down, so that nothing looks freer than it is: ``"2.1 m"``, ``"0.4 m, blocked"``, ``"over 5 m"``."""
    if not math.isfinite(distance_m) or distance_m >= REACH_M:
        return f"over {REACH_M:.0f} m"
    return f"{math.floor(distance_m * 10) / 10:.1f} m{', blocked' if distance_m < BLOCKED_M else ''}"


def bearing_words(bearing_rad: float) -> str:
    """``"12 deg left"``, ``"30 deg right"``, ``"straight ahead"`` within two degrees."""
    degrees = math.degrees(bearing_rad)
    if abs(degrees) < 2.0:
        return "straight ahead"
    return f"{abs(degrees):.0f} deg {'left' if degrees > 0 else 'right'}"


def nearest_sightings(view: View) -> list[Sighting]:
    """The sightings of a view that are shown and told."""
    return sorted(view.sightings, key=lambda sighting: (sighting.distance_m, sighting.category))[:SHOWN_SIGHTINGS]


def view_picture(view: View, width_px: int, *, detections: bool) -> Picture:
    """One view under a band that names its direction and obstacle distance, with the boxes of its nearest sightings.

    Returns:
        (H, W, 3) RGB, W at most ``width_px``.
    """
    if view.rgb is None:
        raise ContractError(f"The view {view.label!r} has no image, as the agent did not turn to it: leave it out of the prompt.")
    canvas, picture, scale = _canvas(view.rgb, width_px)
    if detections:
        shown = nearest_sightings(view)
        _draw_boxes(picture, [(s, f"{full_name(s.category, s.attributes)} {s.distance_m:.1f} m") for s in shown], scale)
    _write(canvas, 0.0, view.label.upper(), INK)
    _write(canvas, 1.0, f"obstacle {obstacle_words(view.obstacle_m)}", _tone(view.obstacle_m))
    return canvas


def mosaic(pictures: Sequence[Picture]) -> Picture:
    """Pictures of one size as tiles, four in a row, in reading order; missing tiles are white."""
    height, width = pictures[0].shape[:2]
    columns = min(MOSAIC_COLUMNS, len(pictures))
    rows = -(-len(pictures) // columns)
    step_i, step_j = height + MOSAIC_GAP_PX, width + MOSAIC_GAP_PX
    sheet = np.full((rows * step_i - MOSAIC_GAP_PX, columns * step_j - MOSAIC_GAP_PX, 3), 255, np.uint8)
    for index, picture in enumerate(pictures):
        i, j = index // columns * step_i, index % columns * step_j
        sheet[i : i + height, j : j + width] = picture
    return sheet


def forward_picture(
    observation: Observation,
    sightings: Sequence[Sighting],
    pool: LandmarkPool,
    obstacles: ObstacleDistances,
    width_px: int,
) -> Picture:
    """The front view: landmark boxes with number, name, distance and bearing; a band with the obstacle distances.

    The three distances stand over the columns of the image that look into their directions. A number is the landmark's place
    in the pool.
    """
    canvas, picture, scale = _canvas(observation.rgb, width_px)
    _draw_boxes(picture, [(sighting, _landmark_words(sighting, pool)) for sighting in sightings], scale)
    sectors = (
        ("left 30", 30.0, obstacles.left_30_m),
        ("front", 0.0, obstacles.front_m),
        ("right 30", -30.0, obstacles.right_30_m),
    )
    for name, left_deg, distance_m in sectors:
        column = _column(observation.camera, left_deg) * scale
        _write(canvas, column / canvas.shape[1], f"{name}: {obstacle_words(distance_m)}", _tone(distance_m))
        cv2.line(picture, (round(column), 0), (round(column), 9), PLATE, 2)
    return canvas


def jpeg(picture: Picture, quality: int) -> bytes:
    """Encode an RGB picture."""
    return _encode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])


def png(picture: Picture) -> bytes:
    """Encode an RGB picture without loss: for the map, whose small letters must stay sharp."""
    return _encode(".png", picture, [cv2.IMWRITE_PNG_COMPRESSION, MAP_PNG_COMPRESSION])


def _encode(suffix: str, picture: Picture, options: list[int]) -> bytes:
    done, data = cv2.imencode(suffix, cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), options)
    if not done:
        raise ContractError(f"A picture of shape {picture.shape} could not be encoded: needed is (H, W, 3) uint8.")
    return data.tobytes()


def _canvas(rgb: Picture, width_px: int) -> tuple[Picture, Picture, float]:
    """A white band above the image, the image in it, never enlarged, and the scale."""
    scale = min(1.0, width_px / rgb.shape[1])
    height, width = round(rgb.shape[0] * scale), round(rgb.shape[1] * scale)
    canvas = np.full((BAND_PX + height, width, 3), 255, np.uint8)
    picture = canvas[BAND_PX:]
    if scale == 1.0:
        picture[:] = rgb
    else:  # averaging over areas is exact but slow, and shows only in strong reductions
        method = cv2.INTER_AREA if scale < 0.5 else cv2.INTER_LINEAR
        cv2.resize(np.ascontiguousarray(rgb), (width, height), dst=picture, interpolation=method)
    return canvas, picture, scale


def _column(camera: Camera, left_deg: float) -> float:
    """Column of the image that looks this far to the left of the optical axis [px]."""
    return camera.cx_px - camera.fx_px * math.tan(math.radians(left_deg))


def _landmark_words(sighting: Sighting, pool: LandmarkPool) -> str:
    """Name, distance and bearing of a box: those of the pool's candidate that it shows, after its number, so that both agree."""
    reach_m = SAME_THING_M + sighting.extent_m / 4
    apart = [math.dist(each.position_m[:2], sighting.position_m[:2]) for each in pool]
    place = min(range(len(pool)), key=apart.__getitem__, default=-1)
    if place < 0 or apart[place] > reach_m:
        name = full_name(sighting.category, sighting.attributes)
        return f"{name} {sighting.distance_m:.1f} m, {bearing_words(sighting.bearing_rad)}"
    shown = pool[place]
    name = full_name(shown.category, shown.attributes)
    return f"[{place + 1}] {name} {shown.distance_m:.1f} m, {bearing_words(shown.bearing_rad)}"


def _draw_boxes(picture: Picture, boxes: Sequence[tuple[Sighting, str]], scale: float) -> None:
    """Boxes in the image, then their words on plates at their upper edges, lower where another plate is."""
    height, width = picture.shape[:2]
    taken: list[tuple[int, int, int]] = []  # row, first and last column of a plate
    for sighting, _ in boxes:
        x0, y0, x1, y1 = (round(value * scale) for value in sighting.box_px)
        cv2.rectangle(picture, (x0, y0), (max(x0, x1 - 1), max(y0, y1 - 1)), PLATE, 2)
    for sighting, words in boxes:
        plate = letters(words, PAPER, PLATE)[:, :width]
        rows, columns = plate.shape[:2]
        i = min(max(0, round(sighting.box_px[1] * scale) - rows), height - rows)
        j = min(max(0, round(sighting.box_px[0] * scale)), width - columns)
        while i + 2 * rows <= height and any(
            abs(i - row) < rows and j < last and first < j + columns for row, first, last in taken
        ):
            i += 1
        taken.append((i, j, j + columns))
        picture[i : i + rows, j : j + columns] = plate


def _write(canvas: Picture, share: float, words: str, colour: Colour) -> None:
    """Words on the band, their middle at this share of the width, wholly inside."""
    plate = letters(words, colour, PAPER)[:BAND_PX, : canvas.shape[1]]
    j = round(min(max(share * canvas.shape[1] - plate.shape[1] / 2, 0), canvas.shape[1] - plate.shape[1]))
    canvas[2 : 2 + plate.shape[0], j : j + plate.shape[1]] = plate


def _tone(distance_m: float) -> Colour:
    return BLOCKED if distance_m < BLOCKED_M else NARROW if distance_m < NARROW_M else INK
