"""May the episode end here? Evidence for the episode gate and for stable final arrival (Algorithm 1 line 7)."""

from __future__ import annotations

from collections.abc import Callable

from spacevln.agent.body import Body
from spacevln.agent.conclusion import Ending
from spacevln.agent.look_around import Panorama
from spacevln.agent.settings import AgentSettings
from spacevln.agent.world import World
from spacevln.control import EpisodeGate, FinishClaim, GateVerdict, StableFinalArrival, inside_final_region
from spacevln.control.anchors import same_anchor, same_space
from spacevln.core import (
    Anchor,
    EpisodeStatus,
    Event,
    Feedback,
    GateAsked,
    LandmarkPool,
    Pose,
    StageEnd,
    StopReason,
    Subtask,
)


class FinishJudge:
    """Collects what memory and the last stage say about the goal, and asks the rules of control."""

    def __init__(self, world: World, settings: AgentSettings) -> None:
        self._world = world
        self._settings = settings
        components = settings.components
        self._gate = EpisodeGate(components.hsm, components.landmark_memory, components.stagewise)
        self._stable = StableFinalArrival(settings.control)

    def claimed(self, subtask: Subtask, feedback: Feedback | None, panorama: Panorama) -> GateVerdict:
        """The planner says complete at a planning boundary."""
        final, pose = subtask.final_anchor, panorama.observations[0].pose
        return self._gate.judge(
            FinishClaim(
                chain=subtask.chain,
                located_index=subtask.current_index,
                verified_before=feedback.subtask.current_index if feedback else -1,
                place=subtask.current_anchor.space or self._world.locate(pose)[1],
                pool=(*_final_pool(final, feedback), *self._world.evidence(final, panorama.observations)),
                arrived=_arrived(final, feedback),
                changed_floor=self._world.changed_floor,
            )
        )

    def without_looking(self, feedback: Feedback | None, body: Body, emit: Callable[[Event], None]) -> Ending:
        """Too few steps are left for a look-around and STOP: the gate once more, on what the last stage brought.

        Without the planner's word the agent is located at the final anchor when the last stage headed for it and ended by
        arrival or by the executor's STOP. The map's region is older than that stage, so it can support the claim only.
        """
        forced = Ending(EpisodeStatus.STEP_LIMIT, StopReason.BUDGET, f"{body.budget.left} steps left, too few to look around")
        if feedback is None or not feedback.subtask.targets_final_anchor:
            return forced
        subtask = feedback.subtask
        located = feedback.end in (StageEnd.ARRIVAL, StageEnd.STOP)
        region = self._world.locate(body.pose)[1]
        verdict = self._gate.judge(
            FinishClaim(
                chain=subtask.chain,
                located_index=len(subtask.chain) - 1 if located else subtask.current_index,
                verified_before=subtask.current_index,
                place=region if same_space(region, subtask.final_anchor.space) else "",
                pool=feedback.pool,
                arrived=_arrived(subtask.final_anchor, feedback),
                changed_floor=self._world.changed_floor,
            )
        )
        emit(GateAsked(body.stage, verdict.accepted, verdict.clauses))
        return Ending(EpisodeStatus.STOPPED, StopReason.GATE) if verdict.accepted else forced

    def stable(self, subtask: Subtask, feedback: Feedback | None, pose: Pose) -> bool:
        """Whether this boundary makes a stable final arrival."""
        final = subtask.final_anchor
        inside = inside_final_region(
            final,
            self._world.locate(pose)[1],
            _final_pool(final, feedback),
            self._settings.control,
            hsm=self._settings.components.hsm,
        )
        return self._stable.observe(subtask, pose, inside=inside)


def _arrived(final: Anchor, feedback: Feedback | None) -> bool:
    return feedback is not None and _headed_for(final, feedback) and feedback.end is StageEnd.ARRIVAL


def _headed_for(final: Anchor, feedback: Feedback | None) -> bool:
    return feedback is not None and feedback.subtask.targets_final_anchor and same_anchor(feedback.subtask.final_anchor, final)


def _final_pool(final: Anchor, feedback: Feedback | None) -> LandmarkPool:
    return feedback.pool if feedback is not None and _headed_for(final, feedback) else ()
