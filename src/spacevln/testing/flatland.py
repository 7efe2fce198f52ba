"""Flatland: a world of upright boxes with exact depth, for tests of everything that sees and moves.

Rooms are walls around nothing, furniture and door frames are boxes; a pixel's ray meets boxes, floor and ceiling in closed
form. No engine, no randomness, a few milliseconds an image.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core import (
    Action,
    Camera,
    ContractError,
    EnvironmentSpec,
    EpisodeSpec,
    InstanceLabel,
    Labels,
    Motion,
    MoveForward,
    Observation,
    Pose,
    Stop,
    TurnLeft,
    TurnRight,
)

Float = NDArray[np.float64]

BODY_RADIUS_M = 0.1
CEILING_M = 2.5
REACH_M = 50.0  # farther there is no measurement
_LINTEL_M = 2.0


@dataclass(frozen=True, slots=True)
class Box:
    """An upright box of the scene, or a wall.

    Args:
        x0_m, y0_m, x1_m, y1_m: footprint, scene frame.
        z0_m, z1_m: lower and upper end.
        category: label of the instance; ``""`` for what has none, such as walls.
        attributes: e.g. ``("white",)``.
        rgb: colour.
        passable: the body goes through it, as through the frame over a doorway.
        instance: boxes with the same category and instance name share one label; ``""`` = this box alone.
    """

    x0_m: float
    y0_m: float
    x1_m: float
    y1_m: float
    z0_m: float = 0.0
    z1_m: float = CEILING_M
    category: str = ""
    attributes: tuple[str, ...] = ()
    rgb: tuple[int, int, int] = (200, 200, 190)
    passable: bool = False
    instance: str = ""


def wall(start_m: tuple[float, float], end_m: tuple[float, float], gaps: Sequence[tuple[float, float]] = ()) -> list[Box]:
    """A wall along x or y, 0.1 m thick, with gaps given as intervals [m] along it from its start.

    Every gap becomes a doorway: a lintel with the category ``"doorway"`` and two posts of the same.
    """
    (x0, y0), (x1, y1) = start_m, end_m
    along_x = abs(x1 - x0) > abs(y1 - y0)
    length = abs(x1 - x0) + abs(y1 - y0)
    origin = min(x0, x1) if along_x else min(y0, y1)
    across = y0 if along_x else x0

    def box(a_m: float, b_m: float, z0_m: float = 0.0, category: str = "", instance: str = "") -> Box:
        half = 0.08 if category else 0.05
        a_m, b_m = origin + a_m, origin + b_m
        ends = (a_m, across - half, b_m, across + half) if along_x else (across - half, a_m, across + half, b_m)
        colour = (120, 80, 50) if category else (200, 200, 190)
        return Box(*ends, z0_m=z0_m, category=category, rgb=colour, passable=bool(z0_m), instance=instance)

    boxes, at = [], 0.0
    for a_m, b_m in sorted(gaps):
        name = f"{start_m} {end_m} {a_m}"
        boxes += [
            box(at, a_m),
            box(a_m, b_m, _LINTEL_M, "doorway", name),
            box(a_m, a_m + 0.06, 0.0, "doorway", name),
            box(b_m - 0.06, b_m, 0.0, "doorway", name),
        ]
        at = b_m
    return [*boxes, box(at, length)]


def two_rooms() -> tuple[Box, ...]:
    """Two rooms of 4 x 4 m side by side along x, joined by a doorway 1.0 m wide; a sofa in the first, a bed in the second.

    The first room spans x from -2 to 2 and y from -2 to 2 around the origin, the second x from 2 to 6.
    """
    return (
        *wall((-2, -2), (6, -2)),
        *wall((-2, 2), (6, 2)),
        *wall((-2, -2), (-2, 2)),
        *wall((2, -2), (2, 2), gaps=[(1.5, 2.5)]),
        *wall((6, -2), (6, 2)),
        Box(-1.9, 1.0, 0.0, 1.9, z1_m=0.8, category="sofa", attributes=("white",), rgb=(240, 240, 235)),
        Box(4.8, -1.0, 5.9, 1.0, z1_m=0.6, category="bed", attributes=("blue",), rgb=(60, 90, 200)),
    )


class Flatland:
    """An environment of boxes on one floor; walls and furniture stop a disc of radius 0.1 m where it touches, without sliding.

    Args:
        boxes: the scene, by default :func:`two_rooms`.
        camera: small by default, to be fast.
        step_m, turn_deg: of the primitives.
    """

    def __init__(
        self,
        boxes: Sequence[Box] | None = None,
        camera: Camera | None = None,
        step_m: float = 0.25,
        turn_deg: float = 30.0,
    ) -> None:
        self.boxes = tuple(two_rooms() if boxes is None else boxes)
        self._spec = EnvironmentSpec(camera or Camera(80, 60, 79.0, 0.88), step_m=step_m, turn_deg=turn_deg)
        self._start = Pose(0.0, 0.0)
        self._pose = Pose(0.0, 0.0)
        self._active = False
        names = [(box.category, box.instance or str(index)) for index, box in enumerate(self.boxes)]
        number = {name: index + 1 for index, name in enumerate(dict.fromkeys(name for name in names if name[0]))}
        self._ids = np.array([number.get(name, 0) for name in names], np.int32)

    @property
    def spec(self) -> EnvironmentSpec:
        """What the body can do and see."""
        return self._spec

    @property
    def scene_pose(self) -> Pose:
        """Where the body is, scene frame; for tests."""
        return self._pose

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Put the body at the episode's start; every scene name is this one world."""
        self._start = self._pose = episode.start
        self._active = True
        return self.observe()

    def observe(self) -> Observation:
        """What the camera sees now, with labels."""
        if not self._active:
            raise ContractError("Flatland was asked before reset, after Stop or after close: call reset first.")
        depth_m, hit = self._cast()
        colours = np.array([(230, 225, 215), (190, 170, 140), *(box.rgb for box in self.boxes)], np.uint8)
        ids = np.concatenate([np.zeros(2, np.int32), self._ids])[hit]
        instances = {
            int(self._ids[index]): InstanceLabel(box.category, box.attributes)
            for index, box in enumerate(self.boxes)
            if self._ids[index] and np.any(ids == self._ids[index])
        }
        return Observation(
            rgb=colours[hit],
            depth_m=depth_m.astype(np.float32),
            pose=self._pose.relative_to(self._start),
            camera=self._spec.camera,
            labels=Labels(ids, instances),
        )

    def execute(self, action: Action) -> Motion:
        """Carry out one primitive."""
        if not self._active:
            raise ContractError("Flatland was moved before reset, after Stop or after close: call reset first.")
        match action:
            case Stop():
                self._active = False
                return Motion(0.0, 0.0, False)
            case MoveForward(distance_m=distance_m):
                return self._forward(distance_m)
            case TurnLeft(angle_deg=angle_deg):
                return self._turn(math.radians(angle_deg))
            case TurnRight(angle_deg=angle_deg):
                return self._turn(-math.radians(angle_deg))

    def close(self) -> None:
        """Nothing to free."""
        self._active = False

    def _turn(self, angle_rad: float) -> Motion:
        self._pose = self._pose.turned(angle_rad)
        return Motion(0.0, angle_rad, False)

    def _forward(self, distance_m: float) -> Motion:
        """Advance in millimetres until the disc touches something."""
        heading = np.array([math.cos(self._pose.yaw_rad), math.sin(self._pose.yaw_rad)])
        lengths = np.linspace(0.0, distance_m, max(2, round(distance_m / 0.001) + 1))
        points = self._pose.xy_m + lengths[:, None] * heading
        clear = np.ones(len(points), bool)
        for box in self.boxes:
            if not box.passable and box.z0_m < 1.3:
                dx = np.maximum(np.maximum(box.x0_m - points[:, 0], points[:, 0] - box.x1_m), 0.0)
                dy = np.maximum(np.maximum(box.y0_m - points[:, 1], points[:, 1] - box.y1_m), 0.0)
                clear &= np.hypot(dx, dy) >= BODY_RADIUS_M
        hits = np.flatnonzero(~clear[1:])
        last = int(hits[0]) if len(hits) else len(points) - 1
        self._pose = Pose(float(points[last, 0]), float(points[last, 1]), self._pose.z_m, self._pose.yaw_rad)
        return Motion(float(lengths[last]), 0.0, bool(len(hits)))

    def _cast(self) -> tuple[Float, NDArray[np.intp]]:
        """Depth (H, W) [m] and what is seen there: 0 ceiling, 1 floor, 2 + index a box."""
        camera = self._spec.camera
        lateral = (camera.cx_px - np.arange(camera.width_px) - 0.5) / camera.fx_px  # left positive
        rise: Float = ((camera.cy_px - np.arange(camera.height_px, dtype=np.float64) - 0.5) / camera.fy_px)[:, None]
        rise[rise == 0.0] = 1e-12  # a level ray is not divided by zero
        c, s = math.cos(self._pose.yaw_rad), math.sin(self._pose.yaw_rad)
        ray = np.stack([c - s * lateral, s + c * lateral])  # per unit of depth
        depth = np.where(rise > 0, (CEILING_M - camera.height_m) / rise, -camera.height_m / rise)
        depth = np.broadcast_to(depth, (camera.height_px, camera.width_px)).copy()
        hit = np.broadcast_to((rise < 0).astype(np.intp), depth.shape).copy()
        for index, box in enumerate(self.boxes):
            met = self._meet(box, ray, rise)
            nearer = met < depth
            depth[nearer], hit[nearer] = met[nearer], 2 + index
        depth[depth > REACH_M] = 0.0
        return depth, hit

    def _meet(self, box: Box, ray: Float, rise: Float) -> Float:
        """Depth (H, W) at which each pixel's ray enters a box; inf where it misses (slab method)."""
        low = np.array([box.x0_m - self._pose.x_m, box.y0_m - self._pose.y_m])[:, None]
        high = np.array([box.x1_m - self._pose.x_m, box.y1_m - self._pose.y_m])[:, None]
        z = np.array([box.z0_m, box.z1_m]) - self._spec.camera.height_m
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack([low / ray, high / ray])
            heights = np.stack([z[0] / rise, z[1] / rise])
        enter = np.maximum(np.nanmax(ends.min(axis=0), axis=0)[None, :], heights.min(axis=0))
        leave = np.minimum(np.nanmin(ends.max(axis=0), axis=0)[None, :], heights.max(axis=0))
        return np.where((leave > np.maximum(enter, 0.0)) & (leave > 0), np.maximum(enter, 1e-3), np.inf)
