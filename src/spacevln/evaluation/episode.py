"""One episode of any benchmark: what the agent is told, and, kept apart from it, the truth that judges it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from spacevln.core import Action, EpisodeSpec, InstructionTask, ObjectGoalTask, Pose
from spacevln.evaluation.truth import Annotations

Points = NDArray[np.float64]


class GroundTruth(Protocol):
    """What only evaluation knows. Positions are (N, 3) arrays in the scene frame [m]."""

    @property
    def goals(self) -> Points:
        """Goal positions (G, 3), for pictures."""

    @property
    def radius_m(self) -> float:
        """Success radius in terms of :meth:`distances_m`: 3 m for routes, 0 where targets are themselves places of success."""

    @property
    def shortest_path(self) -> Points:
        """The shortest way from the start to the nearest goal (M, 3)."""

    @property
    def reference_path(self) -> Points | None:
        """The dense reference of nDTW (R, 3); None for object goals, which have no reference."""

    def distances_m(self, positions: Points) -> NDArray[np.float64]:
        """Geodesic distance of each position to the nearest target, shape (N,); inf when there is no way."""

    def reached(self, position: Points) -> bool:
        """Whether STOP at this position (3,) is a success."""

    def viewpoint_m(self, position: Points) -> float | None:
        """Geodesic distance from a position (3,) to the nearest view point of a goal object (OVON's measure); None for routes."""

    def follow(self, pose: Pose) -> Action:
        """The primitive of a shortest-path follower at a pose in the scene frame; STOP at the goal."""


@dataclass(frozen=True, slots=True)
class Episode:
    """An episode of a suite.

    Args:
        spec: all that the environment and the agent get.
        truth: all that they do not; None for a free instruction or goal, and until a simulator has measured ``annotations``.
        tags: difficulty tags, e.g. ``{"floors": 2, "anchors": 4}``.
        annotations: what a dataset's file says of the truth; None for episodes that the program makes.
    """

    spec: EpisodeSpec
    truth: GroundTruth | None = None
    tags: Mapping[str, str | float | int | bool] = field(default_factory=dict)
    annotations: Annotations | None = None

    @property
    def episode_id(self) -> str:
        """Unique within the suite."""
        return self.spec.episode_id

    @property
    def scene(self) -> str:
        """Name of the building."""
        return self.spec.scene

    @property
    def start(self) -> Pose:
        """Start pose, scene frame."""
        return self.spec.start

    @property
    def instruction(self) -> str | None:
        """The route instruction, if that is the task."""
        return self.spec.task.instruction if isinstance(self.spec.task, InstructionTask) else None

    @property
    def goal(self) -> str | None:
        """The goal category, if that is the task."""
        return self.spec.task.goal if isinstance(self.spec.task, ObjectGoalTask) else None
