"""The truth of a dataset's episodes: what its file says, and what a simulator makes of that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Action, Pose
from spacevln.evaluation import metrics

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Annotations:
    """Truth as a dataset file holds it, scene frame, metres. Distances need a simulator: :class:`MeasuredTruth`.

    Args:
        targets: (G, 3) points of which the nearest counts: goal positions, or the view points of every goal object.
        radius_m: STOP succeeds strictly below this geodesic distance to the nearest target.
        nodes: (N, 3) sparse reference path; None where the dataset has none.
        reference_path: (R, 3) dense reference of nDTW (VLN-CE's ``_gt`` locations); None where it is missing.
        geodesic_m: the file's own start-to-goal distance, for statistics; SPL uses the simulator's.
        objects: (O, 3) centres of the goal objects; None for instructions.
    """

    targets: Points
    radius_m: float
    nodes: Points | None = None
    reference_path: Points | None = None
    geodesic_m: float | None = None
    objects: Points | None = None


class Geodesics(Protocol):
    """What a simulator knows about ways in one scene; points in the scene frame."""

    def distances_m(self, positions: Points, targets: Points) -> NDArray[np.float64]:
        """Geodesic distance of each position (N, 3) to its nearest target (G, 3); inf when there is no way."""

    def path(self, start: Points, targets: Points) -> Points:
        """Corner points (M, 3) of the shortest way from a point (3,) to its nearest target; (1, 3) when there is none."""

    def follow(self, pose: Pose, targets: Points) -> Action:
        """The primitive of a shortest-path follower; STOP at the target."""


class MeasuredTruth:
    """A ground truth from a file's annotations and a simulator's geodesics (a :class:`~.episode.GroundTruth`)."""

    def __init__(self, annotations: Annotations, geodesics: Geodesics, start: Pose) -> None:
        self._annotations = annotations
        self._geodesics = geodesics
        self.goals: Points = annotations.targets if annotations.objects is None else annotations.objects
        self.shortest_path: Points = geodesics.path(start.position_m, annotations.targets)
        self.reference_path: Points | None = annotations.reference_path
        self.radius_m = annotations.radius_m

    def distances_m(self, positions: Points) -> NDArray[np.float64]:
        """Geodesic distances to the nearest target."""
        return self._geodesics.distances_m(positions, self._annotations.targets)

    def reached(self, position: Points) -> bool:
        """Whether STOP here is a success."""
        return metrics.success(True, float(self.distances_m(position[None])[0]), self._annotations.radius_m)

    def viewpoint_m(self, position: Points) -> float | None:
        """Distance to the nearest view point; None for instructions."""
        return None if self._annotations.objects is None else float(self.distances_m(position[None])[0])

    def follow(self, pose: Pose) -> Action:
        """The shortest-path follower's primitive."""
        return self._geodesics.follow(pose, self._annotations.targets)

    def towards(self, pose: Pose, place: Points) -> Action:
        """The follower's primitive on the way to any place (3,); STOP there, or where nothing leads nearer."""
        return self._geodesics.follow(pose, place[None])


@runtime_checkable
class Surveyed(Protocol):
    """An environment whose simulator measures ways in its scenes."""

    def geodesics(self, scene: str) -> Geodesics:
        """Of a scene."""
