"""What the rule planner keeps between planning boundaries of one episode."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from spacevln.core import Anchor, PlannerContext, Pose, StageEnd
from spacevln.reasoning.rules.grid import FloorGrid, square_rad
from spacevln.reasoning.rules.heading import way_length_m
from spacevln.reasoning.rules.legs import Node
from spacevln.reasoning.rules.sightings import XY, Sightings
from spacevln.reasoning.rules.world import FLOOR_HEIGHT_M, Link, World, build_grid

REACHED_M = 0.7
STOREY_M = 2.8  # a usual storey, from floor to floor
RUN_PER_RISE = 1.5  # of usual stairs
BEYOND_M = 0.9  # behind the last step one is off the flight
ON_STEPS_M = 0.25  # this much over or under the floor one stands on steps
MOST_STAGES, FIRST_STAGES = 6, 2  # boundaries on the steps, and before the first of them
LEAST_GAIN_M = 0.6  # a stage that brings its target no nearer than this has failed


@dataclass(slots=True)
class Crossing:
    """A flight of stairs that is being walked.

    Args:
        far: where it is expected to end.
        began: pose before its first step.
        last: pose at the last planning boundary.
        stages: planning boundaries so far.
    """

    far: XY
    began: Pose
    last: Pose
    stages: int = 0

    def go_on(self, pose: Pose) -> bool:
        """Take in a boundary's pose; whether the flight is not yet behind one.

        What the feet have climbed tells more than what was seen: on the steps the flight leads where one has just gone.
        """
        climbed, rose = abs(pose.z_m - self.began.z_m), abs(pose.z_m - self.last.z_m)
        gone = math.hypot(pose.x_m - self.last.x_m, pose.y_m - self.last.y_m)
        self.stages += 1
        if climbed > ON_STEPS_M and rose > ON_STEPS_M / 2 and gone > ON_STEPS_M:
            rest = max(0.0, STOREY_M - climbed) * RUN_PER_RISE + BEYOND_M
            self.far = (
                pose.x_m + rest * (pose.x_m - self.last.x_m) / gone,
                pose.y_m + rest * (pose.y_m - self.last.y_m) / gone,
            )
        self.last = pose
        if climbed <= ON_STEPS_M and pose.distance_m(*self.far) < BEYOND_M:
            return False  # it was no flight, or not this way
        if climbed > STOREY_M - ON_STEPS_M:
            return rose > ON_STEPS_M
        return self.stages <= (MOST_STAGES if climbed > ON_STEPS_M else FIRST_STAGES)


@dataclass(slots=True)
class EpisodeState:
    """Grows with every planning boundary; with Hierarchical Spatial Memory off nothing is kept but the verified anchors."""

    sightings: Sightings = field(default_factory=Sightings)
    grids: dict[int, FloorGrid] = field(default_factory=dict)
    links: list[Link] = field(default_factory=list)
    visited: list[tuple[int, XY]] = field(default_factory=list)
    start: tuple[int, Pose] | None = None
    last_pose: tuple[int, Pose] | None = None
    verified: list[Anchor] = field(default_factory=list)
    target: tuple[int, XY] | None = None
    target_way_m: float = 0.0
    target_is_goal: bool = True
    failures: list[tuple[int, XY]] = field(default_factory=list)
    crossing: Crossing | None = None

    def floor_of(self, context: PlannerContext) -> int:
        """Current storey: of the memory, else from the height."""
        return context.memory.floor if context.memory is not None else round(context.pose.z_m / (2 * FLOOR_HEIGHT_M))

    def observe(self, context: PlannerContext) -> World:
        """Take in a look-around and give the picture of everything known."""
        floor = self.floor_of(context)
        pose = context.pose
        if context.memory is None:
            self.sightings, self.grids, self.visited, self.links = Sightings(), {}, [], []
            self.start = None
        if self.start is None:
            self.start = (floor, pose)
        here = (pose.x_m, pose.y_m)
        if self.last_pose is not None and self.last_pose[0] != floor:
            before = self.last_pose[1]
            yaw = math.atan2(pose.y_m - before.y_m, pose.x_m - before.x_m)
            self.links.append(Link(self.last_pose[0], (before.x_m, before.y_m), floor, here, yaw))
        self.last_pose = (floor, pose)
        self.visited.append((floor, here))
        self.sightings.add(
            (sighting for view in context.views for sighting in view.sightings), floor, here, square_rad(context.space, pose)
        )
        frontiers = context.memory.frontiers if context.memory is not None else ()
        self.grids[floor] = build_grid(context.space, self.sightings, pose, self.visited, frontiers, floor)
        return World(self.sightings, self.grids, frontiers, floor, self.links, self.visited)

    def start_node(self, world: World) -> Node:
        """Where the route begins."""
        if self.start is None:
            raise ValueError("observe() comes first")
        floor, pose = self.start
        return Node(floor, world.room_at(floor, (pose.x_m, pose.y_m), 1.0), (pose.x_m, pose.y_m), pose.yaw_rad)

    def judge_last_stage(self, context: PlannerContext, floor: int) -> bool:
        """Whether the last stage reached its target; a stage that hardly moved and did not is noted as a failure."""
        if context.feedback is None or self.target is None:
            return False
        aim_floor, aim = self.target
        near = aim_floor == floor and context.pose.distance_m(*aim) <= REACHED_M
        reached = near or (self.target_is_goal and context.feedback.end is StageEnd.ARRIVAL)
        nearer_m = self.target_way_m - way_length_m(context, aim) if aim_floor == floor else LEAST_GAIN_M
        if not reached and nearer_m < LEAST_GAIN_M:
            self.failures.append(self.target)
        return reached

    def failed(self, floor: int, xy: XY) -> int:
        """How often stages towards a place failed."""
        return sum(1 for f, aim in self.failures if f == floor and math.dist(aim, xy) < 0.8)
