"""A scripted walk through a furnished house and its geometry, taken from the triangles and not from the map."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import mujoco
import numpy as np
from scipy import ndimage

from spacevln.core import Camera, Observation, Pose
from spacevln.environments.houses.environment import Place, load_place
from spacevln.environments.houses.geodesics import Geodesics
from spacevln.environments.houses.rendering import make_renderer, renderer_info
from spacevln.environments.houses.walkable import Walkable
from spacevln.mapping import MetricMap

CAMERA = Camera(640, 480, 79.0, 0.88)
TRUTH_M = 0.02
CELL_M = 0.05


@dataclass
class Walk:
    """Frames of a walk, in the episode frame whose origin is ``start`` in the scene frame."""

    place: Place
    start: Pose
    scene_poses: list[Pose]
    frames: list[Observation]
    geodesics: Geodesics
    world_map: MetricMap = field(default_factory=MetricMap)

    def to_scene(self, xy: np.ndarray) -> np.ndarray:
        c, s = math.cos(self.start.yaw_rad), math.sin(self.start.yaw_rad)
        return xy @ np.array([[c, s], [-s, c]]) + self.start.xy_m

    def to_episode(self, xy: np.ndarray) -> np.ndarray:
        c, s = math.cos(self.start.yaw_rad), math.sin(self.start.yaw_rad)
        return (xy - self.start.xy_m) @ np.array([[c, -s], [s, c]])


def walk_house(seed: int, floor: int = 0, rooms: int = 20) -> Walk:
    """Visit the rooms of one floor, looking around in each and every 2.5 m."""
    place = load_place(f"house-{seed:06d}")
    house, walkable = place.drawable.house, place.ground
    geodesics = Geodesics(walkable)
    rng = np.random.default_rng([seed, 77])
    space = walkable.floors[floor]
    open_cells = np.argwhere(space.clearance_m >= 0.2)
    points = np.array(space.origin_m) + (open_cells + 0.5) * 0.05
    z = house.floors[floor].z_m
    targets = []
    for room in house.rooms:
        inside = [p for p in points if room.floor == floor and room.contains(p[0], p[1], 0.2)]
        if inside:
            targets.append((*inside[int(rng.integers(len(inside)))], z))
    targets = targets[:rooms]
    poses = list(_poses(geodesics, walkable, targets, float(rng.uniform(-math.pi, math.pi))))
    renderer = make_renderer(renderer_info("auto"), place.drawable, CAMERA.width_px, CAMERA.height_px)
    walk = Walk(place, poses[0], poses, [], geodesics)
    for pose in poses:
        T_scene_camera = pose.T_world_body
        T_scene_camera[2, 3] += CAMERA.height_m
        frame = renderer.render(T_scene_camera, CAMERA)
        walk.frames.append(Observation(frame.rgb, frame.depth_m.copy(), pose.relative_to(walk.start), CAMERA))
    renderer.close()
    for observation in walk.frames:
        walk.world_map.integrate(observation)
    return walk


def _poses(geodesics: Geodesics, walkable: Walkable, targets: list[tuple[float, float, float]], yaw: float) -> Iterator[Pose]:
    at = targets[0]
    since = math.inf
    for target in targets:
        path = geodesics.path(at, target) if target != at else np.array([at])
        if not len(path):
            continue
        legs = [path[:1]]
        for a, b in pairwise(path):
            n = max(1, math.ceil(math.dist(a[:2], b[:2]) / 0.25))
            legs.append(a + (b - a) * (np.arange(1, n + 1) / n)[:, None])
        line = np.concatenate(legs)
        for k, point in enumerate(line):
            x, y = float(point[0]), float(point[1])
            z = walkable.floor_height_m(x, y, float(point[2]))
            if k:
                yaw = (
                    math.atan2(y - line[k - 1][1], x - line[k - 1][0]) if math.dist(line[k][:2], line[k - 1][:2]) > 0.01 else yaw
                )
            since += 0.25
            turns = 12 if since > 2.5 or k == len(line) - 1 else 1
            since = 0.0 if turns == 12 else since
            for turn in range(turns):
                yield Pose(x, y, z, yaw + turn * math.pi / 6)
        at = target


@dataclass
class Truth:
    """What stands 0.15 to 1.30 m over one floor, on cells of 2 cm (scene frame)."""

    origin: np.ndarray
    solid: np.ndarray
    distance_m: np.ndarray
    inside_m: np.ndarray

    def at(self, grid: np.ndarray, xy: np.ndarray) -> np.ndarray:
        ij = np.clip(np.floor((xy - self.origin) / TRUTH_M).astype(int), 0, np.array(grid.shape) - 1)
        return grid[ij[:, 0], ij[:, 1]]


def truth_of(place: Place, floor: int = 0) -> Truth:
    """Sample the triangles of the scene, and add the footprints of walls and furniture, whose insides have no surface."""
    model = place.drawable.model
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    z0 = place.drawable.house.floors[floor].z_m
    space = place.ground.floors[floor]
    origin = np.array(space.origin_m) - 1.0
    shape = tuple(np.ceil((np.array(space.clearance_m.shape) * 0.05 + 2.0) / TRUTH_M).astype(int))
    solid = np.zeros(shape, bool)
    for points in _surface_points(model, data, z0 + 0.15, z0 + 1.30):
        points = points[(points[:, 2] >= z0 + 0.15) & (points[:, 2] <= z0 + 1.30)]
        ij = np.floor((points[:, :2] - origin) / TRUTH_M).astype(int)
        ij = ij[((ij >= 0) & (ij < shape)).all(axis=1)]
        solid[ij[:, 0], ij[:, 1]] = True
    centres = origin + (np.stack(np.meshgrid(np.arange(shape[0]), np.arange(shape[1]), indexing="ij"), -1) + 0.5) * TRUTH_M
    for x, y, c, s, hx, hy in space.boxes:
        dx, dy = centres[..., 0] - x, centres[..., 1] - y
        solid |= (np.abs(c * dx + s * dy) <= hx) & (np.abs(c * dy - s * dx) <= hy)
    for x, y, radius in space.discs:
        solid |= np.hypot(centres[..., 0] - x, centres[..., 1] - y) <= radius
    outside, inside = (ndimage.distance_transform_edt(grid) * TRUTH_M for grid in (~solid, solid))
    return Truth(origin, solid, outside, inside)


def _surface_points(model: mujoco.MjModel, data: mujoco.MjData, low: float, high: float) -> Iterator[np.ndarray]:
    for geom in range(model.ngeom):
        mesh = model.geom_dataid[geom]
        start, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        vertices = model.mesh_vert[start : start + count] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        start, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        triangles = vertices[model.mesh_face[start : start + count]]
        within = (triangles[..., 2].max(axis=1) >= low) & (triangles[..., 2].min(axis=1) <= high)
        for a, b, c in triangles[within]:
            n = math.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b)) / 0.012) + 1
            u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
            keep = u + v <= 1.0001
            yield a + u[keep][:, None] * (b - a) + v[keep][:, None] * (c - a)


def map_cells(walk: Walk) -> np.ndarray:
    """Centres of all cells around the walk, episode frame."""
    xy = np.array([frame.pose.xy_m for frame in walk.frames])
    low, high = np.floor((xy.min(axis=0) - 6) / CELL_M), np.ceil((xy.max(axis=0) + 6) / CELL_M)
    x, y = (np.arange(low[k], high[k]) + 0.5 for k in (0, 1))
    return np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2) * CELL_M


def often_seen(walk: Walk) -> np.ndarray:
    """Cells (episode frame) in which at least 3 depth pixels of obstacle height fell."""
    counts: dict[tuple[int, int], int] = {}
    for frame in walk.frames:
        camera, d = frame.camera, frame.depth_m
        u, v = np.meshgrid(np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5)
        local = np.stack([d, -(u - camera.cx_px) / camera.fx_px * d, -(v - camera.cy_px) / camera.fy_px * d], -1).reshape(-1, 3)
        z = local[:, 2] + camera.height_m
        use = (local[:, 0] >= 0.5) & (local[:, 0] <= 5.0) & (z >= 0.15) & (z <= 1.30)
        points = local[use] @ frame.T_world_camera[:3, :3].T + frame.T_world_camera[:3, 3]
        cells = np.floor(points[:, :2] / CELL_M).astype(np.int64)
        keys, number = np.unique(cells[:, 0] * 100003 + cells[:, 1], return_counts=True)
        for key, count in zip(keys.tolist(), number.tolist(), strict=True):
            counts[key] = counts.get(key, 0) + count
    keys = np.array([key for key, count in counts.items() if count >= 3])
    i = np.round(keys / 100003).astype(np.int64)
    return (np.column_stack([i, keys - i * 100003]) + 0.5) * CELL_M


def visible_floor(walk: Walk, truth: Truth, per_frame: int, rng: np.random.Generator) -> np.ndarray:
    """Floor cells (episode frame) that a 3-D ray from the camera reaches; a sample of each frame's."""
    model = walk.place.drawable.model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    found, geom = [], np.zeros(1, np.int32)
    for pose, frame in zip(walk.scene_poses, walk.frames, strict=True):
        d, side = rng.uniform(0.5, 5.0, per_frame), rng.uniform(-1, 1, per_frame)
        local = np.column_stack([d, d * side * math.tan(math.radians(39.5))])
        c, s = math.cos(frame.pose.yaw_rad), math.sin(frame.pose.yaw_rad)
        cells = (np.floor((local @ np.array([[c, s], [-s, c]]) + frame.pose.xy_m) / CELL_M) + 0.5) * CELL_M
        scene = walk.to_scene(cells)
        origin = pose.position_m + np.array([0, 0, 0.88])
        for cell, (x, y) in zip(cells, scene, strict=True):
            if truth.at(truth.distance_m, np.array([(x, y)]))[0] <= 0:
                continue
            ray = np.array([x, y, pose.z_m + 0.004]) - origin
            forward = ray[0] * math.cos(pose.yaw_rad) + ray[1] * math.sin(pose.yaw_rad)
            left = ray[1] * math.cos(pose.yaw_rad) - ray[0] * math.sin(pose.yaw_rad)
            if not (0.5 <= forward <= 5.0) or 0.88 / forward > 240 / CAMERA.fy_px or abs(left) / forward > 320 / CAMERA.fx_px:
                continue
            if walk.place.ground.clearance_m(x, y, pose.z_m) <= 0:
                continue
            hit = mujoco.mj_ray(model, data, origin, ray, None, 1, -1, geom)
            if hit < 0 or hit > 0.998:
                found.append(cell)
    return np.unique(np.array(found), axis=0)
