"""The stage loop: the paper's Algorithm 1. Numbers in comments are that algorithm's lines."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

from spacevln.agent.body import Body
from spacevln.agent.conclusion import Ending, EpisodeResult, conclude
from spacevln.agent.finish import FinishJudge
from spacevln.agent.look_around import look_around
from spacevln.agent.planning import ask_planner
from spacevln.agent.settings import AgentSettings
from spacevln.agent.stage import Stage
from spacevln.agent.watch import Watch
from spacevln.agent.world import World
from spacevln.control import StepBudget, default_step_limit
from spacevln.core import (
    EnvironmentFailure,
    EpisodeSpec,
    EpisodeStatus,
    ModelError,
    ObjectGoalTask,
    SafetyStop,
    SpendingLimit,
    StopReason,
    Task,
)
from spacevln.core.contexts import PlannerContext
from spacevln.core.events import Event, LookedAround, StageEnded, WaypointAdded
from spacevln.core.interfaces import Detector, Environment, EventSink, Executor, Planner
from spacevln.core.stages import Subtask
from spacevln.memory import BuildingMemory


class NavigationAgent:
    """Drives an environment through one episode at a time.

    Args:
        environment, detector, planner, executor: the parts, by their protocols.
        settings: components, thresholds, step limit.
        sinks: listeners; every event goes to each of them in order.
        clock: seconds, for the durations in events.
    """

    def __init__(
        self,
        environment: Environment,
        detector: Detector,
        planner: Planner,
        executor: Executor,
        settings: AgentSettings | None = None,
        sinks: Sequence[EventSink] = (),
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self._environment, self._detector = environment, detector
        self._planner, self._executor = planner, executor
        self._settings = settings or AgentSettings()
        self._sinks, self._clock = tuple(sinks), clock

    def run(self, episode: EpisodeSpec, known: BuildingMemory | None = None) -> EpisodeResult:
        """Navigate one episode; it ends with exactly one typed status.

        Args:
            episode: what to do, and where.
            known: memory of earlier episodes in this building, in whose frame the environment gives its poses; it grows.

        Raises:
            UsageError: the environment does not know the scene.
        """
        begin, subtasks = self._clock(), list[Subtask]()
        settings, spec = self._settings, self._environment.spec
        world = World(self._detector, settings.components, known, spec.body_radius_m, settings.arrival_sightings)  # 1: M_0
        budget = StepBudget(self._settings.step_limit or default_step_limit(episode.task))
        body = Body(self._environment, world, budget, self._emit)
        try:
            try:
                body.reset(episode)
                ending = self._navigate(episode.task, body, world, subtasks)
            except ModelError as error:  # the paper's controlled state: stop, and say why
                ending = Ending(EpisodeStatus.MODEL_FAILURE, StopReason.MODEL, str(error))
            except SpendingLimit as limit:  # the run's end, not the agent's: no attempt at the episode, but the body stops
                ending = Ending(EpisodeStatus.INTERRUPTED, StopReason.SPENDING, str(limit))
            body.stop()
        except EnvironmentFailure as error:
            ending = Ending(EpisodeStatus.ENVIRONMENT_FAILURE, StopReason.ENVIRONMENT, str(error))
        except SafetyStop as error:
            ending = Ending(EpisodeStatus.SAFETY, StopReason.SAFETY, str(error))
        except KeyboardInterrupt:
            ending = Ending(EpisodeStatus.INTERRUPTED, StopReason.INTERRUPT, "interrupted by the operator")
        return conclude(ending, body, world, tuple(subtasks), self._clock() - begin, self._emit)

    def _navigate(self, task: Task, body: Body, world: World, subtasks: list[Subtask]) -> Ending:
        """The while loop; ``subtasks`` takes the stage sequence {sigma_k}."""
        settings, judge = self._settings, FinishJudge(world, self._settings)
        self._planner.reset()
        self._executor.reset()
        watch, feedback = self._watch(task), None  # 1: F_{-1}
        while body.budget.affords(len(turns := watch.turns(body, world.space, feedback))):  # 2
            terms = (*self._planner.lookaround_queries(task), *world.stage_terms)
            panorama = look_around(body, world, turns, tuple(dict.fromkeys(terms)))  # 3: O^12_k
            memory = world.serialise(body.pose)  # 3: Psi_k
            self._emit(LookedAround(body.stage, panorama.views, memory))
            verified = settings.components.stagewise and feedback is not None
            context = PlannerContext(
                task=task,
                stage=body.stage,
                views=panorama.views,
                memory=memory,
                feedback=feedback if verified else None,
                last_subtask=subtasks[-1] if verified else None,
                pose=body.pose,
                space=world.space,
                steps_left=body.budget.left,
            )
            finish = partial(judge.claimed, feedback=feedback, panorama=panorama)
            subtask = ask_planner(self._planner, context, finish, settings.control, self._emit, self._clock)  # 4, 5: sigma_k
            subtasks.append(subtask)
            waypoint = world.remember(body.pose, subtask.current_anchor, panorama.sightings)  # 6: G_{k+1}, P_{k+1}
            if waypoint is not None:
                self._emit(WaypointAdded(body.stage, waypoint))
            if subtask.complete:  # 7: z_k = 1, and the episode gate agrees
                return Ending(EpisodeStatus.STOPPED, StopReason.GATE)
            if judge.stable(subtask, feedback, body.pose):  # 7: the goal is verified and nobody says so
                return Ending(EpisodeStatus.STOPPED, StopReason.STABLE_FINAL_ARRIVAL)
            stage = Stage(subtask, body, world, self._executor, settings, self._emit, self._clock, watch)  # 8
            feedback = stage.run(panorama)  # 9 to 15: F_k
            self._emit(StageEnded(body.stage, feedback, body.pose))
            body.stage += 1  # 16
        return judge.without_looking(feedback, body, self._emit)

    def _watch(self, task: Task) -> Watch:
        settings, components = self._settings, self._settings.components
        if not (settings.glimpses and isinstance(task, ObjectGoalTask)):
            return Watch()
        remembers = components.hsm and components.stagewise
        return Watch(tuple(self._planner.lookaround_queries(task)), task.goal, settings.short_looks and remembers)

    def _emit(self, event: Event) -> None:
        for sink in self._sinks:
            sink.emit(event)
