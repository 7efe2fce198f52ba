"""Labelled images made by hand: a far wall, boxes of pixels in front of it."""

from __future__ import annotations

import numpy as np

from spacevln.core import Camera, InstanceLabel, Labels, Observation, Pose

CAMERA = Camera(160, 120, 79.0, 0.88)

Patch = tuple[int, int, int, int, float]  # x0, y0, x1, y1, depth


def observe(
    patches: dict[int, tuple[str, tuple[str, ...], Patch]], pose: Pose | None = None, wall_m: float = 4.5, camera: Camera = CAMERA
) -> Observation:
    """Instance id -> category, attributes and pixels; later ones lie in front."""
    size = (camera.height_px, camera.width_px)
    depth, ids = np.full(size, wall_m, np.float32), np.zeros(size, np.int32)
    for instance, (_, _, (x0, y0, x1, y1, metres)) in patches.items():
        depth[y0:y1, x0:x1] = metres
        ids[y0:y1, x0:x1] = instance
    labels = Labels(ids, {k: InstanceLabel(category, attributes) for k, (category, attributes, _) in patches.items()})
    rgb = np.zeros((*size, 3), np.uint8)
    return Observation(rgb, depth, pose or Pose(0.0, 0.0), camera, labels=labels)
