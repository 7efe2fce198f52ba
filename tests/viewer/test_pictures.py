"""Figures and videos of an episode."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from PIL import Image
from small_records import write_episode

from spacevln.core import PrerequisiteError, UsageError
from spacevln.viewer import draw_figure, write_spatial_log, write_video
from spacevln.viewer.scenes import Scenes
from spacevln.viewer.video import PANE, frame


def test_a_figure_is_a_png_and_a_pdf(tmp_path: Path) -> None:
    write_episode(tmp_path / "e", "Go.", good=False)
    png, pdf = draw_figure(tmp_path / "e", tmp_path / "figure", failure=True)
    with Image.open(png) as picture:
        assert picture.width == 1800
    assert pdf.read_bytes().startswith(b"%PDF")


def test_a_figure_shows_the_external_camera_where_the_record_has_it(tmp_path: Path) -> None:
    heights = []
    for name, filmed in (("a", False), ("b", True)):
        write_episode(tmp_path / name, "Go.", good=True, filmed=filmed)
        with Image.open(draw_figure(tmp_path / name, tmp_path / f"figure_{name}")[0]) as picture:
            heights.append(picture.height)
    assert heights[1] > heights[0] + 200


def test_a_video_shows_the_external_camera_in_a_corner(tmp_path: Path) -> None:
    write_episode(tmp_path / "e", "Go.", good=True, filmed=True)
    assert frame(Scenes(tmp_path / "e"), 0).getpixel((PANE[0] - 60, 60)) == pytest.approx((90, 0, 200), abs=6)


def test_a_figure_refuses_what_is_not_there(tmp_path: Path) -> None:
    write_episode(tmp_path / "e", "Go.", good=True)
    with pytest.raises(UsageError, match="There is no stage 5: the episode has 1 to 2"):
        draw_figure(tmp_path / "e", tmp_path / "figure", stage=4)
    with pytest.raises(UsageError, match="has no diagnosis"):
        draw_figure(tmp_path / "e", tmp_path / "figure", failure=True)


def test_the_map_is_uncovered_as_the_agent_goes(tmp_path: Path) -> None:
    write_episode(tmp_path / "e", "Go.", good=True)
    scenes = Scenes(tmp_path / "e")
    _, _, seen = scenes._layers[0]
    assert seen.min() == 0
    assert seen.max() <= len(scenes.steps)
    assert scenes.map(5, (200, 150)).size == (200, 150)


def test_a_video_has_a_frame_for_every_step(tmp_path: Path) -> None:
    av = pytest.importorskip("av", reason="PyAV is not installed")
    write_episode(tmp_path / "e", "Go.", good=True)
    with av.open(str(write_video(tmp_path / "e", tmp_path / "e.mp4"))) as film:
        assert sum(1 for _ in film.decode(video=0)) == 6


def test_a_spatial_log_holds_every_part_of_the_episode(tmp_path: Path) -> None:
    pytest.importorskip("rerun", reason="the Rerun SDK is not installed: no spatial log is written")
    write_episode(tmp_path / "e", "Go.", good=True)
    data = write_spatial_log(tmp_path / "e", tmp_path / "e.rrd").read_bytes()
    assert data.startswith(b"RRF2")
    for name in ("camera", "map/floor_0", "graph/waypoints", "landmarks", "trajectory"):
        assert f"world/{name}".encode() in data, name


def test_a_spatial_log_without_the_sdk_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_episode(tmp_path / "e", "Go.", good=True)
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(PrerequisiteError, match=r"pip install 'spacevln\[rerun\]'"):
        write_spatial_log(tmp_path / "e", tmp_path / "e.rrd")
