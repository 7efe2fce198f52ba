"""Depth as cheap sensors give it: noise that grows with distance, holes, flying pixels at edges."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from spacevln.core import Observation


def worn(observation: Observation, seed: int, *, holes: float = 0.3, blobs: int = 12, noise: float = 1.0) -> Observation:
    """The same image from a worse sensor.

    Args:
        observation: with exact depth.
        seed: of the errors.
        holes: share of pixels without depth, each by itself.
        blobs: round holes of up to a twelfth of the image's height.
        noise: times the axial noise of a structured-light camera (Nguyen et al. 2012): 1.2 mm + 1.9 mm (d - 0.4 m)^2.
    """
    rng = np.random.default_rng(seed)
    clean = observation.depth_m.astype(np.float64)
    height, width = clean.shape
    depth = clean + noise * rng.normal(size=clean.shape) * (0.0012 + 0.0019 * (clean - 0.4) ** 2)
    edges = cv2.dilate(clean, np.ones((3, 3))) - cv2.erode(clean, np.ones((3, 3))) > 0.1
    flying = edges & (rng.random(clean.shape) < 0.5)  # between what is before and what is behind
    depth[flying] = rng.uniform(cv2.erode(clean, np.ones((3, 3)))[flying], cv2.dilate(clean, np.ones((3, 3)))[flying])
    depth[rng.random(clean.shape) < holes] = 0.0
    punched = depth.astype(np.float32)
    for _ in range(blobs):
        centre = (int(rng.integers(width)), int(rng.integers(height)))
        cv2.circle(punched, centre, int(rng.integers(2, max(3, height // 12))), 0.0, -1)
    return replace(observation, depth_m=np.where(clean > 0, np.maximum(punched, 0.0), 0.0).astype(np.float32))
