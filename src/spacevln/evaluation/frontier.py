"""Frontier exploration (Yamauchi 1997) as a baseline: maps, goes to the nearest border of the unknown, and reads nothing.

An object goal ends it: a detection of the category is driven to. An instruction it cannot read; it stops after the mean length
of a route, as the blind walkers do.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from spacevln.core import (
    Action,
    Detector,
    MoveForward,
    ObjectGoalTask,
    Observation,
    Pose,
    Sighting,
    Stop,
    Task,
    TurnLeft,
    TurnRight,
)
from spacevln.language import norm
from spacevln.mapping import MetricMap
from spacevln.perception import lift

ARRIVED_M = 0.75
"""Distance to the nearest seen surface of the goal at which it stops, the arrival radius of solid landmarks."""

AT_FRONTIER_M = 0.5
AHEAD_M = 0.4
"""How far along its path it looks for the next heading."""

STALLED_M = 0.05
MAX_STALLS = 2
"""Blocked forwards after which a target is given up."""

Point = NDArray[np.float64]


class FrontierWalker:
    """Explores by the nearest frontier.

    Args:
        task: of the episode.
        detector: asked for the goal category only.
        route_m: length after which it stops where there is no goal to see.
    """

    def __init__(self, task: Task, detector: Detector, route_m: float) -> None:
        self._map = MetricMap()
        self._detector = detector
        self._terms = norm(task.goal) if isinstance(task, ObjectGoalTask) else ()
        self._route_m = route_m
        self._walked_m = 0.0
        self._turns_to_look = 12
        self._pose: Pose | None = None
        self._last: Action | None = None
        self._stalls = 0
        self._goal: Point | None = None
        self._target: Point | None = None
        self._given_up: list[Point] = []

    def next(self, observation: Observation) -> Action:
        """The next primitive, from what is seen now."""
        self._take_in(observation)
        self._last = self._choose(observation.pose)
        return self._last

    def _take_in(self, observation: Observation) -> None:
        pose = observation.pose
        sightings: tuple[Sighting, ...] = ()
        if self._terms:
            (detections,) = self._detector.detect([observation], self._terms)
            sightings = lift(observation, detections)
        self._map.integrate(observation, sightings)
        for sighting in sightings:
            surface = np.array(sighting.surface_m or [sighting.position_m[:2]])
            nearest = surface[np.argmin(np.linalg.norm(surface - pose.xy_m, axis=1))]
            if not self._is_given_up(nearest) and (self._goal is None or _far(pose, nearest) < _far(pose, self._goal)):
                self._goal = nearest
        if self._pose is not None and isinstance(self._last, MoveForward):
            moved_m = self._pose.distance_m(pose.x_m, pose.y_m)
            self._walked_m += moved_m
            self._stalls = self._stalls + 1 if moved_m < STALLED_M else 0
        self._pose = pose

    def _choose(self, pose: Pose) -> Action:
        if self._goal is not None and _far(pose, self._goal) <= ARRIVED_M:
            return Stop()
        if not self._terms and self._walked_m >= self._route_m:
            return Stop()
        if self._stalls >= MAX_STALLS:
            self._give_up()
        if self._goal is None and self._turns_to_look:
            self._turns_to_look -= 1
            return TurnLeft()
        return self._toward_goal(pose) or self._toward_frontier(pose) or Stop()

    def _toward_goal(self, pose: Pose) -> Action | None:
        if self._goal is None:
            return None
        action = self._step(pose, self._goal)
        if action is None:
            self._give_up()
        return action

    def _toward_frontier(self, pose: Pose) -> Action | None:
        """One primitive toward the nearest frontier; a look around where one was reached; None when nothing is left."""
        if self._target is not None and _far(pose, self._target) <= AT_FRONTIER_M:
            self._target, self._turns_to_look = None, 11
            return TurnLeft()
        if self._target is not None:
            action = self._step(pose, self._target)
            if action is not None:
                return action
            self._give_up()
        for frontier in self._map.frontiers(pose):
            point = np.array(frontier.position_m)
            if self._is_given_up(point) or _far(pose, point) <= AT_FRONTIER_M:
                continue
            action = self._step(pose, point)
            if action is not None:
                self._target = point
                return action
        return None

    def _step(self, pose: Pose, target: Point) -> Action | None:
        path = self._map.path(pose.xy_m, target)
        if len(path) < 2:
            return None
        ahead = next((point for point in path[1:] if _far(pose, point) >= AHEAD_M), path[-1])
        bearing_rad = pose.bearing_rad(float(ahead[0]), float(ahead[1]))
        if abs(bearing_rad) <= math.radians(15) + 1e-6:
            return MoveForward()
        return TurnLeft() if bearing_rad > 0 else TurnRight()

    def _give_up(self) -> None:
        """Leave the present target alone for good."""
        given_up = self._goal if self._goal is not None else self._target
        if given_up is not None:
            self._given_up.append(given_up)
        self._goal = self._target = None
        self._stalls = 0

    def _is_given_up(self, point: Point) -> bool:
        return any(float(np.linalg.norm(point - other)) < AT_FRONTIER_M for other in self._given_up)


def _far(pose: Pose, point: Point) -> float:
    return pose.distance_m(float(point[0]), float(point[1]))
