"""pi_E with a chat model: prompt, ask, parse (paper Sec. 3.3)."""

from __future__ import annotations

from functools import partial

from spacevln.core import ChatModel, ExecutorContext, ExecutorReply
from spacevln.reasoning.spatial_cot.executor_prompt import ExecutorPrompt
from spacevln.reasoning.spatial_cot.transcript import Transcript


class ModelExecutor:
    """Implements :class:`spacevln.core.Executor` by Spatial-CoT.

    Between two questions it keeps only the refused replies of the present query.

    Args:
        model: answers.
        prompt: asks.
    """

    def __init__(self, model: ChatModel, prompt: ExecutorPrompt) -> None:
        self._prompt, self._transcript = prompt, Transcript(model)

    def reset(self) -> None:
        """A new episode begins."""
        self._transcript.clear()

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """The next action.

        Raises:
            ReplyRejected: the reply could not be parsed into an action.
            ModelError, SpendingLimit: of the model.
        """
        return self._prompt.parse(self._transcript.ask(partial(self._prompt.request, context), context.rejections))
