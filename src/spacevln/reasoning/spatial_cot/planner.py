"""pi_P with a chat model: prompt, ask, parse (paper Sec. 3.3)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from spacevln.core import ChatModel, PlannerContext, PlannerReply, Task
from spacevln.reasoning.spatial_cot.planner_prompt import PlannerPrompt
from spacevln.reasoning.spatial_cot.transcript import Transcript


class ModelPlanner:
    """Implements :class:`spacevln.core.Planner` by Spatial-CoT.

    Between two questions it keeps only the refused replies of the present planning boundary.

    Args:
        model: answers.
        prompt: asks.
    """

    def __init__(self, model: ChatModel, prompt: PlannerPrompt) -> None:
        self._prompt, self._transcript = prompt, Transcript(model)

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        """Doorways: the model sees them in the pictures, the memory parts spaces at them and draws them on the map."""
        del task
        return ("doorway",)

    def reset(self) -> None:
        """A new episode begins."""
        self._transcript.clear()

    def plan(self, context: PlannerContext) -> PlannerReply:
        """The next subtask.

        Raises:
            ReplyRejected: the reply could not be parsed into stage variables, or contradicts itself.
            ModelError, SpendingLimit: of the model.
        """
        return self._prompt.parse(self._transcript.ask(partial(self._prompt.request, context), context.rejections), context)
