"""What an agent is asked to do, and what an environment resets to. Never goals or reference paths: those are evaluation's."""

from __future__ import annotations

from dataclasses import dataclass

from spacevln.core.geometry import Pose


@dataclass(frozen=True, slots=True)
class InstructionTask:
    """Follow a route instruction (VLN)."""

    instruction: str


@dataclass(frozen=True, slots=True)
class ObjectGoalTask:
    """Find an instance of an object category (Object-Goal Navigation)."""

    goal: str


Task = InstructionTask | ObjectGoalTask


@dataclass(frozen=True, slots=True)
class EpisodeSpec:
    """What an environment needs to start an episode.

    Args:
        episode_id: unique within its suite.
        scene: name of the building, e.g. ``"house-000017"``.
        start: pose in the *scene* frame. The agent's own poses are in the *episode* frame: x forward, y left, z up from here.
        task: what to do.
    """

    episode_id: str
    scene: str
    start: Pose
    task: Task
