"""Map a posed RGB-D sequence from a folder: no simulator, no agent, no model.

    python examples/map_rgbd_stream.py FOLDER --camera-height 1.2 --out map.png --save map.npz

The folder holds what most RGB-D data sets can be exported to:

- ``camera.json``: ``{"fx": 525.0, "fy": 525.0, "cx": 319.5, "cy": 239.5, "depth_scale": 1000.0}``; a pixel value divided by
  ``depth_scale`` is metres. The principal point counts pixel centres as integers, as ROS, TUM and ScanNet do.
- ``depth/NAME.png``: 16-bit depth along the optical axis, 0 = no measurement.
- ``poses.txt``: per line ``NAME tx ty tz qx qy qz qw``, the camera's optical frame (x right, y down, z forward) in a world frame
  with z up, metres. Lines with ``#`` are comments.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path

import click
import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from spacevln.core import Camera, Observation, Pose, UsageError
from spacevln.mapping import MetricMap

# Columns: forward, left and up of the camera frame, in the optical frame.
CAMERA_AXES = np.array([(0.0, -1.0, 0.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)])
MARGIN_M = 5.0


def read_camera(folder: Path, width_px: int, height_px: int, height_m: float) -> tuple[Camera, float]:
    """The camera and the divisor that makes pixel values metres."""
    values = json.loads((folder / "camera.json").read_text())
    camera = Camera(
        width_px,
        height_px,
        hfov_deg=math.degrees(2 * math.atan(width_px / 2 / values["fx"])),
        height_m=height_m,
        fx_px=values["fx"],
        fy_px=values["fy"],
        cx_px=values["cx"] + 0.5,  # our pixel centres lie at half-integers
        cy_px=values["cy"] + 0.5,
    )
    return camera, float(values["depth_scale"])


def frames(folder: Path, camera_height_m: float) -> Iterator[Observation]:
    """The sequence as observations.

    Args:
        folder: see the module.
        camera_height_m: of the optical centre over the floor: the map takes heights from the feet.

    Raises:
        UsageError: a line of ``poses.txt`` or a picture cannot be read.
    """
    for line in (folder / "poses.txt").read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        name, *numbers = line.split()
        if len(numbers) != 7:
            raise UsageError(f"poses.txt has the line {line!r}: needed are a name, a position and a quaternion, 8 words.")
        x, y, z, *quaternion = map(float, numbers)
        raw = cv2.imread(str(folder / "depth" / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        if raw is None or raw.ndim != 2:
            raise UsageError(f"{folder / 'depth' / name}.png is no picture with one channel: give 16-bit depth.")
        camera, scale = read_camera(folder, raw.shape[1], raw.shape[0], camera_height_m)
        T_world_camera = np.eye(4)
        T_world_camera[:3, :3] = Rotation.from_quat(quaternion).as_matrix() @ CAMERA_AXES
        T_world_camera[:3, 3] = x, y, z
        forward = T_world_camera[:2, 0]
        pose = Pose(x, y, z - camera_height_m, math.atan2(forward[1], forward[0]))
        depth_m = (raw / scale).astype(np.float32)
        yield Observation(np.zeros((*raw.shape, 3), np.uint8), depth_m, pose, camera, T_world_camera)


def picture(world_map: MetricMap) -> np.ndarray:
    """The current floor, x to the right and y up: white free, black obstacle, grey unknown, red the way walked."""
    way = world_map.travelled[:, :2]
    low, high = way.min(axis=0) - MARGIN_M, way.max(axis=0) + MARGIN_M
    crop = world_map.crop((low + high) / 2, float((high - low).max()))
    image = np.full((*crop.free.shape, 3), 150, np.uint8)
    image[crop.explored] = 200
    image[crop.free] = 255
    image[crop.obstacle] = 0
    image[crop.trajectory] = (0, 0, 255)
    return image


@click.command()
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--camera-height", "camera_height_m", required=True, type=float, help="Of the optical centre over the floor, m.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), default="map.png", help="Picture of the map.")
@click.option("--save", type=click.Path(dir_okay=False, path_type=Path), help="The map itself, for MetricMap.load.")
def main(folder: Path, camera_height_m: float, out: Path, save: Path | None) -> None:
    """Map FOLDER and write a picture of the last floor."""
    world_map, count = MetricMap(), 0
    for observation in frames(folder, camera_height_m):
        world_map.integrate(observation)
        count += 1
    if not count:
        raise click.ClickException(f"{folder / 'poses.txt'} names no frame: give a line per depth picture.")
    cv2.imwrite(str(out), picture(world_map))
    if save is not None:
        world_map.save(save)
    click.echo(f"{count} frames, floors {list(world_map.floors)}, {world_map.nbytes / 1e6:.1f} MB, picture {out}")


if __name__ == "__main__":
    main()
