"""What a camera gives: Camera, Observation, simulator Labels, Detection."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import UsageError
from spacevln.core.geometry import Float, Pose


@dataclass(frozen=True, slots=True)
class Camera:
    """A rectified pinhole camera looking along the heading.

    Pixel centres lie at half-integers: a ray through column ``u`` has the lateral slope ``(u + 0.5 - cx_px) / fx_px``.

    Args:
        width_px, height_px: image size.
        hfov_deg: horizontal field of view, used for ``fx_px`` when that is not given.
        height_m: height of the optical centre over the feet.
        fx_px, fy_px, cx_px, cy_px: intrinsics; by default square pixels and the image centre.
    """

    width_px: int
    height_px: int
    hfov_deg: float
    height_m: float
    fx_px: float = 0.0
    fy_px: float = 0.0
    cx_px: float = 0.0
    cy_px: float = 0.0

    def __post_init__(self) -> None:
        if self.width_px <= 0 or self.height_px <= 0:
            raise UsageError(
                f"Camera size {self.width_px}x{self.height_px} px is not positive: give the image's width and height."
            )
        if not 0 < self.hfov_deg < 180:
            raise UsageError(
                f"Camera hfov_deg={self.hfov_deg} is outside (0, 180): give the horizontal field of view in degrees."
            )
        fx = self.fx_px or self.width_px / 2 / math.tan(math.radians(self.hfov_deg) / 2)
        object.__setattr__(self, "fx_px", fx)
        object.__setattr__(self, "fy_px", self.fy_px or fx)
        object.__setattr__(self, "cx_px", self.cx_px or self.width_px / 2)
        object.__setattr__(self, "cy_px", self.cy_px or self.height_px / 2)

    @property
    def vfov_deg(self) -> float:
        """Vertical field of view [deg]."""
        return math.degrees(2 * math.atan(self.height_px / 2 / self.fy_px))


@dataclass(frozen=True, slots=True)
class InstanceLabel:
    """What a simulator calls one instance: category and attributes, e.g. ``("sofa", ("white", "leather"))``."""

    category: str
    attributes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Labels:
    """Simulator labels of one image. Only the label detector may read them; they never name room types.

    Args:
        instance_ids: (H, W) int32; 0 = nothing that has a label.
        instances: label of every id present in this very image.
    """

    instance_ids: NDArray[np.int32]
    instances: Mapping[int, InstanceLabel]


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """One posed RGB-D image.

    Args:
        rgb: (H, W, 3) uint8.
        depth_m: (H, W) float32, metres along the optical axis, 0 = no measurement.
        pose: the agent's pose in the episode frame.
        camera: intrinsics and height.
        T_world_camera: (4, 4), camera frame (x forward along the optical axis, y left, z up) to world; by default a level
            camera at ``camera.height_m`` over the feet.
        labels: simulator labels, if there are any.
    """

    rgb: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    pose: Pose
    camera: Camera
    T_world_camera: Float = None  # type: ignore[assignment]  # derived below when not given
    labels: Labels | None = None

    def __post_init__(self) -> None:
        size = (self.camera.height_px, self.camera.width_px)
        if self.depth_m.shape != size:
            raise UsageError(
                f"Observation.depth_m has shape {self.depth_m.shape}, the camera says {size}: give one depth in metres per pixel."
            )
        if not np.issubdtype(self.depth_m.dtype, np.floating):
            raise UsageError(
                f"Observation.depth_m has type {self.depth_m.dtype}, needed are floating-point metres: "
                "divide raw millimetres by 1000."
            )
        if self.rgb.shape != (*size, 3) or self.rgb.dtype != np.uint8:
            raise UsageError(
                f"Observation.rgb has shape {self.rgb.shape} and type {self.rgb.dtype}, needed is {(*size, 3)} uint8."
            )
        if self.T_world_camera is None:
            T_world_camera = self.pose.T_world_body
            T_world_camera[2, 3] += self.camera.height_m
            object.__setattr__(self, "T_world_camera", T_world_camera)
        elif self.T_world_camera.shape != (4, 4):
            raise UsageError(f"Observation.T_world_camera has shape {self.T_world_camera.shape}, needed is a homogeneous (4, 4).")


@dataclass(frozen=True, slots=True, eq=False)
class Detection:
    """One grounded phrase in one image.

    Args:
        category: the normalised term that was found (``language.norm``).
        box_px: x0, y0, x1, y1 (end exclusive).
        confidence: 0 to 1.
        mask: (y1 - y0, x1 - x0) bool inside the box; None = box only.
        attributes: words such as ``"white"``, ``"wooden"`` where the detector gives them.
    """

    category: str
    box_px: tuple[int, int, int, int]
    confidence: float
    mask: NDArray[np.bool_] | None = None
    attributes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Sighting:
    """A detection lifted to 3-D in the episode frame (``perception.lifting``).

    Args:
        category, confidence, attributes: of the detection.
        box_px: its box.
        position_m: robust centre of the seen surface (x, y, z).
        distance_m: horizontal distance from the camera to the nearest seen surface.
        bearing_rad: egocentric direction of the centre at the time of the image, left positive.
        extent_m: horizontal extent of the seen surface.
        is_passage: the depth profile shows a way through (openings only).
        pixels: number of mask pixels with depth.
        surface_m: a few horizontal points (x, y) of the seen surface, nearest of each direction; of a passage, points across
            its threshold from jamb to jamb, the first and the last being the jambs.
        relief: of stairs: (x, y, z, nx, ny, nz) spread over the seen surface, its points [m] and unit normals; a flight is told
            by how it rises.
    """

    category: str
    confidence: float
    box_px: tuple[int, int, int, int]
    position_m: tuple[float, float, float]
    distance_m: float
    bearing_rad: float
    extent_m: float
    attributes: tuple[str, ...] = ()
    is_passage: bool = False
    pixels: int = 0
    surface_m: tuple[tuple[float, float], ...] = ()
    relief: tuple[tuple[float, float, float, float, float, float], ...] = ()
