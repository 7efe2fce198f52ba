"""One stage: the inner loop of Algorithm 1, lines 8 to 15."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from spacevln.agent.acting import ask_executor
from spacevln.agent.body import Body, Phase
from spacevln.agent.look_around import Panorama
from spacevln.agent.settings import AgentSettings
from spacevln.agent.watch import Watch
from spacevln.agent.world import World
from spacevln.control import AdmissibleActionControl, StageArrival, decompose, is_stalled, turns_toward
from spacevln.core import (
    Action,
    DecisionMade,
    Event,
    ExecutedDecision,
    Executor,
    ExecutorContext,
    ExecutorReply,
    Feedback,
    Glimpse,
    Motion,
    Pose,
    Sighting,
    StageEnd,
    StageRecord,
    Stop,
    Subtask,
)
from spacevln.mapping import Incline

LEAST_RISE_M = 0.3  # to a place on a flight of stairs; less is the floor before it


class Stage:
    """Carries out one subtask.

    Args:
        subtask: validated sigma_k, not complete.
        body, world, executor: what acts, what knows, what decides.
        settings: components and thresholds.
        emit, clock: where events go, and seconds.
        watch: for what to look about.
    """

    def __init__(
        self,
        subtask: Subtask,
        body: Body,
        world: World,
        executor: Executor,
        settings: AgentSettings,
        emit: Callable[[Event], None],
        clock: Callable[[], float],
        watch: Watch,
    ) -> None:
        self._subtask, self._body, self._world, self._executor = subtask, body, world, executor
        self._settings, self._emit, self._clock = settings, emit, clock
        self._control = AdmissibleActionControl(body.spec, settings.control)
        self._record = StageRecord(start=body.pose)
        self._incline = _incline(subtask, body.pose)
        self._terms = world.begin_stage(subtask, body.pose)
        floor, region = world.locate(body.pose)
        self._arrival = StageArrival(subtask, floor, region, settings.control)
        self._seen: tuple[Sighting, ...] = ()  # of the stage's landmark in the current image
        self._watch, self._glimpses = watch, list[Glimpse]()
        self._told = 0  # of the glimpses, to the executor

    def run(self, panorama: Panorama) -> Feedback:
        """Rotate to the chosen direction, then decide and act until the stage ends.

        Args:
            panorama: the look-around from which delta_k was chosen. What it shows of ell_k is known from the start: what lies
                on the floor leaves the image before one is there.
        """
        for view in panorama.views:
            self._world.update_landmarks(view.sightings, self._body.pose)
        self._align(panorama.heading_rad(self._subtask.direction))
        self._arrival.depart(self._world.pool())
        end = self._budget_end()
        while end is None:  # repeat ... until: an arrival is judged after an action, so that no stage stands still
            end = self._decide_and_act() or (StageEnd.ARRIVAL if self._arrived() else self._budget_end())
        # F_k = Phi(sigma_k, tau_k, B^(k))
        return Feedback(self._subtask, self._record, self._world.pool(), end, tuple(self._glimpses))

    def _align(self, heading_rad: float) -> None:
        self._note(self._world.perceive([self._body.view], self._terms)[0])
        for turn in turns_toward(heading_rad, self._body.spec):
            if not self._body.budget.can_move:
                return
            self._note(self._body.step(turn, Phase.ALIGN, self._terms)[1])

    def _note(self, sightings: tuple[Sighting, ...]) -> None:
        """Update_landmark (line 11) by what the current image shows; a glimpse of it is kept for the planner."""
        self._seen = sightings
        self._world.update_landmarks(sightings, self._body.pose)
        if self._watch.terms:
            (glimpsed,) = self._world.perceive([self._body.view], self._watch.terms)
            self._glimpses.append(Glimpse(self._body.pose, glimpsed))

    def _budget_end(self) -> StageEnd | None:
        """Whether the episode's or the stage's budget is spent."""
        if not self._body.budget.can_move:
            return StageEnd.EPISODE_END
        if len(self._record.decisions) >= self._settings.control.stage_decisions:
            return StageEnd.STAGE_BUDGET
        return None

    def _arrived(self) -> bool:
        """Automatic arrival needs stage verification and the landmark memory (DESIGN 6)."""
        components = self._settings.components
        if not (components.stagewise and components.landmark_memory):
            return False
        pose = self._body.pose
        return self._arrival.reached(pose, *self._world.locate(pose), self._world.pool()) is not None

    def _decide_and_act(self) -> StageEnd | None:
        """One pass of lines 10 to 13; the reason when it ends the stage."""
        context = self._context()
        if context.admissible.blocked:
            return StageEnd.BLOCKED
        begin = self._clock()
        reply = ask_executor(self._executor, context, self._body.stage, self._settings.control, self._emit)
        if reply is None:
            return StageEnd.BLOCKED
        self._emit(
            DecisionMade(
                stage=self._body.stage,
                decision=len(self._record.decisions) + 1,
                action=reply.action,
                purpose=reply.purpose,
                thought=reply.thought,
                obstacles=context.obstacles,
                pool=context.pool,
                admissible=context.admissible,
                seconds=self._clock() - begin,
                sightings=context.sightings,
            )
        )
        if isinstance(reply.action, Stop):
            return StageEnd.ARRIVAL if self._arrived() else StageEnd.STOP
        decision = self._carry_out(reply)
        self._control.observe(decision)
        self._record = replace(self._record, decisions=(*self._record.decisions, decision))  # tau_k
        return None

    def _context(self) -> ExecutorContext:
        """I^E_t = (I_t, Omega_t, Lambda_t, sigma_k)."""
        observation = self._body.view
        obstacles = self._world.obstacles(observation, self._incline)
        return ExecutorContext(
            observation=observation,
            obstacles=obstacles,
            pool=self._world.pool(),
            subtask=self._subtask,
            progress=self._record,
            admissible=self._control.admissible(obstacles),
            space=self._world.space,
            decisions_left=self._settings.control.stage_decisions - len(self._record.decisions),
            sightings=self._seen,
            goal=self._watch.goal,
            glimpsed=self._newly_glimpsed(),
        )

    def _newly_glimpsed(self) -> tuple[Sighting, ...]:
        """Since the last decision."""
        new, self._told = self._glimpses[self._told :], len(self._glimpses)
        return tuple(sighting for glimpse in new for sighting in glimpse.sightings)

    def _carry_out(self, reply: ExecutorReply) -> ExecutedDecision:
        """Primitive by primitive; arrival, stall and the end of the budget interrupt it."""
        primitives = decompose(reply.action, self._body.spec)
        moved_m = turned_rad = 0.0
        taken, stalled = 0, False
        for primitive in primitives:
            if stalled or not self._body.budget.can_move or (taken and self._arrived()):
                break
            motion = self._primitive(primitive)
            taken += 1
            moved_m += motion.moved_m
            turned_rad += motion.turned_rad
            stalled = is_stalled(primitive, motion, self._settings.control.stall_m)
        return ExecutedDecision(reply.action, reply.purpose, moved_m, turned_rad, taken, stalled, taken < len(primitives))

    def _primitive(self, primitive: Action) -> Motion:
        motion, sightings = self._body.step(primitive, Phase.EXECUTE, self._terms)
        self._note(sightings)
        return motion


def _incline(subtask: Subtask, pose: Pose) -> Incline | None:
    """The way up or down, of a stage that takes a flight of stairs to a known place; a landmark's height is no storey's."""
    target = subtask.target_m
    if target is None or subtask.landmark or abs(target[2] - pose.z_m) <= LEAST_RISE_M:
        return None
    return Incline((pose.x_m, pose.y_m, pose.z_m), target)
