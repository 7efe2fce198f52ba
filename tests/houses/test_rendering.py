"""Renderers against MuJoCo's own rays: depth, instance ids, culling that never drops what can be seen."""

from __future__ import annotations

import logging
import math
import os
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
import two_rooms

from spacevln.core import Camera, EnvironmentFailure, Pose, PrerequisiteError, UnknownNameError
from spacevln.environments.houses.environment import load_place
from spacevln.environments.houses.rendering import RANGE_M, RaycastRenderer, choice, make_renderer, probe, renderer_info
from spacevln.environments.houses.rendering.culling import Visibility, geom_bounds

HAS_GL = renderer_info("auto").name == "gl"
CAMERA = Camera(160, 120, 79.0, 0.88)
NAMES = [pytest.param("gl", marks=pytest.mark.skipif(not HAS_GL, reason="no OpenGL library here")), "raycast"]
POSES = [
    Pose(0.6, 1.8, 0.0, 0.0),
    Pose(0.6, 1.8, 0.0, 1.2),
    Pose(4.06, 2.0, 0.0, 0.0),  # in the doorway
    Pose(4.06, 2.0, 0.0, 2.0),
    Pose(5.5, 1.0, 0.0, -0.4),
    Pose(7.6, 3.4, 0.0, math.pi),
    Pose(3.2, 2.4, 0.0, -0.6),
]


def T_of(pose: Pose) -> np.ndarray:
    T = pose.T_world_body
    T[2, 3] += CAMERA.height_m
    return T


@pytest.fixture(scope="module")
def drawable():
    return two_rooms.drawable()


@pytest.fixture(params=NAMES)
def renderer(request, drawable):
    renderer = make_renderer(renderer_info(request.param), drawable, CAMERA.width_px, CAMERA.height_px)
    yield renderer
    renderer.close()


def rays(drawable, T, camera):
    """Depth and instance id of every pixel by MuJoCo's ray caster."""
    data = mujoco.MjData(drawable.model)
    mujoco.mj_forward(drawable.model, data)
    rows, columns = np.mgrid[0 : camera.height_px, 0 : camera.width_px]
    slopes = np.stack(
        [
            np.ones(rows.size),
            -(columns.ravel() + 0.5 - camera.cx_px) / camera.fx_px,
            -(rows.ravel() + 0.5 - camera.cy_px) / camera.fy_px,
        ],
        1,
    )
    directions = slopes @ T[:3, :3].T
    geoms, distance = np.empty(rows.size, np.int32), np.empty(rows.size)
    eye = np.ascontiguousarray(T[:3, 3])
    mujoco.mj_multiRay(drawable.model, data, eye, directions.ravel(), None, True, -1, geoms, distance, None, rows.size, 1e3)
    depth = np.where((geoms >= 0) & (distance <= RANGE_M), distance, 0.0)
    return depth.reshape(rows.shape), np.append(drawable.geom_instance, 0)[geoms].reshape(rows.shape)


@pytest.mark.parametrize("pose", POSES)
def test_depth_and_instances_agree_with_rays(renderer, drawable, pose):
    frame = renderer.render(T_of(pose), CAMERA)
    depth, instances = rays(drawable, T_of(pose), CAMERA)
    same = frame.instance_ids == instances
    assert same.mean() > 0.995  # the rest are edges of round things, which are drawn with flat faces
    flat = same & ~np.isin(instances, [two_rooms.LAMP, two_rooms.DRUM]) & (np.abs(frame.depth_m - depth) < 0.5)
    assert flat.mean() > 0.5
    np.testing.assert_allclose(frame.depth_m[flat], depth[flat], atol=1e-4)
    np.testing.assert_allclose(frame.depth_m[same], depth[same], atol=0.05)


def test_frames_are_new_arrays_of_the_promised_types(renderer):
    first, second = (renderer.render(T_of(pose), CAMERA) for pose in POSES[:2])
    assert first.rgb.shape == (120, 160, 3)
    assert (first.rgb.dtype, first.depth_m.dtype, first.instance_ids.dtype) == (np.uint8, np.float32, np.int32)
    assert first.depth_m.flags.c_contiguous
    assert not np.shares_memory(first.rgb, second.rgb)
    assert first.depth_m.max() <= RANGE_M


def test_the_picture_is_upright_coloured_and_nowhere_black(renderer):
    frame = renderer.render(T_of(Pose(1.0, 1.5, 0.0, math.pi / 2)), CAMERA)
    rgb = frame.rgb.astype(int)
    cabinet = rgb[frame.instance_ids == two_rooms.BOX].mean(axis=0)
    assert cabinet[0] > 3 * cabinet[2]
    assert rgb[:10].mean() > rgb[-10:].mean()  # the ceiling is white, the floor brown
    assert rgb.max(axis=2).min() > 30


def test_the_same_picture_every_time(renderer):
    first, second = (renderer.render(T_of(POSES[0]), CAMERA) for _ in range(2))
    np.testing.assert_array_equal(first.rgb, second.rgb)
    np.testing.assert_array_equal(first.depth_m, second.depth_m)


def test_an_off_centre_camera_sees_the_same_world(renderer, drawable):
    camera = Camera(160, 120, 79.0, 0.88, cx_px=60.0, cy_px=70.0)
    frame = renderer.render(T_of(POSES[0]), camera)
    depth, _ = rays(drawable, T_of(POSES[0]), camera)
    assert np.median(np.abs(frame.depth_m - depth)) < 1e-4


def test_a_closed_renderer_says_so(drawable):
    for name in ("gl", "raycast") if HAS_GL else ("raycast",):
        renderer = make_renderer(renderer_info(name), drawable, 160, 120)
        renderer.close()
        renderer.close()
        with pytest.raises(EnvironmentFailure, match="closed"):
            renderer.render(T_of(POSES[0]), CAMERA)


@pytest.mark.parametrize("pose", [*POSES, *(Pose(2.0, 2.0, 0.0, k / 3) for k in range(19))])
def test_culling_keeps_every_geom_that_a_ray_hits(drawable, pose):
    visibility = Visibility(drawable.house, *geom_bounds(drawable.model))
    data = mujoco.MjData(drawable.model)
    mujoco.mj_forward(drawable.model, data)
    T = T_of(pose)
    half = math.radians(79 / 2)
    visible = visibility.visible(pose.x_m, pose.y_m, 0.88, pose.yaw_rad, half)
    geom = np.empty(1, np.int32)
    for bearing in np.linspace(-half, half, 60):
        for slope in (-0.4, 0.0, 0.4):
            direction = T[:3, :3] @ (1.0, math.tan(bearing), slope)
            mujoco.mj_ray(drawable.model, data, T[:3, 3], direction, None, 1, -1, geom)
            assert geom[0] < 0 or visible[geom[0]]


def test_culling_leaves_out_the_other_room_behind_the_wall(drawable):
    visibility = Visibility(drawable.house, *geom_bounds(drawable.model))
    views = visibility.rooms_in_view(2.0, 2.0, 0.88, math.pi, math.radians(39.5))
    assert list(views) == [0]
    views = visibility.rooms_in_view(2.0, 2.0, 0.88, 0.0, math.radians(39.5))
    assert views[1][0] == pytest.approx(-math.atan(0.45 / 2.06))
    drum = int(np.flatnonzero(drawable.geom_instance == two_rooms.DRUM)[0])
    assert not visibility.visible(0.5, 0.4, 0.88, 0.0, math.radians(39.5))[drum]


def test_without_a_library_rays_are_cast_and_it_is_said_once(monkeypatch, caplog, drawable):
    monkeypatch.delenv("SPACEVLN_RENDERER", raising=False)
    monkeypatch.setattr(choice, "_probe", lambda: probe.Probe(None, "libEGL is not installed"))
    choice._say_once.cache_clear()
    info = renderer_info()
    assert info.name == "raycast"
    assert "libegl1" in info.install
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            assert isinstance(make_renderer(info, drawable, 64, 48), RaycastRenderer)
    assert len(caplog.records) == 1
    assert "libegl1" in caplog.text
    with pytest.raises(PrerequisiteError, match="apt-get install"):
        renderer_info("gl")


def test_the_environment_variable_decides_where_nothing_else_does(monkeypatch):
    monkeypatch.setenv("SPACEVLN_RENDERER", "raycast")
    assert renderer_info().name == "raycast"
    assert renderer_info().install == ""
    monkeypatch.setenv("SPACEVLN_RENDERER", "vulkan")
    with pytest.raises(UnknownNameError, match="vulkan"):
        renderer_info()


@pytest.mark.parametrize("setting", ["disable", "off"])
def test_mujoco_gl_can_switch_opengl_off(monkeypatch, setting):
    monkeypatch.setenv("MUJOCO_GL", setting)
    assert probe.probe_gl().backend is None


@pytest.mark.skipif(not HAS_GL, reason="no OpenGL library here")
def test_a_process_ends_without_noise():
    script = (
        "import two_rooms; from spacevln.core import *; from spacevln.environments.houses.environment import HousesEnvironment\n"
        "e = HousesEnvironment(Camera(64, 48, 79.0, 0.88), load=two_rooms.place)\n"
        "e.reset(EpisodeSpec('1', 'house-000000', Pose(1, 2), InstructionTask('go')))\n"
    )
    here = str(Path(__file__).parent)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": here},
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def _views(house) -> list[Pose]:
    """In every room, every doorway and along the stairs."""
    rng = np.random.default_rng(house.seed)
    poses = []
    for room in house.rooms:
        for rect in room.rects:
            x, y = rng.uniform(rect.x0 + 0.2, rect.x1 - 0.2), rng.uniform(rect.y0 + 0.2, rect.y1 - 0.2)
            poses.append(Pose(x, y, house.floors[room.floor].z_m, rng.uniform(-3, 3)))
    doors = [opening for opening in house.openings if opening.kind != "window"]
    poses += [Pose(door.x, door.y, house.floors[door.floor].z_m, rng.uniform(-3, 3)) for door in doors]
    for stairs in house.stairs:
        (x, y), low = stairs.rect.centre, house.floors[stairs.lower_floor].z_m
        for share in (-0.4, 0.0, 0.4):
            dx, dy = (
                share * stairs.rect.width * math.cos(stairs.up_yaw_rad),
                share * stairs.rect.depth * math.sin(stairs.up_yaw_rad),
            )
            height = low + (share + 0.5) * (house.floors[stairs.lower_floor + 1].z_m - low)
            poses += [Pose(x + dx, y + dy, height, stairs.up_yaw_rad + turn) for turn in (0.0, math.pi, 0.6)]
    return poses


@pytest.mark.parametrize("seed", [5, 8, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(40, 70))])
def test_a_culled_picture_of_a_furnished_house_is_the_whole_picture(seed, monkeypatch):
    drawable = load_place(f"house-{seed:06d}").drawable
    camera = Camera(96, 72, 79.0, 0.88)
    renderer = RaycastRenderer(drawable)
    culled = [renderer.render(T_of(pose), camera) for pose in _views(drawable.house)]
    monkeypatch.setattr(Visibility, "visible", lambda *_: np.ones(drawable.model.ngeom, np.bool_))
    for pose, frame in zip(_views(drawable.house), culled, strict=True):
        whole = renderer.render(T_of(pose), camera)
        np.testing.assert_array_equal(frame.instance_ids, whole.instance_ids, err_msg=str(pose))
        np.testing.assert_array_equal(frame.depth_m, whole.depth_m, err_msg=str(pose))


@pytest.mark.skipif(not HAS_GL, reason="no OpenGL library here")
def test_both_renderers_draw_the_same_furnished_house():
    drawable = load_place("house-000003").drawable
    gl, raycast = (make_renderer(renderer_info(name), drawable, 160, 120) for name in ("gl", "raycast"))
    for pose in _views(drawable.house)[::4]:
        a, b = gl.render(T_of(pose), CAMERA), raycast.render(T_of(pose), CAMERA)
        same = a.instance_ids == b.instance_ids
        assert same.mean() > 0.998
        assert np.percentile(np.abs(a.depth_m - b.depth_m), 99) < 1e-3
        assert np.abs(a.rgb.astype(int) - b.rgb)[same].mean() < 6
    gl.close()


@pytest.mark.skipif(not HAS_GL, reason="no OpenGL library here")
def test_a_forked_child_gets_a_sentence_instead_of_a_frozen_driver(monkeypatch, drawable):
    renderer = make_renderer(renderer_info("gl"), drawable, 64, 48)
    monkeypatch.setattr(os, "getpid", lambda: -1)
    with pytest.raises(EnvironmentFailure, match="spawn"):
        make_renderer(renderer_info("gl"), drawable, 64, 48)
    with pytest.raises(EnvironmentFailure, match="spawn"):
        renderer.render(T_of(POSES[0]), Camera(64, 48, 79.0, 0.88))
    monkeypatch.undo()
    renderer.close()


def test_casting_rays_loads_no_graphics_library():
    script = (
        "import sys, two_rooms; from spacevln.core import *\n"
        "from spacevln.environments.houses.environment import HousesEnvironment\n"
        "e = HousesEnvironment(load=two_rooms.place)\n"
        "e.reset(EpisodeSpec('1', 'house-000000', Pose(1, 2), InstructionTask('go')))\n"
        "assert 'OpenGL' not in sys.modules, 'OpenGL was loaded'\n"
        "assert e.spec.camera.width_px == 320\n"
    )
    here = str(Path(__file__).parent)
    env = {**os.environ, "PYTHONPATH": here, "SPACEVLN_RENDERER": "raycast"}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=env, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
