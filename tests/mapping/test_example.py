"""The example maps a folder of depth pictures and poses without a simulator."""

from __future__ import annotations

import importlib.util
import json
import math
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation
from worlds import look, room

from spacevln.core import Camera, Pose, UsageError
from spacevln.mapping import MetricMap

EXAMPLE = Path(__file__).parent.parent.parent / "examples" / "map_rgbd_stream.py"
WORLD = [*room(-2.0, -2.5, 3.0, 2.5), (1.2, 0.4, 0.0, 1.8, 1.0, 0.8)]
CAMERA = Camera(160, 120, 79.0, 1.1)


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("map_rgbd_stream", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A turn on the spot, written as a data set would be: millimetres, optical frame."""
    (tmp_path / "depth").mkdir()
    lines = ["# name tx ty tz qx qy qz qw"]
    for k in range(12):
        pose = Pose(0.1, -0.2, 0.3, k * math.pi / 6)
        depth = look(WORLD, Pose(pose.x_m, pose.y_m, 0.0, pose.yaw_rad), CAMERA).depth_m
        cv2.imwrite(str(tmp_path / "depth" / f"{k:03d}.png"), np.rint(depth * 1000).astype(np.uint16))
        c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        optical = np.array([(s, 0, c), (-c, 0, s), (0, -1, 0)])  # columns right, down, forward
        q = Rotation.from_matrix(optical).as_quat()
        lines.append(f"{k:03d} {pose.x_m} {pose.y_m} {pose.z_m + 1.1} " + " ".join(map(str, q)))
    (tmp_path / "poses.txt").write_text("\n".join(lines) + "\n")
    camera = {"fx": CAMERA.fx_px, "fy": CAMERA.fy_px, "cx": 79.5, "cy": 59.5, "depth_scale": 1000.0}
    (tmp_path / "camera.json").write_text(json.dumps(camera))
    return tmp_path


def test_a_folder_becomes_a_map(example: ModuleType, folder: Path) -> None:
    out, saved = folder / "map.png", folder / "map.npz"
    result = CliRunner().invoke(example.main, [str(folder), "--camera-height", "1.1", "--out", str(out), "--save", str(saved)])
    assert result.exit_code == 0, result.output
    assert "12 frames" in result.output
    world_map = MetricMap.load(saved)
    assert world_map.is_free([(-1.0, -1.5), (2.0, -1.5), (0.5, 1.8)]).all()
    assert world_map.is_obstacle([(1.22, 0.6), (3.02, 0.0), (-2.02, 1.0)]).all()
    assert world_map.geodesic_m((0, 0), (2.5, -2.0)) == pytest.approx(math.hypot(2.5, 2.0), rel=0.02)
    image = cv2.imread(str(out))
    assert {tuple(colour) for colour in image.reshape(-1, 3).tolist()} >= {(255, 255, 255), (0, 0, 0), (150, 150, 150)}


def test_a_damaged_folder_is_refused_with_a_sentence(example: ModuleType, folder: Path) -> None:
    poses = folder / "poses.txt"
    poses.write_text("000 1 2 3\n")
    with pytest.raises(UsageError, match="8 words"):
        list(example.frames(folder, 1.1))
    poses.write_text("nothing 0 0 0 0 0 0 1\n")
    with pytest.raises(UsageError, match="16-bit depth"):
        list(example.frames(folder, 1.1))
    poses.write_text("# none\n")
    result = CliRunner().invoke(example.main, [str(folder), "--camera-height", "1.1"])
    assert result.exit_code == 1
    assert "names no frame" in result.output
