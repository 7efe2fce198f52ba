"""GN-Bench's stand-in, as the tests use it: the recorded house with an occupancy map, and episodes in it."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from bridge_world import DATA, RECORDS

from spacevln.core import EpisodeSpec, InstructionTask, Pose
from spacevln.environments.bridge.frame import points_from_habitat
from spacevln.environments.gn_bench.environment import GNBenchEnvironment
from spacevln.environments.gn_bench.setup import GNBenchSetup

SCENE = "0001_000001"
PIXEL_M = 0.05
PAD_M = 0.5
BODY_M = (0.15, 1.3)
"""Between these heights things are in the way."""


def write_scene(folder: Path) -> Path:
    """The house as a folder of InteriorGS; the stand-in draws its own and only wants the splats' file to be there."""
    home = folder / SCENE
    home.mkdir(parents=True, exist_ok=True)
    data = np.load(DATA / "house.npz")
    boxes = [
        points_from_habitat(data["triangles"][data["ids"] == n].reshape(-1, 3)) for n in range(1, int(data["ids"].max()) + 1)
    ]
    low, high = np.array([box.min(0) for box in boxes]), np.array([box.max(0) for box in boxes])
    first, last = low.min(0) - PAD_M, high.max(0) + PAD_M
    width, height = (round(float(extent) / PIXEL_M) for extent in (last - first)[:2])
    last = first + np.array([PIXEL_M * width, PIXEL_M * height, 0])
    x = last[0] - PIXEL_M * (np.arange(width) + 0.5)  # both axes of the picture run against the world's
    y = first[1] + PIXEL_M * (np.arange(height) + 0.5)
    gray = np.full((height, width), 127, np.uint8)
    gray[np.ix_((y > low[:, 1].min()) & (y < high[:, 1].max()), (x > low[:, 0].min()) & (x < high[:, 0].max()))] = 255
    for a, b in zip(low, high, strict=True):
        if a[2] < BODY_M[1] and b[2] > BODY_M[0]:
            gray[np.ix_((y > a[1]) & (y < b[1]), (x > a[0]) & (x < b[0]))] = 0
    cv2.imwrite(str(home / "occupancy.png"), gray)
    place = {"scale": PIXEL_M, "min": first.tolist(), "max": last.tolist()}
    place |= {"lower": [-last[0], -last[1], 0.0], "upper": [-first[0], -first[1], 2.5]}
    (home / "occupancy.json").write_text(json.dumps(place))
    (home / "3dgs_compressed.ply").write_bytes(b"ply")
    return folder


def setup(folder: Path, **changed: Any) -> GNBenchSetup:
    return GNBenchSetup(**{"python": sys.executable, "scenes": str(write_scene(folder)), "gpu_device": -1, **changed})


def small(folder: Path, **changed: Any) -> GNBenchEnvironment:
    return GNBenchEnvironment(setup(folder, **{"width_px": 64, "height_px": 48, **changed}))


def episode(x_m: float = -1.5, y_m: float = -3.5, yaw_rad: float = math.pi) -> EpisodeSpec:
    return EpisodeSpec("1", SCENE, Pose(x_m, y_m, 0.0, yaw_rad), InstructionTask("go on"))


def write_episodes(file: Path, numbers: tuple[int, ...]) -> Path:
    """Recorded routes as GN-Matrix has them."""
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(pyarrow.Table.from_pylist(_rows(numbers)), file)
    return file


def _rows(numbers: tuple[int, ...]) -> list[dict[str, Any]]:
    found = []
    for number in numbers:
        steps = RECORDS["traces"]["034"][f"d{number:02d}/r010/slide"]["steps"]
        path = points_from_habitat([step[1] for step in steps if step[1] is not None])
        turn = steps[0][2]
        heading = math.degrees(2 * math.atan2(turn[1], turn[3])) % 360
        found.append(
            {
                "scene": SCENE,
                "trajectory_id": number,
                "instruction": "Go through the door and stop by the sofa.",
                "start_world_x": float(path[0, 0]),
                "start_world_y": float(path[0, 1]),
                "start_facing_unit_dx": math.cos(math.radians(heading)),
                "start_facing_unit_dy": math.sin(math.radians(heading)),
                "start_facing_heading_degrees": heading,
                "goal_world_x": float(path[-1, 0]),
                "goal_world_y": float(path[-1, 1]),
                "path_raster_world_x": path[:, 0].tolist(),
                "path_raster_world_y": path[:, 1].tolist(),
            }
        )
    return found
