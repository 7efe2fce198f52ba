"""The rule-based planner: pi_P without a model (DESIGN 5.4).

It reads what a model would read: the look-around's lifted detections, memory's frontiers, floors and chain, feedback, the metric
map. The instruction becomes clauses and a space-landmark anchor chain; trails through the perceived world are scored against
the clauses (:mod:`.search`), and the best hypothesis gives the next verifiable stage. Object goals are searched
(:mod:`.object_goal`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from spacevln.core import (
    Anchor,
    InstructionTask,
    ObjectGoalTask,
    PlannerContext,
    PlannerReply,
    PlannerThought,
    SpaceKind,
    Subtask,
    Task,
    Verdict,
    View,
)
from spacevln.language import Clause, cue_kind, known_categories, norm, region_kind
from spacevln.reasoning.rules.alignment import worth
from spacevln.reasoning.rules.flights import STAIRS_ENTRY, STAIRS_SIGHT, Crossing, Flight
from spacevln.reasoning.rules.heading import bearing_of_way, choose_view, reachable_goal, way_length_m
from spacevln.reasoning.rules.instances import at_goal
from spacevln.reasoning.rules.object_goal import find_object
from spacevln.reasoning.rules.route import anchor_of, final_anchor, planned_anchors, route_clauses, with_implied_climb
from spacevln.reasoning.rules.search import LAST_STEPS, Hypothesis, Search
from spacevln.reasoning.rules.sightings import XY
from spacevln.reasoning.rules.state import EpisodeState
from spacevln.reasoning.rules.thought import describe_here, observation_text, progress_text
from spacevln.reasoning.rules.world import World

ARRIVED_M = 0.8
WALK_COST_PER_M = 0.02
FAILURE_COST = 0.8
OTHER_FLOOR_M = 6.0
LEAST_AGREEMENT = 0.3  # of the clauses' weights, that a stop place must have while steps are left to look on
SAME_ENTRY_M = 1.0
OPEN_M = 4.0  # more open than this is as good
BEEN_M, BEEN_COST_M = 0.7, 1.5  # where one has been there is less to find


@dataclass(frozen=True, slots=True)
class Goal:
    """What a boundary decided: where to walk and what that means.

    Args:
        xy, floor: place.
        anchor: the stage's target anchor.
        rest: anchors planned after it, the final one last; empty when ``anchor`` is the final one.
        final: the goal itself.
        reason: in words.
        fallbacks: substitutes taken.
        flight_to_m: the far end (x, y, z) of the flight of stairs on which the way leads; None elsewhere.
    """

    xy: XY
    floor: int
    anchor: Anchor
    rest: tuple[Anchor, ...]
    final: bool
    reason: str
    fallbacks: tuple[str, ...] = ()
    flight_to_m: tuple[float, float, float] | None = None


class RulePlanner:
    """Implements :class:`spacevln.core.Planner`. Deterministic: the same contexts give the same replies."""

    def __init__(self) -> None:
        self._state = EpisodeState()
        self._clauses: tuple[Clause, ...] | None = None

    def reset(self) -> None:
        """Forget the episode."""
        self._state = EpisodeState()
        self._clauses = None

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        """The whole known vocabulary, a stated deviation: rules see nothing but detections."""
        goal = norm(task.goal)[:1] if isinstance(task, ObjectGoalTask) else ()
        return tuple(dict.fromkeys((*goal, *known_categories())))

    def plan(self, context: PlannerContext) -> PlannerReply:
        """The next subtask.

        Raises:
            ModelError: the task names nothing that the rules understand.
        """
        if isinstance(context.task, InstructionTask) and self._clauses is None:
            self._clauses = route_clauses(context.task.instruction)
        state = self._state
        if context.rejections:
            world = state.world(context, state.floor_of(context))
            reached = False
        else:
            state.follow_crossing(context.pose, state.floor_of(context))
            reached = state.judge_last_stage(context, state.floor_of(context))
            world = state.observe(context)
        here = describe_here(context, world)
        if not state.verified:
            state.verified.append(here)
        elif (
            reached
            and context.last_subtask is not None
            and context.last_subtask.next_anchor is not None
            and not context.rejections
        ):
            state.verified.append(context.last_subtask.next_anchor)
        goal = self._crossing(context) or self._enter(context, reached)
        if goal is None:
            match context.task:
                case InstructionTask():
                    goal = self._route_goal(context, world)
                case ObjectGoalTask(goal=name):
                    goal = self._object_goal(context, world, name)
            goal = self._onto_stairs(context, world, goal)
        return self._reply(context, world, here, goal, reached)

    def _crossing(self, context: PlannerContext) -> Goal | None:
        """On a flight, the goal is its far end, until one stands there."""
        crossing = self._state.crossing
        if crossing is None:
            return None
        return self._along(crossing, self._state.floor_of(context), (self._final(context),), "the flight goes on")

    @staticmethod
    def _along(crossing: Crossing, floor: int, rest: tuple[Anchor, ...], reason: str) -> Goal:
        return Goal(crossing.far, floor, crossing.anchor, rest, False, reason, flight_to_m=crossing.target_m)

    def _enter(self, context: PlannerContext, reached: bool) -> Goal | None:
        """At the entry that a stage was for one steps onto the flight; from so near its steps are out of the image."""
        state, flight = self._state, self._state.entering
        if not context.rejections:
            state.entering = None
        if flight is None or not reached or context.rejections or not flight.is_before((context.pose.x_m, context.pose.y_m)):
            return None
        return self._cross(context, flight, (self._final(context),), f"the stairs lead {flight.leads}")

    def _cross(self, context: PlannerContext, flight: Flight, rest: tuple[Anchor, ...], reason: str) -> Goal:
        floor = self._state.floor_of(context)
        self._state.crossing = Crossing(flight.far, flight.leads, floor, context.pose, context.pose)
        return self._along(self._state.crossing, floor, rest, reason)

    def _onto_stairs(self, context: PlannerContext, world: World, goal: Goal) -> Goal:
        """Stairs are first approached at their open end and then walked to the other one."""
        if goal.anchor.space_kind is not SpaceKind.FLOOR_TRANSITION:
            return goal
        near = [flight for flight in world.flights_on(world.floor) if math.dist(flight.entry, goal.xy) < SAME_ENTRY_M]
        if not near:
            return replace(goal, anchor=STAIRS_SIGHT)
        flight = min(near, key=lambda flight: math.dist(flight.entry, goal.xy))
        if flight.is_before((context.pose.x_m, context.pose.y_m)):
            return self._cross(context, flight, goal.rest, goal.reason)
        self._state.entering = flight
        return replace(goal, xy=flight.entry, anchor=STAIRS_ENTRY)

    def _final(self, context: PlannerContext) -> Anchor:
        match context.task:
            case InstructionTask():
                return final_anchor(self._clauses or ())
            case ObjectGoalTask(goal=name):
                return Anchor("", SpaceKind.UNKNOWN, name, cue_kind(name))

    def _route_goal(self, context: PlannerContext, world: World) -> Goal:
        clauses = with_implied_climb(self._clauses or (), world.leads_from(self._state.start[0] if self._state.start else 0))
        search = Search(world, clauses, context.steps_left)
        hypotheses = search.run(self._state.start_node(world))
        least = LEAST_AGREEMENT * sum(map(worth, clauses))
        if context.steps_left >= LAST_STEPS:
            hypotheses = [h for h in hypotheses if h.value >= least or not h.complete]
        if not hypotheses:
            return self._explore(context, world, clauses)
        distinct: dict[tuple[object, ...], Hypothesis] = {}
        for hypothesis in hypotheses:  # best first: the best trail to each goal stands for it
            distinct.setdefault(
                (hypothesis.floor, round(hypothesis.goal[0], 1), round(hypothesis.goal[1], 1), hypothesis.complete), hypothesis
            )
        best = max(list(distinct.values())[:12], key=lambda h: (self._worth(context, h), -h.value))
        return self._goal_of(best, clauses, world)

    def _explore(self, context: PlannerContext, world: World, clauses: tuple[Clause, ...]) -> Goal:
        """No trail fits what is known: the most promising unseen place."""
        final = final_anchor(clauses)
        found = find_object(context, world, "", self._state)
        if found is None:
            return self._lost(context, world, final)
        anchor = Anchor(found.space, region_kind(found.space) if not found.stairs else SpaceKind.FLOOR_TRANSITION)
        return Goal(found.xy, found.floor, anchor, (final,), False, found.reason, ("explore",))

    def _worth(self, context: PlannerContext, hypothesis: Hypothesis) -> float:
        here = hypothesis.floor == self._state.floor_of(context)
        way = way_length_m(context, hypothesis.goal) if here else OTHER_FLOOR_M
        vain = self._state.failed(hypothesis.floor, hypothesis.goal)
        if not hypothesis.complete and hypothesis.kind != "stairs":
            vain += self._state.spent(hypothesis.floor, hypothesis.goal)
        return hypothesis.value - WALK_COST_PER_M * way - FAILURE_COST * vain

    def _goal_of(self, best: Hypothesis, clauses: tuple[Clause, ...], world: World) -> Goal:
        final = final_anchor(clauses)
        if best.complete and best.thing is None and final.cue:
            region = world.region(best.floor, best.trail.node.room)
            final = Anchor(region or "end of the route", region_kind(region) if region else SpaceKind.UNKNOWN)
        score = f"agreement {best.value:.2f}"
        if best.complete:
            return Goal(best.goal, best.floor, final, (), True, f"the stop place is seen ({score})")
        planned = planned_anchors(clauses, best.followed)
        rest = planned if planned and planned[-1] == final else (*planned, final)
        done = next((anchor for clause in reversed(clauses[: best.followed]) if (anchor := anchor_of(clause)) is not None), None)
        match best.kind:
            case "portal":
                portal = best.trail.legs[-1].portal
                name = portal.category if portal is not None else "doorway"
                anchor = (
                    done if done is not None and done.space and not done.cue else Anchor(f"{name} beyond", SpaceKind.CONNECTOR)
                )
                reason = f"the {name} leads on ({score})"
            case "stairs":
                anchor = Anchor("stairs", SpaceKind.FLOOR_TRANSITION)
                reason = f"the stairs lead to another floor ({score})"
            case _:
                anchor = Anchor("edge of the known floor", SpaceKind.CONNECTOR)
                reason = f"this part is not seen yet ({score})"
        if rest and str(rest[0]) == str(anchor) and len(rest) > 1:
            rest = rest[1:]
        return Goal(best.goal, best.floor, anchor, rest, False, reason)

    def _object_goal(self, context: PlannerContext, world: World, name: str) -> Goal:
        final = Anchor("", SpaceKind.UNKNOWN, name, cue_kind(name))
        found = find_object(context, world, name, self._state)
        self._state.sought = None if found is None else found.thing
        if found is None:
            return self._lost(context, world, final)
        if found.seen:
            return Goal(found.xy, found.floor, final, (), True, found.reason)
        anchor = Anchor(found.space, region_kind(found.space) if not found.stairs else SpaceKind.FLOOR_TRANSITION)
        return Goal(found.xy, found.floor, anchor, (final,), False, found.reason)

    def _lost(self, context: PlannerContext, world: World, final: Anchor) -> Goal:
        """Nothing fits: the most open direction, but not where one has been."""

        def ahead(view: View) -> XY:
            reach = min(2.0, max(0.3, view.obstacle_m - 0.3))
            yaw = context.pose.yaw_rad + view.heading_rad
            return context.pose.x_m + reach * math.cos(yaw), context.pose.y_m + reach * math.sin(yaw)

        def promise(view: View) -> float:
            been = sum(1 for floor, xy in world.visited if floor == world.floor and math.dist(xy, ahead(view)) < BEEN_M)
            return round(min(view.obstacle_m, OPEN_M) - BEEN_COST_M * been, 2)

        xy = ahead(max(context.views, key=lambda view: (promise(view), view.label)))
        anchor = Anchor("open direction", SpaceKind.CONNECTOR)
        return Goal(xy, world.floor, anchor, (final,), False, "no hypothesis fits what is known", ("most_open_direction",))

    def _reply(self, context: PlannerContext, world: World, here: Anchor, goal: Goal, reached: bool) -> PlannerReply:
        state = self._state
        verified = tuple(state.verified)
        complete = (
            goal.final
            and goal.floor == world.floor
            and context.stage > 0
            and not context.rejections
            and self._at(context, world, goal, reached)
        )
        if complete:
            if verified[-1] != goal.anchor or len(verified) < 2:
                verified = (*verified, goal.anchor)
            chain, index, following = verified, len(verified) - 1, None
        else:
            following = goal.anchor
            chain, index = (*verified, goal.anchor, *goal.rest), len(verified) - 1
        target, known = (goal.xy, True) if goal.flight_to_m else reachable_goal(context, world.grids[world.floor], goal.xy)
        fallbacks = goal.fallbacks if known else (*goal.fallbacks, "loose_way")
        straight = context.pose.bearing_rad(*target)
        bearing = straight if goal.flight_to_m else bearing_of_way(context, target)
        view = choose_view(context, bearing)
        state.target = (goal.floor, goal.xy)
        state.target_is_goal = math.dist(target, goal.xy) < ARRIVED_M
        state.target_way_m = way_length_m(context, goal.xy)
        landmark = "" if following is None else following.cue
        subtask = Subtask(
            chain=chain,
            current_index=index,
            current_anchor=goal.anchor if complete and goal.anchor.space_kind is SpaceKind.CONNECTOR else here,
            next_anchor=following,
            direction=view.label,
            instruction="" if following is None else f"Go {view.label} to the {following}; {goal.reason}.",
            landmark=landmark,
            complete=complete,
            verdict=self._verdict(context, reached),
            target_m=None if following is None else goal.flight_to_m or (target[0], target[1], context.pose.z_m),
        )
        thought = PlannerThought(
            observation=observation_text(context),
            memory=f"{len(state.visited)} places visited, {len(world.sightings.portals)} ways and {len(world.sightings.things)} "
            f"things known; here: {here}.",
            progress=progress_text(chain, index, reached),
            decision=f"{goal.reason[:1].upper()}{goal.reason[1:]}, {way_length_m(context, goal.xy):.1f} m from here.",
            plan="The goal is reached: stop."
            if complete
            else f"{view.label}: {following}" + (f", then {', '.join(map(str, goal.rest))}." if goal.rest else "."),
        )
        return PlannerReply(subtask, thought, fallbacks)

    def _at(self, context: PlannerContext, world: World, goal: Goal, reached: bool) -> bool:
        if isinstance(context.task, ObjectGoalTask):
            return at_goal(context, world, context.task.goal)
        headed = context.last_subtask is not None and context.last_subtask.targets_final_anchor
        near = context.pose.distance_m(*goal.xy) <= ARRIVED_M
        if goal.anchor.cue:
            return headed and (near or (reached and context.pose.distance_m(*goal.xy) <= 2 * ARRIVED_M))
        return near and (headed or context.stage > 0)

    @staticmethod
    def _verdict(context: PlannerContext, reached: bool) -> Verdict:
        if context.last_subtask is None:
            return Verdict.FIRST
        return Verdict.COMPLETED if reached else Verdict.CONTINUE
