"""Provider profiles and the paper's planner-executor pairs: data files, read once (``models/data``)."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from spacevln.core import ReplyMode, Role, UnknownNameError

GENERIC = "openai-compatible"


class Profile(BaseModel):
    """How to speak to one provider.

    Args:
        name: e.g. ``"dashscope"``.
        title: for people.
        base_url: of its API; empty = must be given.
        key_env: the environment variable that holds its key.
        key_optional: whether it may work without one (own servers).
        best_mode: the strictest reply shape to try first.
        cache_marker: the static prefix is marked for an explicit prompt cache; otherwise caching is implicit or absent.
        limit_field: name of the bound on the reply.
        temperature: whether a temperature may be sent.
        thinking_off, thinking_on: body fields that disable or budget thought; ``"$tokens"`` is the budget.
        extra: further body fields.
        tells_usd: ``usage.cost`` is what the call cost in USD.
        checked: when this was compared with the provider's documents.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    title: str
    base_url: str
    key_env: str
    key_optional: bool = False
    best_mode: ReplyMode = ReplyMode.JSON_SCHEMA
    cache_marker: bool = False
    limit_field: Literal["max_tokens", "max_completion_tokens"] = "max_tokens"
    temperature: bool = True
    thinking_off: dict[str, Any] = {}
    thinking_on: dict[str, Any] = {}
    extra: dict[str, Any] = {}
    tells_usd: bool = False
    checked: str

    def thinking(self, budget: int) -> dict[str, Any]:
        """Body fields for a thinking budget in tokens; 0 disables thought."""
        fields = self.thinking_on if budget else self.thinking_off
        return {name: _filled(value, budget) for name, value in fields.items()}


def _filled(value: Any, tokens: int) -> Any:
    if isinstance(value, dict):
        return {name: _filled(inner, tokens) for name, inner in value.items()}
    return tokens if value == "$tokens" else value


def data(name: str) -> dict[str, Any]:
    """A data file of this package."""
    return tomllib.loads(resources.files("spacevln.models").joinpath("data", name).read_text(encoding="utf-8"))


@cache
def profiles() -> dict[str, Profile]:
    """Every profile by its name."""
    return {name: Profile(name=name, **fields) for name, fields in data("profiles.toml").items()}


def profile(name: str) -> Profile:
    """One profile.

    Raises:
        UnknownNameError: there is none of this name.
    """
    if name not in profiles():
        raise UnknownNameError("model profile", name, profiles())
    return profiles()[name]


@cache
def pairs() -> dict[str, dict[Role, str]]:
    """The paper's planner-executor pairs: name to ``profile:model`` per role."""
    return {name: {Role(role): model for role, model in pair.items()} for name, pair in data("pairs.toml").items()}
