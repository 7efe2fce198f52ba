"""Draws the recorded house: single-sided triangles, flat colours, z-depth, by a z-buffer."""

import math

import numpy as np


def draw(house, eye, rotation, width, height, hfov_deg):
    """Colour (H, W, 4), depth (H, W), ids (H, W) as seen from an eye; rotation is a (3, 3) matrix camera to world."""
    focal = width / 2 / math.tan(math.radians(float(hfov_deg)) / 2)
    depth, owner = np.full((height, width), np.inf), np.zeros((height, width), int)
    corners = (house["triangles"].astype(np.float64) - eye) @ rotation
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = ((normals * corners[:, 0]).sum(1) < 0) & (corners[:, :, 2].min(1) < -0.01)
    for t in np.flatnonzero(facing):
        triangle, normal = corners[t], normals[t]
        polygon = _in_front(triangle)
        if len(polygon) < 3:
            continue
        u, v = width / 2 + focal * polygon[:, 0] / -polygon[:, 2], height / 2 - focal * polygon[:, 1] / -polygon[:, 2]
        c0, c1 = max(0, math.floor(u.min())), min(width, math.ceil(u.max()) + 1)
        r0, r1 = max(0, math.floor(v.min())), min(height, math.ceil(v.max()) + 1)
        if c0 >= c1 or r0 >= r1:
            continue
        x, y = np.arange(c0, c1)[None] + 0.5, np.arange(r0, r1)[:, None] + 0.5
        inside = np.ones((r1 - r0, c1 - c0), bool)
        for k in range(len(polygon)):
            a, b = k, (k + 1) % len(polygon)
            inside &= (u[b] - u[a]) * (y - v[a]) - (v[b] - v[a]) * (x - u[a]) <= 0
        slope = normal[0] * (x - width / 2) / focal - normal[1] * (y - height / 2) / focal - normal[2]
        with np.errstate(divide="ignore", invalid="ignore"):
            z = (normal @ triangle[0]) / slope
        nearer = inside & (z > 0) & (z < depth[r0:r1, c0:c1])
        depth[r0:r1, c0:c1][nearer] = z[nearer]
        owner[r0:r1, c0:c1][nearer] = t
    empty = ~np.isfinite(depth)
    depth[empty] = 0
    rgba = np.full((height, width, 4), 255, np.uint8)
    rgba[..., :3] = house["colours"][owner]
    rgba[empty, :3] = 0
    return rgba, depth.astype(np.float32), np.where(empty, 0, house["ids"][owner]).astype(np.uint32)


def _in_front(triangle, near=0.01):
    kept = []
    for k in range(3):
        a, b = triangle[k], triangle[(k + 1) % 3]
        if a[2] <= -near:
            kept.append(a)
        if (a[2] <= -near) != (b[2] <= -near):
            kept.append(a + (b - a) * ((-near - a[2]) / (b[2] - a[2])))
    return np.array(kept)
