"""The planner's prompt: task, last stage, memory, map and views, after a static part that is the same in every call."""

from __future__ import annotations

import json
import math
from functools import cache

from spacevln.control import ControlSettings
from spacevln.core import (
    ChatRequest,
    CueKind,
    EnvironmentSpec,
    Feedback,
    InstructionTask,
    ObjectGoalTask,
    Part,
    PlannerContext,
    PlannerReply,
    ReplyRejected,
    Role,
    Task,
    UsageError,
    View,
    egocentric_label,
)
from spacevln.language.names import tidy
from spacevln.memory.arrival import ARRIVAL_RADIUS_M
from spacevln.reasoning.spatial_cot import pictures, wording
from spacevln.reasoning.spatial_cot.json_schema import planner_schema
from spacevln.reasoning.spatial_cot.parsing import parse_planner
from spacevln.reasoning.spatial_cot.settings import Layout, PromptSettings
from spacevln.reasoning.spatial_cot.templating import render
from spacevln.reasoning.spatial_cot.transcript import Refusal, conversation
from spacevln.reasoning.spatial_cot.verdicts import contradiction


class PlannerPrompt:
    """Makes planner requests. Keeps no state: the same context gives the same bytes.

    Args:
        settings: what is shown and how.
        spec: the body.
        control: budgets that the prompt names.

    Raises:
        UsageError: ``view_count`` does not divide the look-around.
    """

    def __init__(self, settings: PromptSettings, spec: EnvironmentSpec, control: ControlSettings | None = None) -> None:
        self._settings, self._spec = settings, spec
        self._control = control or ControlSettings()
        count = spec.lookaround_count
        if settings.view_count < 1 or count % min(settings.view_count, count):
            allowed = ", ".join(str(n) for n in range(1, count + 1) if count % n == 0)
            raise UsageError(
                f"view_count={settings.view_count} does not divide the {count} views of a look-around: use {allowed}."
            )
        self._every = count // min(settings.view_count, count)
        headings = range(0, count, self._every)
        self.directions = tuple(egocentric_label(math.radians(k * spec.turn_deg), round(spec.turn_deg)) for k in headings)
        """Labels of the views that are shown, counter-clockwise from the front."""
        self._schema = planner_schema(self.directions, scot=settings.planner_scot)
        self._static = cache(self._render_static)

    def request(self, context: PlannerContext, refusals: tuple[Refusal, ...] = ()) -> ChatRequest:
        """The question at a planning boundary.

        Args:
            context: the situation.
            refusals: earlier replies to this very question.
        """
        object_goal = isinstance(context.task, ObjectGoalTask)
        return ChatRequest(
            role=Role.PLANNER,
            messages=conversation(self._static(object_goal), self._call(context), refusals),
            reply_schema=self._schema,
            max_tokens=self._settings.planner_max_tokens,
        )

    def parse(self, text: str, context: PlannerContext) -> PlannerReply:
        """The reply to such a question.

        Raises:
            ReplyRejected: it does not hold stage variables (see :func:`~spacevln.reasoning.spatial_cot.parsing.parse_planner`),
                names a view that was not shown, or its verdict contradicts its chain.
        """
        reply = parse_planner(text, scot=self._settings.planner_scot, first=context.last_subtask is None)
        direction = reply.subtask.direction
        if not reply.subtask.complete and direction not in self.directions:
            raise ReplyRejected(
                "direction",
                f"Direction {direction!r} is none of the views: choose one of {', '.join(self.directions)}.",
                reply.fallbacks,
            )
        if context.last_subtask is not None:
            object_goal = isinstance(context.task, ObjectGoalTask)
            wrong = contradiction(reply.subtask, context.last_subtask, object_goal=object_goal)
            if wrong:
                raise ReplyRejected("verdict", wrong, reply.fallbacks)
        return reply

    def _render_static(self, object_goal: bool) -> tuple[Part, ...]:
        settings, control = self._settings, self._control
        return render(
            "planner_static",
            object_goal=object_goal,
            directions=self.directions,
            mosaic=settings.layout is Layout.MOSAIC,
            hsm=settings.hsm,
            landmark_memory=settings.landmark_memory,
            stagewise=settings.stagewise,
            scot=settings.planner_scot,
            detections=self._detections,
            view_deg=self._spec.camera.hfov_deg,
            stage_decisions=control.stage_decisions,
            stage_reach_m=control.stage_decisions * self._spec.max_forward_m,
            traversable_m=control.traversable_m,
            solid_m=ARRIVAL_RADIUS_M[CueKind.SOLID],
            opening_m=ARRIVAL_RADIUS_M[CueKind.OPENING],
            verdicts="first | completed | continue | transition" if settings.stagewise else "first",
        )

    def _call(self, context: PlannerContext) -> tuple[Part, ...]:
        settings = self._settings
        views = tuple(view for view in context.views[:: self._every] if view.rgb is not None)
        shown = self._view_pictures(views)
        memory = context.memory
        if memory is not None and memory.map_image is not None:
            shown["map"] = pictures.png(memory.map_image)
        return render(
            "planner_call",
            shown,
            object_goal=isinstance(context.task, ObjectGoalTask),
            task=_task_words(context.task),
            goal_json=json.dumps(_task_words(context.task), ensure_ascii=False),
            stage=context.stage,
            last=_last_stage(context.feedback),
            landmark_memory=settings.landmark_memory,
            memory=None if memory is None else tidy(memory.text),
            mosaic=settings.layout is Layout.MOSAIC,
            views=[{"label": view.label, "words": words} for view, words in zip(views, self._view_words(views), strict=True)],
            steps_left=context.steps_left,
            lookaround=self._spec.lookaround_count,
            longest_move=round(self._spec.max_forward_m / self._spec.step_m),
        )

    @property
    def _detections(self) -> bool:
        return self._settings.show_detections and self._settings.landmark_memory and self._settings.stagewise

    def _view_words(self, views: tuple[View, ...]) -> list[str]:
        told = wording.told_once(views) if self._detections else [()] * len(views)
        return [wording.view_words(view, seen) for view, seen in zip(views, told, strict=True)]

    def _view_pictures(self, views: tuple[View, ...]) -> dict[str, bytes]:
        settings = self._settings
        drawn = [pictures.view_picture(view, settings.view_width_px, detections=self._detections) for view in views]
        if settings.layout is Layout.MOSAIC:
            return {"views": pictures.jpeg(pictures.mosaic(drawn), settings.jpeg_quality)}
        return {view.label: pictures.jpeg(picture, settings.jpeg_quality) for view, picture in zip(views, drawn, strict=True)}


def _task_words(task: Task) -> str:
    return tidy(task.instruction if isinstance(task, InstructionTask) else task.goal)


def _last_stage(feedback: Feedback | None) -> dict[str, object] | None:
    """F_{k-1} in words."""
    if feedback is None:
        return None
    subtask = feedback.subtask
    return {
        "instruction": tidy(subtask.instruction),
        "target": wording.anchor_words(subtask.next_anchor),
        "landmark": wording.landmark_words(subtask.landmark),
        "end": wording.end_words(feedback),
        "motion": wording.motion_words(feedback.record),
        "pool": wording.pool_words(feedback.pool, subtask.landmark, crossing=wording.crosses_floors(subtask)),
        "chain": wording.chain_lines(subtask),
    }
