"""What a run with chat models will take, from the averages of recorded ones: calls, tokens, USD, hours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from spacevln.core import Role, Usage, UsageError
from spacevln.models import ModelChoice, price_of
from spacevln.models.profiles import data
from spacevln.recording import ResultFile, read_file

TOKENS = ("input_tokens", "cached_tokens", "cache_write_tokens", "output_tokens", "reasoning_tokens")


@dataclass(frozen=True, slots=True)
class RoleAverage:
    """One role's calls in an average episode.

    Args:
        calls: per episode.
        usage: of one call.
        latency_s: of one call.
    """

    calls: float
    usage: Usage
    latency_s: float


@dataclass(frozen=True, slots=True)
class Averages:
    """An average episode.

    Args:
        roles: by role.
        own_s: its time without the models.
        source: where this was learnt, in words.
    """

    roles: Mapping[Role, RoleAverage]
    own_s: float
    source: str


@dataclass(frozen=True, slots=True)
class RoleForecast:
    """What one role's calls will come to; ``usd`` is None when the price is not known."""

    model: str
    calls: float
    usage: Usage
    usd: float | None
    latency_s: float


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a run will come to.

    Args:
        episodes: still to run.
        roles: by role.
        hours: with the run's workers side by side.
        source: of the averages.
    """

    episodes: int
    roles: Mapping[Role, RoleForecast]
    hours: float
    source: str

    @property
    def usd(self) -> float | None:
        """Altogether; None when a price is not known."""
        parts = [role.usd for role in self.roles.values()]
        return None if None in parts else sum(part for part in parts if part is not None)


def forecast(averages: Averages, choices: Mapping[Role, ModelChoice], episodes: int, workers: int) -> Forecast:
    """The forecast of a run.

    Args:
        averages: of an episode.
        choices: models, of the roles that ask one.
        episodes: still to run.
        workers: side by side; a rate limit is not reckoned with.
    """
    roles = {role: _role(averages.roles[role], choice, episodes) for role, choice in choices.items() if role in averages.roles}
    seconds = episodes * averages.own_s + sum(role.latency_s for role in roles.values())
    return Forecast(episodes, roles, seconds / 3600 / min(workers, max(episodes, 1)), averages.source)


def known_averages(task_kind: str) -> Averages:
    """The averages that come with the package (``models/data/averages.toml``)."""
    table = data("averages.toml")
    roles = {}
    for role, row in table[task_kind].items():
        usage = Usage(**{name: row[name] for name in TOKENS if name in row})
        roles[Role(role)] = RoleAverage(row["calls"], usage, row["latency_s"])
    return Averages(roles, table["own_s"], "the package's averages; give --forecast-from RUN for your own")


def recorded_averages(run: Path) -> Averages:
    """The averages of a recorded run, over its episodes in which models were asked.

    Raises:
        UsageError: there is none.
    """
    results = [read_file(path, ResultFile) for path in sorted((run / "episodes").glob("*/result.json"))]
    asked = [result for result in results if result.usage]
    if not asked:
        raise UsageError(f"{str(run)!r} holds no finished episode that asked a model: give a run with --planner vlm.")
    roles = {}
    for role in Role:
        parts = [result.usage[role.value] for result in asked if role.value in result.usage]
        fresh = sum(part.calls - part.kept - part.failed for part in parts)
        if fresh:
            tokens = sum((part.tokens for part in parts), Usage())
            mean = Usage(**{name: round(getattr(tokens, name) / fresh) for name in TOKENS})
            calls = sum(part.calls for part in parts) / len(asked)
            roles[role] = RoleAverage(calls, mean, sum(part.latency_s for part in parts) / fresh)
    latency_s = sum(part.latency_s for result in asked for part in result.usage.values())
    own_s = max(sum(result.timing_s for result in asked) - latency_s, 0.0) / len(asked)
    return Averages(roles, own_s, f"{len(asked)} episodes of {run}")


def _role(average: RoleAverage, choice: ModelChoice, episodes: int) -> RoleForecast:
    calls = average.calls * episodes
    price = price_of(choice)
    total = Usage(**{name: round(getattr(average.usage, name) * calls) for name in TOKENS})
    usd = None if price is None else price.usd(average.usage, average.latency_s) * calls
    return RoleForecast(str(choice), calls, total, usd, average.latency_s * calls)
