"""The map of analytic rooms against their exact geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worlds import CAMERA, FULL, Box, cast, look, look_around, room

from spacevln.core import Camera, Observation, Pose, Sighting, UsageError
from spacevln.mapping import MetricMap

TABLE: Box = (1.5, 0.5, 0.70, 2.7, 1.5, 0.75)
CRATE: Box = (-3.0, -2.0, 0.0, -2.2, -1.2, 0.6)
STOOL: Box = (1.2, -1.9, 0.0, 1.5, -1.6, 0.35)
WORLD = [*room(-4.03, -3.02, 4.01, 3.04), TABLE, CRATE, STOOL]


def cells(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    """Centres of the map's cells inside a rectangle."""
    x = (np.arange(math.floor(x0 / 0.05), math.ceil(x1 / 0.05)) + 0.5) * 0.05
    y = (np.arange(math.floor(y0 / 0.05), math.ceil(y1 / 0.05)) + 0.5) * 0.05
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def distance_to_solid(points: np.ndarray) -> np.ndarray:
    """Horizontal distance to what stands 0.15 to 1.30 m over the floor."""
    best = np.full(len(points), np.inf)
    for x0, y0, z0, x1, y1, z1 in WORLD:
        if z1 > 0.15 and z0 < 1.30:
            dx = np.maximum(0, np.maximum(x0 - points[:, 0], points[:, 0] - x1))
            dy = np.maximum(0, np.maximum(y0 - points[:, 1], points[:, 1] - y1))
            best = np.minimum(best, np.hypot(dx, dy))
    return best


@pytest.fixture(scope="module")
def explored() -> tuple[MetricMap, list[Observation]]:
    world_map = MetricMap()
    frames = [
        frame
        for x, y in [(0, 0), (-2.5, 1.5), (3.0, -2.0)]
        for frame in look_around(WORLD, Pose(x, y), Camera(320, 240, 79, 0.88))
    ]
    for frame in frames:
        world_map.integrate(frame)
    return world_map, frames


def test_obstacles_are_where_something_stands(explored: tuple[MetricMap, list[Observation]]) -> None:
    points = cells(-4.5, -3.5, 4.5, 3.5)
    marked = points[explored[0].is_obstacle(points)]
    assert len(marked) > 400
    assert np.mean(distance_to_solid(marked) <= 0.10) >= 0.99


def test_surfaces_that_were_seen_are_obstacles(explored: tuple[MetricMap, list[Observation]]) -> None:
    world_map, frames = explored
    seen: dict[tuple[int, int], int] = {}
    for frame in frames:
        camera = frame.camera
        u, v = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
        d = frame.depth_m
        local = np.stack([d, -(u - camera.cx_px) / camera.fx_px * d, -(v - camera.cy_px) / camera.fy_px * d], axis=-1)
        points = local.reshape(-1, 3) @ frame.T_world_camera[:3, :3].T + frame.T_world_camera[:3, 3]
        use = (d.ravel() >= 0.5) & (d.ravel() <= 5.0) & (points[:, 2] > 0.16) & (points[:, 2] < 1.29)
        for cell, count in zip(*np.unique(np.floor(points[use, :2] / 0.05).astype(int), axis=0, return_counts=True), strict=True):
            key = (int(cell[0]), int(cell[1]))
            seen[key] = seen.get(key, 0) + int(count)
    often = (np.array([key for key, count in seen.items() if count >= 3]) + 0.5) * 0.05
    assert np.mean(world_map.is_obstacle(often)) >= 0.95


def test_free_cells_are_free_and_free_is_neither_obstacle_nor_unknown(explored: tuple[MetricMap, list[Observation]]) -> None:
    world_map, points = explored[0], cells(-4.5, -3.5, 4.5, 3.5)
    free, obstacle, known = world_map.is_free(points), world_map.is_obstacle(points), world_map.is_explored(points)
    assert np.mean(distance_to_solid(points[free]) > 0) >= 0.98
    assert not (free & obstacle).any()
    assert known[free | obstacle].all()
    assert (free | obstacle)[known].mean() > 0.97  # the rest is floor under something


def test_floor_that_rays_reach_is_explored(explored: tuple[MetricMap, list[Observation]]) -> None:
    world_map, frames = explored
    points = cells(-4.0, -3.0, 4.0, 3.0)
    points = points[distance_to_solid(points) > 0.0]
    visible = np.zeros(len(points), np.bool_)
    for frame in frames:
        origin = frame.T_world_camera[:3, 3]
        toward = np.column_stack([points, np.zeros(len(points))]) - origin
        local = toward @ frame.T_world_camera[:3, :3]
        camera = frame.camera
        with np.errstate(divide="ignore", invalid="ignore"):
            u = camera.cx_px - camera.fx_px * local[:, 1] / local[:, 0]
            v = camera.cy_px - camera.fy_px * local[:, 2] / local[:, 0]
            inside = (
                (local[:, 0] >= 0.5) & (local[:, 0] <= 5.0) & (u >= 0) & (u < camera.width_px) & (v >= 0) & (v < camera.height_px)
            )
        visible[inside] |= cast(WORLD, origin, toward[inside]) > 0.999
    assert visible.sum() > 10000
    assert np.mean(world_map.is_explored(points[visible])) >= 0.97


def test_the_floor_under_a_table_is_not_free(explored: tuple[MetricMap, list[Observation]]) -> None:
    world_map = explored[0]
    top = cells(TABLE[0] + 0.03, TABLE[1] + 0.03, TABLE[3] - 0.05, TABLE[4] - 0.05)
    assert world_map.is_obstacle(top).mean() > 0.9
    assert world_map.is_free(top).mean() < 0.1


def test_line_of_sight_and_ways_around_the_table(explored: tuple[MetricMap, list[Observation]]) -> None:
    world_map = explored[0]
    assert world_map.line_of_sight((0, 0), (-2, 2))
    assert not world_map.line_of_sight((0, 1), (3.5, 1))
    assert not world_map.line_of_sight((0, 0), (6, 0))
    way = world_map.path((0, 1), (3.4, 1))
    assert np.allclose(way[[0, -1]], [(0, 1), (3.4, 1)])
    length = float(np.hypot(*np.diff(way, axis=0).T).sum())
    corner = 0.1 + 0.025
    exact = 2 * math.hypot(1.5, 0.5 + corner) + 1.2 + 0.7 - 0.7
    assert world_map.geodesic_m((0, 1), (3.4, 1)) == pytest.approx(length, rel=0.03)
    assert 3.4 < length <= exact
    assert world_map.geodesic_m((0, 0), (9, 9)) == math.inf
    assert world_map.path((0, 0), (9, 9)).shape == (0, 2)


def test_removed_things_are_cleared_and_the_rest_stays() -> None:
    before, after = [*room(-3, -3, 3, 3), TABLE, STOOL], [*room(-3, -3, 3, 3), TABLE]
    world_map = MetricMap()
    for frame in look_around(before, Pose(0, 0)):
        world_map.integrate(frame)
    stool, table = cells(*STOOL[:2], *STOOL[3:5]), cells(TABLE[0] + 0.05, TABLE[1] + 0.05, 2.5, 1.4)
    assert world_map.is_obstacle(stool).any()
    marked = world_map.is_obstacle(table)
    for _ in range(2):
        for frame in look_around(after, Pose(0, 0)):
            world_map.integrate(frame)
    assert not world_map.is_obstacle(stool).any()
    assert world_map.is_free(stool).all()
    assert world_map.is_obstacle(table)[marked].all()


def test_bad_depth_is_no_measurement() -> None:
    frame = look(WORLD, Pose(0, 0))
    for bad in (0.0, -1.0, np.nan, np.inf, 0.3, 5.5, 65.535):
        world_map = MetricMap()
        depth = np.full_like(frame.depth_m, bad)
        world_map.integrate(Observation(frame.rgb, depth, frame.pose, frame.camera))
        points = cells(-6, -6, 6, 6)
        known = points[world_map.is_explored(points)]
        assert np.hypot(*known.T).max() <= 0.15, bad
        assert not world_map.is_obstacle(points).any()


def test_own_footprint_and_the_way_between_frames_are_free() -> None:
    world_map = MetricMap()
    blank = np.zeros((120, 160), np.float32)
    for x in (0.0, 0.25, 0.5):
        world_map.integrate(Observation(np.zeros((120, 160, 3), np.uint8), blank, Pose(x, 0), CAMERA))
    assert world_map.is_free([(0, 0), (0.12, 0.05), (0.37, -0.05), (0.55, 0.0)]).all()
    assert world_map.geodesic_m((0, 0), (0.5, 0)) == pytest.approx(0.5, abs=0.01)
    assert np.array_equal(world_map.travelled, [(0, 0, 0), (0.25, 0, 0), (0.5, 0, 0)])
    world_map.start_stage()
    world_map.integrate(Observation(np.zeros((120, 160, 3), np.uint8), blank, Pose(0.75, 0), CAMERA))
    assert np.array_equal(world_map.travelled_stage, [(0.5, 0, 0), (0.75, 0, 0)])
    assert len(world_map.travelled) == 4


@pytest.mark.parametrize("size", [(640, 480), (160, 120)])
def test_obstacle_distances_by_sector(size: tuple[int, int]) -> None:
    frame = look(room(-1, -3, 1.7, 3), Pose(0, 0), Camera(*size, 79, 0.88))
    world_map = MetricMap()
    world_map.integrate(frame)
    distances = world_map.obstacle_distances(frame)
    assert distances.front_m == pytest.approx(1.7, abs=0.05)
    side = 1.7 / math.cos(math.pi / 6) - 0.1 * math.tan(math.pi / 6)
    assert distances.left_30_m == pytest.approx(side, abs=0.08)
    assert distances.right_30_m == pytest.approx(distances.left_30_m, abs=0.06)


def test_front_counts_what_the_body_would_touch() -> None:
    post = (1.0, 0.05, 0.0, 1.1, 0.08, 1.5)
    beside = (1.0, 0.14, 0.0, 1.1, 0.17, 1.5)
    for thing, expected in ((post, 1.0), (beside, 3.0)):
        frame = look([*room(-1, -3, 3, 3), thing], Pose(0, 0), Camera(640, 480, 79, 0.88))
        world_map = MetricMap()
        world_map.integrate(frame)
        assert world_map.sector_distance_m(frame) == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("wall_m", [0.3, 0.45, 0.51])
def test_too_near_to_measure_is_blocked(wall_m: float) -> None:
    frame = look(room(-1, -3, wall_m, 3), Pose(0, 0))
    world_map = MetricMap()
    world_map.integrate(frame)
    assert world_map.obstacle_distances(frame).front_m == pytest.approx(0.49)


def test_what_left_the_image_is_remembered_ahead() -> None:
    world = [*room(-3, -3, 5, 3), (1.6, -0.5, 0.0, 2.0, 0.5, 0.3)]
    world_map = MetricMap()
    for x in (0.0, 0.25, 0.5, 0.75, 1.0):
        frame = look(world, Pose(x, 0))
        world_map.integrate(frame)
        assert world_map.sector_distance_m(frame) == pytest.approx(1.6 - x, abs=0.06)


def test_landmark_channels_are_dropped_with_the_stage() -> None:
    world_map = MetricMap()
    sofa = Sighting("sofa", 0.9, (0, 0, 5, 5), (1.0, 0.5, 0.4), 1.1, 0.46, 0.6)
    world_map.integrate(look(WORLD, Pose(0, 0)), [sofa])
    crop = world_map.crop((0, 0), 6.0)
    row, column = np.argwhere(crop.semantic["sofa"]).mean(axis=0)
    assert np.allclose(crop.to_xy((column, row)), (1.0, 0.5), atol=0.06)
    world_map.start_stage()
    assert world_map.crop((0, 0), 6.0).semantic == {}


def test_crops_show_the_map_in_both_orientations(explored: tuple[MetricMap, list[Observation]]) -> None:
    world_map = explored[0]
    for heading in (None, 0.0, 0.7, -2.5):
        crop = world_map.crop((0.3, -0.2), 10.0, heading)
        assert crop.free.shape == (200, 200)
        rows, columns = np.nonzero(np.ones_like(crop.free))
        points = crop.to_xy(np.column_stack([columns, rows]))
        assert np.mean(world_map.is_obstacle(points) == crop.obstacle.ravel()) > 0.999
        assert np.mean(world_map.is_free(points) == crop.free.ravel()) > 0.999
        assert np.allclose(crop.to_px(points), np.column_stack([columns, rows]))
        ahead = crop.to_px([(0.3 + math.cos(crop.up_rad), -0.2 + math.sin(crop.up_rad))])[0]
        assert ahead[0] == pytest.approx(99.5)
        assert ahead[1] == pytest.approx(79.5)
    assert world_map.crop((0, 0), 10.0).trajectory.any()


def test_frontiers_border_the_unknown_and_can_be_reached() -> None:
    world = [*room(-3, -3, 3, 3), (0.5, -1.0, 0, 0.6, 3, 2.6)]
    world_map = MetricMap()
    for frame in look_around(world, Pose(-1, 1)):
        world_map.integrate(frame)
    frontiers = world_map.frontiers(Pose(-1, 1, 0, 0.5))
    assert frontiers
    assert [f.geodesic_m for f in frontiers] == sorted(f.geodesic_m for f in frontiers)
    for frontier in frontiers:
        assert frontier.width_m >= 0.3
        assert frontier.geodesic_m == pytest.approx(world_map.geodesic_m((-1, 1), frontier.position_m), abs=0.03)
        beside = np.array([(0.05, 0), (-0.05, 0), (0, 0.05), (0, -0.05)])
        around = np.array(frontier.position_m) + np.concatenate([beside, 2 * beside])
        assert not world_map.is_explored(around).all()
    assert any(f.position_m[0] > 0.3 and f.position_m[1] < -0.8 for f in frontiers)
    for frame in look_around(world, Pose(2, 0)):
        world_map.integrate(frame)
    for frame in look_around(world, Pose(1, -2)):
        world_map.integrate(frame)
    assert sum(f.width_m for f in world_map.frontiers(Pose(-1, 1))) < 1.0


@pytest.mark.parametrize("yaw_deg", range(0, 91, 15))
def test_what_one_image_shows_has_frontiers_on_both_sides_and_at_its_end(yaw_deg: int) -> None:
    """Also where its sides lie across the cells, which show the floor and not the space over it."""
    yaw = math.radians(yaw_deg)
    world_map = MetricMap()
    world_map.integrate(look(room(-9, -9, 9, 9), Pose(0, 0, 0, yaw), FULL))
    frontiers = world_map.frontiers(Pose(0, 0, 0, yaw))
    places = np.array([frontier.position_m for frontier in frontiers])
    bearings = np.degrees([frontier.bearing_rad for frontier in frontiers])
    far = np.hypot(*places.T) > 1.5
    assert (bearings[far] > 25).any()
    assert (bearings[far] < -25).any()
    assert (np.abs(bearings[far]) < 25).any()
    assert sum(frontier.width_m for frontier in frontiers) > 12.0  # two sides of 4.5 m and an arc of 6.5
    assert max(frontier.width_m for frontier in frontiers) < 2.5  # a long border is several places


def test_wrong_input_is_refused_with_a_sentence() -> None:
    world_map = MetricMap()
    frame = look(WORLD, Pose(0, 0))
    with pytest.raises(UsageError, match=r"\(N, 2\)"):
        world_map.is_free(np.zeros((4, 3)))
    with pytest.raises(UsageError, match="finite"):
        world_map.geodesic_m((0, math.nan), (1, 1))
    with pytest.raises(UsageError, match="not finite"):
        world_map.integrate(Observation(frame.rgb, frame.depth_m, Pose(math.nan, 0), frame.camera))
    with pytest.raises(UsageError, match="divide raw millimetres"):
        Observation(frame.rgb, (frame.depth_m * 1000).astype(np.uint16), frame.pose, frame.camera)
    with pytest.raises(UsageError, match="divide millimetres"):
        world_map.integrate(Observation(frame.rgb, frame.depth_m * 1000, frame.pose, frame.camera))
    optical = frame.T_world_camera.copy()
    optical[:3, :3] = optical[:3, :3] @ np.array([(0, 0, 1), (-1, 0, 0), (0, -1, 0)])
    with pytest.raises(UsageError, match="convert optical frames"):
        world_map.integrate(Observation(frame.rgb, frame.depth_m, frame.pose, frame.camera, optical))
    with pytest.raises(UsageError, match="where a rotation is needed"):
        world_map.integrate(Observation(frame.rgb, frame.depth_m, frame.pose, frame.camera, 2 * frame.T_world_camera))
    with pytest.raises(UsageError, match="one depth in metres per pixel"):
        Observation(frame.rgb, frame.depth_m[:-1], frame.pose, frame.camera)
    with pytest.raises(UsageError, match="cells of"):
        MetricMap(resolution_m=0.0)
    with pytest.raises(UsageError, match="side of the square"):
        world_map.crop((0, 0), -1.0)
    with pytest.raises(UsageError, match="Floor 3"):
        world_map.crop((0, 0), 5.0, floor=3)


def test_an_empty_map_answers() -> None:
    world_map = MetricMap()
    assert not world_map.is_explored([(0, 0)])[0]
    assert world_map.geodesic_m((0, 0), (1, 0)) == math.inf
    assert world_map.frontiers(Pose(0, 0)) == ()
    assert world_map.is_free(np.zeros((0, 2))).shape == (0,)
    assert not world_map.crop((0, 0), 5.0).explored.any()
    assert world_map.floor == 0
