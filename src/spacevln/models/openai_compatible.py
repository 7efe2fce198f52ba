"""A chat model behind an OpenAI-compatible endpoint: dialect, reply shape, retries and price brought together."""

from __future__ import annotations

from collections.abc import Callable

from spacevln.core import ChatReply, ChatRequest, ModelError, ReplyMode, Usage
from spacevln.models.choice import ModelChoice
from spacevln.models.dialect import Answer, read_answer, request_body, usable
from spacevln.models.endpoint import CallFailed, Endpoint
from spacevln.models.ledger import RunLedger
from spacevln.models.modes import ModeMemory, steps_down
from spacevln.models.prices import AnyPrice
from spacevln.models.profiles import profile
from spacevln.models.retry import Retried, Retrier, Timing


class OpenAICompatibleModel:
    """Asks one model at one server.

    Args:
        choice: which, and how.
        endpoint: the server.
        price: None = not known; a run with ``--max-usd`` refuses that beforehand.
        ledger: shared by the workers of the run.
        memory: of reply shapes.
        timing: clock, sleeper, dice.
        on_retry: told of every request that failed and is sent again.
    """

    def __init__(
        self,
        choice: ModelChoice,
        endpoint: Endpoint,
        price: AnyPrice | None,
        ledger: RunLedger,
        memory: ModeMemory,
        timing: Timing | None = None,
        on_retry: Callable[[Retried], None] | None = None,
    ) -> None:
        self._choice, self._endpoint, self._price = choice, endpoint, price
        self._profile = profile(choice.profile)
        self._ledger, self._memory = ledger, memory
        self._timing = timing or Timing()
        self.on_retry: Callable[[Retried], None] = on_retry or (lambda _: None)
        self._mode: ReplyMode | None = None

    @property
    def name(self) -> str:
        """``profile:model``."""
        return str(self._choice)

    def close(self) -> None:
        """Free the connections."""
        self._endpoint.close()

    def complete(self, request: ChatRequest) -> ChatReply:
        """Answer one request; see :class:`~spacevln.core.ChatModel`."""
        self._ledger.check()
        begin = self._timing.clock()
        try:
            (answer, usd), attempts, mode = self._ask_in_known_mode(request)
        except CallFailed as failure:
            raise ModelError(f"{self.name} refused the request ({failure.kind}): {failure.detail}.") from failure
        reply = ChatReply(
            text=answer.text,
            model=answer.model or self._choice.model,
            mode=mode,
            usage=answer.usage or Usage(),
            latency_s=self._timing.clock() - begin,
            usd=usd,
            thought=answer.thought,
            attempts=attempts,
        )
        return usable(answer, reply, request.max_tokens)

    def _ask_in_known_mode(self, request: ChatRequest) -> tuple[tuple[Answer, float | None], int, ReplyMode]:
        if request.reply_schema is None:
            return (*self._ask(request, ReplyMode.TEXT), ReplyMode.TEXT)
        if self._choice.mode != "auto":
            return (*self._ask(request, self._choice.mode), self._choice.mode)
        known = self._mode or self._memory.recall(self._choice.url, self._choice.model)
        return self._step_down(request, known or self._profile.best_mode)

    def _step_down(self, request: ChatRequest, start: ReplyMode) -> tuple[tuple[Answer, float | None], int, ReplyMode]:
        refusal: CallFailed | None = None
        for mode in steps_down(start):
            try:
                asked = self._ask(request, mode)
            except CallFailed as failure:
                if failure.kind != "bad_request":
                    raise
                refusal = refusal or failure  # the first says most: it may have nothing to do with the shape
                continue
            self._mode = mode
            self._memory.remember(self._choice.url, self._choice.model, mode)
            return (*asked, mode)
        assert refusal is not None  # noqa: S101 - every mode was refused
        raise refusal

    def _ask(self, request: ChatRequest, mode: ReplyMode) -> tuple[tuple[Answer, float | None], int]:
        body = request_body(request, self._choice, self._profile, mode)

        def ask(timeout_s: float) -> tuple[Answer, float | None]:
            begin = self._timing.clock()
            data = self._endpoint.ask(body, timeout_s)
            try:
                answer = read_answer(data, self._profile)
            except ValueError as error:
                raise CallFailed("broken_reply", str(error), retryable=True) from error
            usd = self._cost(answer, self._timing.clock() - begin)
            self._ledger.spend(usd or 0.0)
            return answer, usd

        retrier: Retrier[tuple[Answer, float | None]] = Retrier(self._choice.retry_for(request.role), self._ledger, self._timing)
        return retrier.run(ask, self.on_retry)

    def _cost(self, answer: Answer, latency_s: float) -> float | None:
        if answer.usd is not None:
            return answer.usd
        if self._price is None or answer.usage is None:
            return None
        return self._price.usd(answer.usage, latency_s)
