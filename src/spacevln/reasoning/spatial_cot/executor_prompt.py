"""The executor's prompt: the stage, the front view with its landmarks, the pool, the moves so far, the admissible moves."""

from __future__ import annotations

from functools import cached_property

from spacevln.core import ChatRequest, CueKind, EnvironmentSpec, ExecutorContext, ExecutorReply, Part, Role
from spacevln.language.names import tidy
from spacevln.memory.arrival import ARRIVAL_RADIUS_M
from spacevln.reasoning.spatial_cot import pictures, wording
from spacevln.reasoning.spatial_cot.actions import action_choices, admissible_words
from spacevln.reasoning.spatial_cot.json_schema import executor_schema
from spacevln.reasoning.spatial_cot.parsing import parse_executor
from spacevln.reasoning.spatial_cot.settings import PromptSettings
from spacevln.reasoning.spatial_cot.templating import render
from spacevln.reasoning.spatial_cot.transcript import Refusal, conversation


class ExecutorPrompt:
    """Makes executor requests. Keeps no state: the same context gives the same bytes.

    Args:
        settings: what is shown and how.
        spec: the body.
    """

    def __init__(self, settings: PromptSettings, spec: EnvironmentSpec) -> None:
        self._settings, self._spec = settings, spec
        self.choices = action_choices(spec, settings.turn_steps)
        """Every move of this body, by its words."""
        self._schema = executor_schema(tuple(self.choices), scot=settings.executor_scot)

    def request(self, context: ExecutorContext, refusals: tuple[Refusal, ...] = ()) -> ChatRequest:
        """The question before one move.

        Args:
            context: the situation.
            refusals: earlier replies to this very question.
        """
        return ChatRequest(
            role=Role.EXECUTOR,
            messages=conversation(self._static, self._call(context), refusals),
            reply_schema=self._schema,
            max_tokens=self._settings.executor_max_tokens,
        )

    def parse(self, text: str) -> ExecutorReply:
        """The reply to such a question.

        Raises:
            ReplyRejected: it holds no action; see :func:`~spacevln.reasoning.spatial_cot.parsing.parse_executor`.
        """
        return parse_executor(text, self.choices, scot=self._settings.executor_scot)

    @cached_property
    def _static(self) -> tuple[Part, ...]:
        return render(
            "executor_static",
            landmark_memory=self._settings.landmark_memory,
            scot=self._settings.executor_scot,
            view_deg=self._spec.camera.hfov_deg,
            turn_deg=self._spec.turn_deg,
            solid_m=ARRIVAL_RADIUS_M[CueKind.SOLID],
        )

    def _call(self, context: ExecutorContext) -> tuple[Part, ...]:
        settings, subtask, obstacles = self._settings, context.subtask, context.obstacles
        crossing = wording.crosses_floors(subtask)
        picture = pictures.forward_picture(
            context.observation,
            context.sightings if settings.landmark_memory else (),
            context.pool,
            obstacles,
            settings.forward_width_px,
        )
        return render(
            "executor_call",
            {"front camera": pictures.jpeg(picture, settings.jpeg_quality)},
            instruction=tidy(subtask.instruction),
            target=wording.anchor_words(subtask.next_anchor),
            landmark_memory=settings.landmark_memory,
            landmark=wording.landmark_words(subtask.landmark),
            tracked=bool(subtask.landmark),
            candidates=[wording.candidate_words(candidate, crossing=crossing) for candidate in context.pool],
            moves=[wording.move_words(decision) for decision in context.progress.decisions],
            decisions_left=context.decisions_left,
            left=pictures.obstacle_words(obstacles.left_30_m),
            front=pictures.obstacle_words(obstacles.front_m),
            right=pictures.obstacle_words(obstacles.right_30_m),
            admissible=list(admissible_words(context.admissible, self.choices)),
            reasons=context.admissible.reasons,
        )
