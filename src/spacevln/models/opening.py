"""From the choice of models to chat models that are ready to be asked in an episode."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from spacevln.core import ChatModel, Event, Role, UsageError
from spacevln.models.cached import CachedModel
from spacevln.models.choice import RELAY, ModelChoice
from spacevln.models.endpoint import Endpoint
from spacevln.models.ledger import RunLedger
from spacevln.models.modes import ModeMemory
from spacevln.models.openai_compatible import OpenAICompatibleModel
from spacevln.models.prices import AnyPrice, list_price
from spacevln.models.profiles import profile
from spacevln.models.relay import RelayModel
from spacevln.models.reported import ReportedModel, retry_teller
from spacevln.models.retry import Timing
from spacevln.models.secret import key_from_environment


@dataclass(frozen=True, slots=True)
class RunAccess:
    """What a run lets its models do; no part of its configuration, as it changes no answer.

    Args:
        ledger: file that all workers share; None = this process alone.
        max_usd: what the run may spend.
        requests_per_minute: over all workers.
        reply_cache: folder of kept replies; None = every call is asked.
        hedge_after_s: a second request joins a first one that is silent for so long; None = never.
    """

    ledger: Path | None = None
    max_usd: float | None = None
    requests_per_minute: float | None = None
    reply_cache: Path | None = None
    hedge_after_s: float | None = None

    def to_json(self) -> dict[str, str | float | None]:
        """As plain values, for another process."""
        return {name: str(value) if isinstance(value, Path) else value for name, value in asdict(self).items()}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> RunAccess:
        """From such values."""
        paths = {name: None if data[name] is None else Path(data[name]) for name in ("ledger", "reply_cache")}
        return cls(**{**data, **paths})


UNLIMITED = RunAccess()


def price_of(choice: ModelChoice) -> AnyPrice | None:
    """The price rule of a choice, else the table's; a relay is free; None when nobody knows."""
    if choice.profile == RELAY:
        return None
    return choice.price or list_price(choice.profile, choice.model)


class ModelDesk(AbstractContextManager["ModelDesk"]):
    """Planner and executor models of a run, in one process.

    Args:
        choices: by role.
        access: limits of the run.
        timing: clock, sleeper, dice.
        memory: of reply shapes; None = this machine's.

    Raises:
        PrerequisiteError: a key or the client library is missing.
        UsageError: ``max_usd`` is given and a price is not known.
    """

    def __init__(
        self,
        choices: Mapping[Role, ModelChoice],
        access: RunAccess | None = None,
        timing: Timing | None = None,
        memory: ModeMemory | None = None,
    ) -> None:
        self._choices = dict(choices)
        self._access = access or RunAccess()
        self._timing, self._memory = timing or Timing(), memory or ModeMemory()
        self._check_prices()
        self._endpoints = self._open_endpoints()
        self.ledger = RunLedger(
            self._access.ledger, requests_per_minute=self._access.requests_per_minute, max_usd=self._access.max_usd
        )

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Free connections and ledger. May be called twice."""
        for endpoint in self._endpoints.values():
            endpoint.close()
        self.ledger.close()

    def for_episode(self, emit: Callable[[Event], None]) -> dict[Role, ChatModel]:
        """Models for one episode, which tell its listeners about every call."""
        return {role: ReportedModel(self._model(role, choice, emit), emit) for role, choice in self._choices.items()}

    def _model(self, role: Role, choice: ModelChoice, emit: Callable[[Event], None]) -> ChatModel:
        if choice.profile == RELAY:
            return RelayModel(Path(choice.model))
        asked = OpenAICompatibleModel(
            self._hedged(choice, role),
            self._endpoints[choice],
            price_of(choice),
            self.ledger,
            self._memory,
            self._timing,
            retry_teller(role, str(choice), emit),
        )
        return asked if self._access.reply_cache is None else CachedModel(asked, choice, self._access.reply_cache)

    def _hedged(self, choice: ModelChoice, role: Role) -> ModelChoice:
        after_s = self._access.hedge_after_s
        if after_s is None:
            return choice
        return choice.model_copy(update={"retry": choice.retry_for(role).model_copy(update={"hedge_after_s": after_s})})

    def _check_prices(self) -> None:
        if self._access.max_usd is None:
            return
        for choice in self._choices.values():
            if choice.profile != RELAY and price_of(choice) is None and not profile(choice.profile).tells_usd:
                raise UsageError(
                    f"--max-usd needs a price, and none is known of {choice}: give --price INPUT/OUTPUT (USD per million tokens) "
                    "or --usd-per-hour."
                )

    def _open_endpoints(self) -> dict[ModelChoice, Endpoint]:
        opened = {}
        for choice in dict.fromkeys(self._choices.values()):
            if choice.profile != RELAY:
                known = profile(choice.profile)
                key = key_from_environment(known.key_env, optional=known.key_optional, purpose=known.title)
                opened[choice] = Endpoint.open(choice.url, key)
        return opened
