"""The embedded simulator moves and measures as the real Habitat-Sim did, in the recorded house."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from bridge_world import RECORDS
from golden_house import golden_house

from spacevln.core import Pose
from spacevln.core.geometry import Float
from spacevln.environments.bridge.frame import pose_from_habitat
from spacevln.environments.houses.ground.walkable import Walkable
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.environments.houses.walking.motion import Body

FORWARD = 1
STEP_M = 0.25
RADII_M = {"r010": 0.1, "r018_fine": 0.2}
"""Of the body as Recast grows it: whole cells of 5 cm."""


@pytest.fixture(scope="module")
def ground() -> Walkable:
    return Walkable(golden_house())


def steps(mesh: str) -> Iterator[tuple[Pose, Pose, bool]]:
    """Recorded forward steps with sliding: from, to, collided; ours are on the floor, theirs a cell above it."""
    for trace in RECORDS["traces"]["034"].values():
        if trace["sliding"] and trace["navmesh"] == mesh:
            for before, after in zip(trace["steps"], trace["steps"][1:], strict=False):
                if after[0] == FORWARD:
                    yield _floor(before[1], before[2]), _floor(after[1], after[2]), bool(after[4])


def _ahead(pose: Pose) -> Float:
    return pose.position_m + STEP_M * np.array([np.cos(pose.yaw_rad), np.sin(pose.yaw_rad), 0.0])


def _floor(position: list[float], rotation: tuple[float, float, float, float]) -> Pose:
    pose = pose_from_habitat(position, rotation)
    return Pose(pose.x_m, pose.y_m, 0.0, pose.yaw_rad)


def test_single_steps_agree_with_the_records(ground: Walkable) -> None:
    free, off, agreed = [], [], []
    for mesh, radius_m in RADII_M.items():
        body = Body(ground, radius_m=radius_m, sliding=True)
        for before, after, collided in steps(mesh):
            pose, motion = body.forward(before, STEP_M)
            error = float(np.linalg.norm(pose.position_m - after.position_m))
            off.append(error)
            agreed.append(motion.collided == collided)
            if not motion.collided and np.linalg.norm(_ahead(before) - after.position_m) < 1e-4:
                free.append(error)
    assert len(off) > 600
    assert 300 < len(free) < len(off) - 60
    assert max(free) < 1e-3
    assert np.mean(agreed) >= 0.95
    assert np.percentile(off, 95) <= 0.07


def test_path_queries_agree_with_the_records(ground: Walkable) -> None:
    compared = 0
    for mesh, radius_m in RADII_M.items():
        geodesics = Geodesics(ground, radius_m)
        for query in RECORDS["queries"]["034"][mesh]["paths"]:
            start, end = (_floor(query[name], (0.0, 0.0, 0.0, 1.0)) for name in ("start", "end"))
            if not query["found"] or min(ground.clearance_m(p.x_m, p.y_m, 0.0) for p in (start, end)) < radius_m:
                continue  # off the mesh: how far the ends are moved is the mesh's own matter
            flat = np.array(query["points"])[:, [0, 2]]  # ends over the floor keep their height there
            wanted = np.linalg.norm(np.diff(flat, axis=0), axis=1).sum()
            assert geodesics.distance_m(start.position_m, end.position_m) == pytest.approx(wanted, rel=0.03)
            compared += 1
    assert compared > 30
