"""Which model answers, and how it is asked: the part of a run's configuration that concerns models."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from spacevln.core import ReplyMode, Role, UsageError
from spacevln.models.prices import PriceRule, table
from spacevln.models.profiles import GENERIC, pairs, profile, profiles

RELAY = "relay"


class RetrySettings(BaseModel):
    """When a call is tried again, and when it is given up (DESIGN 5.5).

    Args:
        attempts: requests per call, the first included.
        first_wait_s: before the second attempt; doubles with each, up to ``longest_wait_s``.
        jitter: share of a wait that is drawn at random, so that workers do not come back together.
        attempt_s: longest time for one request.
        total_s: longest time for the whole call, waits included.
        hedge_after_s: a second, equal request is sent when the first has not answered by then; None = never.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    attempts: PositiveInt = 5
    first_wait_s: PositiveFloat = 1.0
    longest_wait_s: PositiveFloat = 30.0
    jitter: NonNegativeFloat = 0.5
    attempt_s: PositiveFloat = 120.0
    total_s: PositiveFloat = 300.0
    hedge_after_s: PositiveFloat | None = None


PLANNER_RETRY = RetrySettings()
EXECUTOR_RETRY = RetrySettings(attempt_s=30.0, total_s=120.0)
"""An executor's reply is short: a silent server is asked again sooner."""


class ModelChoice(BaseModel):
    """One model at one endpoint.

    Args:
        profile: of the provider, or ``relay``.
        model: its name there; for a relay the folder.
        base_url: None = the profile's.
        thinking: tokens of thought per call; 0 disables it where the provider can; None leaves it to the provider.
        temperature: None = the provider's default.
        seed: passed on where given.
        mode: how the reply's shape is asked for; ``auto`` finds out the strictest that the server has.
        price: None = the price table's.
        retry: None = by role.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    profile: str
    model: str
    base_url: str | None = None
    thinking: NonNegativeInt | None = 0
    temperature: NonNegativeFloat | None = 0.1
    seed: int | None = None
    mode: Literal["auto"] | ReplyMode = "auto"
    price: PriceRule | None = None
    retry: RetrySettings | None = None

    @property
    def url(self) -> str:
        """Where it is asked."""
        return self.base_url or profile(self.profile).base_url

    def retry_for(self, role: Role) -> RetrySettings:
        """The retry settings of this role."""
        return self.retry or (PLANNER_RETRY if role is Role.PLANNER else EXECUTOR_RETRY)

    def __str__(self) -> str:
        return f"{self.profile}:{self.model}"


def choose(name: str, base_url: str | None = None) -> dict[Role, ModelChoice]:
    """What ``--model NAME [--base-url URL]`` means, for planner and executor.

    Args:
        name: a pair of the paper (``paper-qwen3.5``), ``profile:model``, ``relay:FOLDER``, a model in the price table, or any
            model's name together with a base URL.
        base_url: of the endpoint; None = the profile's.

    Raises:
        UsageError: the name says neither provider nor URL.
        UnknownNameError: no such profile.
    """
    if name in pairs():
        return {role: _one(model, base_url) for role, model in pairs()[name].items()}
    return dict.fromkeys(Role, _one(name, base_url))


def _one(name: str, base_url: str | None) -> ModelChoice:
    before, colon, after = name.partition(":")
    if before == RELAY and colon:
        if not after or base_url:
            raise UsageError(f"--model {name!r} needs a folder and no --base-url: give --model relay:FOLDER.")
        return ModelChoice(profile=RELAY, model=after)
    if colon and after and (before in profiles() or base_url is None):
        known = profile(before)
        if not (base_url or known.base_url):
            raise UsageError(f"--model {name!r} says no server: add --base-url http://HOST:PORT/v1.")
        return ModelChoice(profile=before, model=after, base_url=base_url)
    if base_url is not None:
        return ModelChoice(profile=GENERIC, model=name, base_url=base_url)
    homes = list(dict.fromkeys(row.profile for row in table() if row.model == name))
    if not homes:
        raise UsageError(
            f"--model {name!r} says no provider: give PROFILE:MODEL with one of {', '.join(sorted(profiles()))}, "
            f"one of the pairs {', '.join(pairs())}, or add --base-url."
        )
    return ModelChoice(profile=homes[0], model=name)
