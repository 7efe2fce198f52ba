"""What the rule planner keeps between planning boundaries of one episode."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from spacevln.core import Anchor, Mark, PlannerContext, Pose, StageEnd
from spacevln.reasoning.rules.flights import Crossing, Flight
from spacevln.reasoning.rules.grid import FloorGrid, square_rad
from spacevln.reasoning.rules.heading import way_length_m
from spacevln.reasoning.rules.legs import Node
from spacevln.reasoning.rules.sightings import XY, Sightings, remembered
from spacevln.reasoning.rules.world import FLOOR_HEIGHT_M, Link, World, build_grid

REACHED_M = 0.7
SPENT_M = 0.4
SAME_PLACE_M = 0.8
LEAST_GAIN_M = 0.6  # a stage that brings its target no nearer than this has failed
LEVEL_M = 0.3  # of heights that are one storey's
BEFORE_M = 1.3  # from a thing's surface: who was sent no nearer did not stand before it


@dataclass(slots=True)
class EpisodeState:
    """Grows with every planning boundary; with Hierarchical Spatial Memory off nothing is kept but the verified anchors.

    ``entering`` is the flight to whose entry the last stage led. ``sought`` is the number of the thing that it headed for;
    ``vain`` counts, by thing, the stages that stood before it or came no nearer, and did not end the episode.
    """

    sightings: Sightings = field(default_factory=Sightings)
    grids: dict[int, FloorGrid] = field(default_factory=dict)
    links: list[Link] = field(default_factory=list)
    levels: dict[int, float] = field(default_factory=dict)
    visited: list[tuple[int, XY]] = field(default_factory=list)
    start: tuple[int, Pose] | None = None
    last_pose: tuple[int, Pose] | None = None
    verified: list[Anchor] = field(default_factory=list)
    target: tuple[int, XY] | None = None
    target_way_m: float = 0.0
    target_is_goal: bool = True
    failures: list[tuple[int, XY]] = field(default_factory=list)
    reached: list[tuple[int, XY]] = field(default_factory=list)
    crossing: Crossing | None = None
    entering: Flight | None = None
    sought: int | None = None
    vain: dict[int, int] = field(default_factory=dict)

    def floor_of(self, context: PlannerContext) -> int:
        """Current storey: of the memory, else from the height."""
        return context.memory.floor if context.memory is not None else round(context.pose.z_m / (2 * FLOOR_HEIGHT_M))

    def observe(self, context: PlannerContext) -> World:
        """Take in a look-around and give the picture of everything known."""
        floor = self.floor_of(context)
        pose = context.pose
        if context.memory is None:
            self.sightings, self.grids, self.visited, self.links, self.levels = Sightings(), {}, [], [], {}
            self.start = None
        if self.start is None:
            self.start = (floor, pose)
            self._recall(context)
        here = (pose.x_m, pose.y_m)
        if self.crossing is None:
            if self.last_pose is not None and self.last_pose[0] != floor:
                self.link(self.last_pose[0], self.last_pose[1], floor, pose)
            self.last_pose = (floor, pose)
            self.levels[floor] = pose.z_m
        self.visited.append((floor, here))
        if self.crossing is None:  # on the steps one sees two storeys at once
            self._take_glimpses(context, floor)
            self.sightings.add(
                (sighting for view in context.views for sighting in view.sightings), floor, here, square_rad(context.space, pose)
            )
        frontiers = context.memory.frontiers if context.memory is not None else ()
        self.grids[floor] = build_grid(context.space, self.sightings, pose, self.visited, frontiers, floor)
        return self.world(context, floor)

    def _recall(self, context: PlannerContext) -> None:
        """Take in what a loaded memory knows of earlier episodes: storeys, and the things seen there.

        Ways through are left out: a cue has no threshold. So is where one stood: a visited place counts as looked at in vain,
        which says nothing about another goal.
        """
        for item in context.memory.waypoints if context.memory is not None else ():
            if Mark.EARLIER not in item.marks:
                continue
            waypoint = item.waypoint
            stood = (waypoint.pose.x_m, waypoint.pose.y_m)
            self.levels.setdefault(waypoint.floor, waypoint.pose.z_m)
            things = [seen for cue in waypoint.cues if (seen := remembered(cue)) is not None]
            self.sightings.add(things, waypoint.floor, stood, self.sightings.square_rad)

    def _take_glimpses(self, context: PlannerContext, floor: int) -> None:
        """Take in what was seen on the way, on this storey."""
        for glimpse in context.feedback.glimpses if context.feedback is not None else ():
            pose = glimpse.pose
            if abs(pose.z_m - context.pose.z_m) < LEVEL_M:
                self.sightings.add(iter(glimpse.sightings), floor, (pose.x_m, pose.y_m), square_rad(context.space, context.pose))

    def world(self, context: PlannerContext, floor: int) -> World:
        """The picture of everything known."""
        frontiers = context.memory.frontiers if context.memory is not None else ()
        return World(self.sightings, self.grids, frontiers, floor, self.links, self.levels, self.visited)

    def follow_crossing(self, pose: Pose, floor: int) -> None:
        """Take in a boundary's pose on a flight; the crossing ends when the flight is behind one, or was none."""
        crossing = self.crossing
        if crossing is None or crossing.go_on(pose):
            return
        self.crossing = None
        if floor != crossing.floor:
            self.link(crossing.floor, crossing.began, floor, pose)
            self.last_pose, self.levels[floor] = (floor, pose), pose.z_m

    def link(self, floor: int, pose: Pose, other: int, there: Pose) -> None:
        """Note stairs that were walked."""
        yaw = math.atan2(there.y_m - pose.y_m, there.x_m - pose.x_m)
        self.links.append(Link(floor, (pose.x_m, pose.y_m), other, (there.x_m, there.y_m), yaw))

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
        if self.sought is not None and ((reached and self._before(self.sought, aim)) or nearer_m < LEAST_GAIN_M):
            self.vain[self.sought] = self.vain.get(self.sought, 0) + 1
        if reached:
            self.reached.append(self.target)
        elif nearer_m < LEAST_GAIN_M:
            self.failures.append(self.target)
        return reached

    def _before(self, number: int, xy: XY) -> bool:
        """Whether a place lies before a thing, and not on the way to it."""
        thing = next((thing for thing in self.sightings.things if thing.id == number), None)
        return thing is None or float(thing.distance_m(np.array([xy]))[0]) <= BEFORE_M

    def on_the_way_to(self, floor: int, xy: XY) -> bool:
        """Whether the last stage headed for a place and neither reached it nor failed."""
        aims = (*self.reached[-1:], *self.failures[-1:])
        return (
            self.target is not None
            and self.target not in aims
            and self.target[0] == floor
            and math.dist(self.target[1], xy) < SAME_PLACE_M
        )

    def spent(self, floor: int, xy: XY) -> int:
        """How often a place was reached: what it had to show is seen."""
        return sum(1 for f, aim in self.reached if f == floor and math.dist(aim, xy) < SPENT_M)

    def failed(self, floor: int, xy: XY) -> int:
        """How often stages towards a place failed."""
        return sum(1 for f, aim in self.failures if f == floor and math.dist(aim, xy) < SAME_PLACE_M)
